#!/usr/bin/python3
"""Trains the network that tells how a head is turned, on what turned.py draws, and writes it as ONNX.

    turn.py --lessons FILE [FILE ...] --minutes 40 --keep turn.pt --out config/turn.onnx [--start turn.pt] [--held FILE]
    turn.py --judge turn.pt --held FILE [--out turn.onnx]     how far off it is on people that it has not seen; writes it
    turn.py --lessons FILE --short                            some steps: the loss falls, asserted

Input of the network: 1 x 3 x 96 x 96, a face whose eyes lie level, 96 / 3.6 px apart, the middle between them at (48, 38.7); each channel less its
mean and over its standard deviation in the middle 64 x 64 px. Output: 1 x 4 x 1 x 1: turned aside, nodded (radians), logarithms of their standard
deviations. Needs python3-torch and python3-numpy.
"""
import argparse
import copy
import os
import sys
import time

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

sys.dont_write_bytecode = True
import train as evidence
import weights

SIDE, MIDDLE, MARKS = 144, (72, 58), 68   # turned.py's
SIZE, SHORT = 96, 40
CHANNELS = (16, 32, 48, 72, 96)
# The landmark that a landmark is, mirrored.
MIRROR = list(range(16, -1, -1)) + list(range(26, 16, -1)) + [27, 28, 29, 30, 35, 34, 33, 32, 31, 45, 44, 43, 42, 47, 46, 39, 38, 37, 36, 41, 40,
                                                             54, 53, 52, 51, 50, 49, 48, 59, 58, 57, 56, 55, 64, 63, 62, 61, 60, 67, 66, 65]


def step(i, o, stride=1, pad=1):
    return nn.Sequential(nn.Conv2d(i, o, 3, stride, pad, bias=False), nn.BatchNorm2d(o), nn.ReLU(inplace=True))


class Net(nn.Module):
    def __init__(self, c=CHANNELS, marks=MARKS):
        super().__init__()
        blocks = []
        for k, o in enumerate(c):
            blocks += [step(c[k - 1] if k else 3, o, 2), step(o, o)]
        self.body = nn.Sequential(*blocks, step(c[-1], 128, 1, 0))
        self.out = nn.Conv2d(128, 4 + 2 * marks, 1)  # landmarks are learnt beside, and left out of what is written

    def forward(self, x):
        return self.out(self.body(x))


class Lessons:
    def __init__(self, paths):
        self.paths = paths
        self.look()

    def look(self):
        """What the files hold by now."""
        one = SIDE * SIDE * 3 + 4 * (2 + 2 * MARKS)
        self.files = [np.memmap(p, np.uint8, "r", shape=(os.path.getsize(p) // one, one)) for p in self.paths]
        self.count = [len(f) for f in self.files]

    def take(self, index):
        at = np.searchsorted(np.cumsum(self.count), index, side="right")
        start = np.r_[0, np.cumsum(self.count)]
        rows = np.stack([self.files[a][i - start[a]] for a, i in zip(at, index)])
        rgb = rows[:, : SIDE * SIDE * 3].reshape(-1, SIDE, SIDE, 3).transpose(0, 3, 1, 2)
        labels = np.ascontiguousarray(rows[:, SIDE * SIDE * 3:]).view(np.float32)
        return torch.from_numpy(np.ascontiguousarray(rgb)), torch.from_numpy(labels.copy())


def normal(x):
    """Each channel by the middle of the picture."""
    m = x[:, :, 16:80, 16:80]
    mean, std = m.mean((2, 3), keepdim=True), m.std((2, 3), keepdim=True)
    return (x - mean) / (std + 0.02)


def cut(rgb, labels, rng, wander=True):
    """What the network sees, and its truth: places and sizes that are not quite right, either hand."""
    n = len(rgb)
    x, y = rgb.float() / 255, labels.clone()

    def draw(*shape, of=torch.rand):
        return of(*shape, generator=rng)

    if wander:
        mirror = draw(n) < .5
        x = torch.where(mirror[:, None, None, None], x.flip(3), x)
        marks = labels[:, 2:].reshape(n, MARKS, 2)
        other = marks[:, MIRROR].clone()
        other[..., 0] = SIDE - other[..., 0]
        y[:, 2:] = torch.where(mirror[:, None, None], other, marks).reshape(n, -1)
        y[:, 0] = torch.where(mirror, -y[:, 0], y[:, 0])
    amount = 1. if wander else 0.
    angle = amount * .06 * draw(n, of=torch.randn)
    scale = torch.exp(amount * .06 * draw(n, of=torch.randn))
    shift = amount * 1.6 * draw(n, 2, of=torch.randn)  # px of the lesson
    c, s = torch.cos(angle) * scale, torch.sin(angle) * scale
    middle = torch.tensor(MIDDLE, dtype=torch.float32)
    # from px of what is seen to px of the lesson: about the middle between the eyes, which is seen where the lesson has it
    turn = torch.stack([torch.stack([c, -s], 1), torch.stack([s, c], 1)], 1)
    grid = (torch.arange(SIZE) + .5) * SIDE / SIZE
    seen = torch.stack(torch.meshgrid(grid, grid, indexing="xy"), -1).reshape(-1, 2)
    to = (seen - middle) @ turn.transpose(1, 2) + middle + shift[:, None]
    if wander:  # a frame that cuts the face
        closer, far = torch.tensor([[30., 10.], [30., 10.]]), torch.tensor([[75., 60.], [75., 90.]])
        edge = closer + draw(n, 2, 2) * (far - closer) + 200 * (draw(n, 1, 1) > .3)
        a = .35 * draw(n, of=torch.randn) * (draw(n) < .5)
        c, s = torch.cos(a), torch.sin(a)
        lean = torch.stack([torch.stack([c, -s], 1), torch.stack([s, c], 1)], 1)
        to = torch.maximum(torch.minimum((to - middle) @ lean, edge[:, None, 1]), -edge[:, None, 0]) @ lean.transpose(1, 2) + middle
    x = F.grid_sample(x, (to * 2 / SIDE - 1).reshape(n, SIZE, SIZE, 2), align_corners=False, padding_mode="border")
    marks = y[:, 2:].reshape(n, MARKS, 2) - middle - shift[:, None]
    y[:, 2:] = ((marks @ turn) / (scale * scale)[:, None, None] + middle).reshape(n, -1) / SIDE
    if not wander:
        return normal(x), y
    small = int(draw(1) * 56) + 40
    x = torch.where((draw(n) < .3)[:, None, None, None], F.interpolate(F.interpolate(x, (small, small), mode="area"), (SIZE, SIZE), mode="bilinear"), x)
    x = x.clamp(1e-4, 1) ** torch.exp(.3 * draw(n, 1, 1, 1, of=torch.randn))
    x = x * torch.exp(.15 * draw(n, 3, 1, 1, of=torch.randn))
    x = torch.where((draw(n) < .2)[:, None, None, None], x.mean(1, keepdim=True), x)
    x = x + (draw(n, 1, 1, 1) < .5) * .04 * draw(n, 1, 1, 1) * draw(n, 3, SIZE, SIZE, of=torch.randn)
    for _ in range(2):
        tall, wide = 4 + draw(n, 1, 1) * 30, 4 + draw(n, 1, 1) * 30
        row, column = torch.arange(SIZE)[None, :, None] - draw(n, 1, 1) * (SIZE - tall), torch.arange(SIZE) - draw(n, 1, 1) * (SIZE - wide)
        inside = (row >= 0) & (row < tall) & (column >= 0) & (column < wide) & (draw(n, 1, 1) < .2)
        x = torch.where(inside[:, None], draw(n, 3, 1, 1), x)
    return normal(x), y


def loss_of(out, y):
    out = out[:, :, 0, 0].float()
    off = (out[:, :2] - y[:, :2]).abs()
    spread = out[:, 2:4].clamp(-6, 1)
    turned = (off * torch.exp(-spread) * 1.414 + spread).mean()  # Laplace's
    return turned + 8 * (out[:, 4:] - y[:, 2:]).abs().mean() + 2 * off.mean(), off


def judge(net, lessons, name):
    net.eval()
    off, spread, truth = [], [], []
    with torch.no_grad():
        for k in range(0, sum(lessons.count), 64):
            rgb, labels = lessons.take(np.arange(k, min(k + 64, sum(lessons.count))))
            x, y = cut(rgb, labels, torch.Generator().manual_seed(0), False)
            out = net(x)[:, :4, 0, 0]
            off.append((out[:, :2] - y[:, :2]).numpy())
            spread.append(np.exp(out[:, 2:4].numpy()))
            truth.append(y[:, :2].numpy())
    off, spread, truth = map(np.concatenate, (off, spread, truth))
    for k, what in enumerate(("aside", "nod")):
        for low, high in ((0, 15), (15, 30), (30, 60)):
            on = (np.degrees(np.abs(truth).max(1)) >= low) & (np.degrees(np.abs(truth).max(1)) < high)
            e = np.degrees(np.abs(off[on, k]))
            if on.any():
                print("  %s, %s, %d to %d deg: off %.2f, 90 %% %.2f deg; error/sigma 68 %% %.2f, 90 %% %.2f" %
                      (name, what, low, high, np.median(e), np.percentile(e, 90), *np.percentile(np.abs(off[on, k]) / spread[on, k], [68, 90])), flush=True)


def written(net, path):
    """Without the landmarks."""
    net = copy.deepcopy(net).eval().float()
    out = nn.Conv2d(net.out.in_channels, 4, 1)
    out.weight.data, out.bias.data = net.out.weight.data[:4].clone(), net.out.bias.data[:4].clone()
    net.out = out
    weights.export(net, path, SIZE, SIZE, small=True)


def train(args):
    torch.manual_seed(args.seed)
    torch.set_num_threads(args.threads)
    torch.set_flush_denormal(True)
    rng, pick = torch.Generator().manual_seed(args.seed), np.random.default_rng(args.seed)
    net = Net().to(memory_format=torch.channels_last)
    if args.start:
        net.load_state_dict(torch.load(args.start)["net"])
    mean = copy.deepcopy(net)
    optimiser = torch.optim.AdamW(net.parameters(), lr=args.rate, weight_decay=1e-2)
    lessons, held = Lessons(args.lessons), Lessons([args.held]) if args.held else None
    begun, said, losses = time.time(), time.time(), []
    while True:
        done = (time.time() - begun) / (60 * args.minutes) if not args.short else len(losses) / SHORT
        if done >= 1:
            break
        evidence.pace(optimiser, args.rate, min(1, len(losses) / (10 if args.short else 100) + .02), done)
        if len(losses) % 100 == 0:
            lessons.look()
        x, y = cut(*lessons.take(pick.integers(0, sum(lessons.count), args.batch)), rng)
        net.train()
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=args.half):
            out = net(x.to(memory_format=torch.channels_last))
        loss, off = loss_of(out, y)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(net.parameters(), 2)
        optimiser.step()
        losses.append((float(loss), float(off[:, 0].mean()), float(off[:, 1].mean())))
        with torch.no_grad():
            evidence.blend(mean.state_dict(), net.state_dict(), min(.999, len(losses) / (len(losses) + 10)))
        if len(losses) % 200 == 0:
            l = np.mean(losses[-200:], 0)
            print("%5.1f min, step %d, %d lessons, loss %.4f, off %.2f %.2f deg" % ((time.time() - begun) / 60, len(losses), sum(lessons.count), l[0], *np.degrees(l[1:])), flush=True)
        if args.keep and time.time() - said > 60 * args.every:
            said = time.time()
            torch.save({"net": mean.state_dict(), "steps": len(losses)}, args.keep)
            if held:
                judge(copy.deepcopy(mean), held, "held")
    return mean, [loss[0] for loss in losses]


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--lessons", nargs="+")
    p.add_argument("--held")
    p.add_argument("--keep", help="checkpoint file")
    p.add_argument("--start")
    p.add_argument("--out", help="ONNX file")
    p.add_argument("--minutes", type=float, default=40)
    p.add_argument("--every", type=float, default=4)
    p.add_argument("--rate", type=float, default=3e-3)
    p.add_argument("--batch", type=int, default=64)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--half", action="store_true")
    p.add_argument("--judge", metavar="FILE")
    p.add_argument("--short", action="store_true")
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    if args.judge:
        net = Net()
        net.load_state_dict(torch.load(args.judge)["net"])
        if args.held:
            judge(net, Lessons([args.held]), "held")
        if args.out:
            written(net, args.out)
        return
    if args.short:
        args.batch, args.keep = 16, None
    net, losses = train(args)
    if args.short:
        first, last = np.mean(losses[:5]), np.mean(losses[-10:])
        print("loss %.3f -> %.3f" % (first, last))
        sys.exit(not last < first - 1)
    if args.keep:
        torch.save({"net": net.state_dict()}, args.keep)
    if args.held:
        judge(net, Lessons([args.held]), "held")
    if args.out:
        written(net, args.out)


if __name__ == "__main__":
    main()
