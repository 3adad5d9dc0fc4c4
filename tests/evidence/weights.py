"""Weights of the evidence network in ONNX: written with the seal that lib/net/file.h asks for, and read back to go on training.

A written network has its batch normalisation folded into the convolutions. Read back, each normalisation is set to undo the mean and the
variance that its input has on pictures, so that the network is the same function and trains on as before.
"""
import copy
import gzip
import inspect
import struct

import torch
from torch import nn


def export(net, path, width, height, planes=3, small=False):
    """small: of the weights, normalisation folded in, half precision is kept, and the file is compressed (gzip) to half its size."""
    net = copy.deepcopy(net).eval().to(memory_format=torch.contiguous_format)
    if small:
        fold(net)
    plain = {"dynamo": False} if "dynamo" in inspect.signature(torch.onnx.export).parameters else {}  # newer ones write graphs that lib/net cannot read
    torch.onnx.export(net, torch.zeros(1, planes, height, width), path, opset_version=11, input_names=["in"], output_names=["logits"], **plain)
    seal(path)
    if small:
        with open(path, "rb") as file:
            data = file.read()
        with open(path, "wb") as file:
            file.write(gzip.compress(data, 9, mtime=0))


def fold(net):
    """Folds each normalisation into its convolution and rounds the weights to half precision; ReLU's input has no normalisation then."""
    for module in list(net.modules()):
        if isinstance(module, nn.Sequential) and len(module) > 1 and isinstance(module[1], nn.BatchNorm2d):
            module[0] = nn.utils.fuse_conv_bn_eval(module[0], module[1])
            module[1] = nn.Identity()
    for module in net.modules():
        if isinstance(module, nn.Conv2d):
            module.weight.data = module.weight.data.half().float()


def contents(path):
    with open(path, "rb") as file:
        data = file.read()
    return gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data


def seal(path):
    """Appends an entry of ONNX's metadata with the FNV-1a hash of all before it."""
    with open(path, "rb") as file:
        data = file.read()
    value = 0xcbf29ce484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001b3) & 0xffffffffffffffff
    with open(path, "ab") as file:
        file.write(b"\x72\x1b\x0a\x07fnv1a64\x12\x10" + b"%016x" % value)


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            return value, at


def fields(data):
    """(number, value) of each field of a protobuf message: integers, or bytes of what has a length."""
    at = 0
    while at < len(data):
        key, at = varint(data, at)
        kind = key & 7
        if kind == 0:
            value, at = varint(data, at)
        else:
            size = {1: 8, 5: 4}.get(kind)
            if size is None:
                size, at = varint(data, at)
            value, at = data[at:at + size], at + size
        yield key >> 3, value


def tensor(data):
    """Name and values of a TensorProto of floats (dims 1, data_type 2, name 8, raw_data 9)."""
    shape, name, raw, kind = [], "", b"", 0
    for number, value in fields(data):
        if number == 1:
            shape += [value] if isinstance(value, int) else [varint(value, 0)[0]]
        elif number == 2:
            kind = value
        elif number == 8:
            name = value.decode()
        elif number == 9:
            raw = value
    if kind != 1:
        return name, None
    return name, torch.tensor(struct.unpack("<%df" % (len(raw) // 4), raw)).reshape(shape)


def convolutions(path):
    """Weight and bias of each Conv of a file, in the order of the graph (ModelProto 7; GraphProto node 1, initializer 5)."""
    graph = next(value for number, value in fields(contents(path)) if number == 7)
    named, wanted = {}, []
    for number, value in fields(graph):
        if number == 5:
            name, values = tensor(value)
            named[name] = values
        elif number == 1:
            node = list(fields(value))
            if (4, b"Conv") in node:
                wanted.append([v.decode() for n, v in node if n == 1][1:3])
    return [(named[weight], named[bias]) for weight, bias in wanted]


def read(net, path, pictures):
    """Sets net, whose modules run in the order of net.in_order(), to the file's weights. pictures: batches to learn the statistics on."""
    pairs = net.in_order()
    for (conv, norm), (weight, bias) in zip(pairs, convolutions(path), strict=True):
        conv.weight.data.copy_(weight)
        if norm is None:
            conv.bias.data.copy_(bias)
            continue
        norm.running_mean.zero_()
        norm.running_var.fill_(1 - norm.eps)
        norm.weight.data.fill_(1)
        norm.bias.data.copy_(bias)
    sums = {norm: [0, 0, 0] for _, norm in pairs if norm is not None}

    def note(norm, inputs):
        x = inputs[0].double()
        for k, value in enumerate((x.sum((0, 2, 3)), (x * x).sum((0, 2, 3)), x.numel() / x.shape[1])):
            sums[norm][k] = sums[norm][k] + value

    hooks = [norm.register_forward_pre_hook(note) for norm in sums]
    net.eval()
    with torch.no_grad():
        for x in pictures:
            net(x)
    for hook in hooks:
        hook.remove()
    for norm, (one, two, n) in sums.items():
        mean, var = one / n, two / n - (one / n) ** 2
        norm.running_mean.copy_(mean)
        norm.running_var.copy_(var)
        norm.weight.data.copy_(torch.sqrt(var + norm.eps))
        norm.bias.data.add_(mean)
    net.train()


def mean(net, first, second, part):
    """Sets net, whose normalisation is folded in hereby, to the mean of two files' weights, part of the second: a network trained on from
    another keeps what the other knew where its lessons were few (Wortsman et al., Robust fine-tuning, CVPR 2022)."""
    fold(net.eval())
    for (conv, _), (weight, bias), (other, offset) in zip(net.in_order(), convolutions(first), convolutions(second), strict=True):
        conv.weight.data.copy_((1 - part) * weight + part * other)
        conv.bias.data.copy_((1 - part) * bias + part * offset)


def calibrate(net, logits, share):
    """Folds a temperature and a bias for each class into the last layer, those that make the probabilities of logits [n, classes] most
    likely under the true shares. Cross entropy without weights; Newton's method by L-BFGS."""
    scale, bias = nn.Parameter(torch.ones(1)), nn.Parameter(torch.zeros(logits.shape[1]))
    optimiser = torch.optim.LBFGS([scale, bias], max_iter=100, line_search_fn="strong_wolfe")

    def loss():
        optimiser.zero_grad()
        value = -(torch.log_softmax(scale * logits + bias, 1) * share).sum(1).mean()
        value.backward()
        return value

    optimiser.step(loss)
    with torch.no_grad():
        net.out.weight.mul_(scale)
        net.out.bias.mul_(scale).add_(bias)
    return float(scale), bias.tolist()
