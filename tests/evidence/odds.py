#!/usr/bin/python3
"""Trains the odds of a limbus (lib/limbus/odds.h) on what tests/tools/limbus_traits wrote, and writes them as ONNX.

    odds.py --out config/odds.onnx TRAITS.csv [...]
    odds.py TRAITS.csv [...]                             how they do on pictures held out, alone
    odds.py --start config/odds.onnx --out ... TRAITS.csv [...]    goes on from a network: first its own figures on them, which it has not seen

Input: 1 x 36 x 1 x 1, the traits. Output: 1 x 9 x 1 x 1: the logarithm of the odds that centre and semi-axes are all off by less than
TOLERANCES[0] of the semi-axis, then the logarithms (softplus) of what each further tolerance adds to them. Cross entropy of all tolerances
together (synthetic eyes and captures, which are few, count RARE times, heads HEADS times), weight decay, Adam; four folds by picture for the figures. Needs
python3-torch and python3-numpy.
"""
import argparse
import csv
import sys

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

sys.dont_write_bytecode = True
import weights

UNITS, NETS, RARE, HEADS, DECAY, EPOCHS, BATCH, RATE, AGAIN, FOLDS = 24, 4, 6, 4, 8.0, 30, 512, 0.01, 0.002, 4
TOLERANCES = (0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.1)
TRAITS, FAR = 36, 4.0   # spreads: farther off than that is as far


def read(paths):
    x, error, key, w = [], [], [], []
    for path in paths:
        for row in csv.reader(open(path)):
            if len(row) < 5 + TRAITS:
                continue
            x.append([float(v) for v in row[5:5 + TRAITS]])
            error.append(float(row[3]))
            key.append((path, row[0], row[1]))
            w.append(1 if row[0] in ('drawn', 'other') else HEADS if row[0] == 'heads' else RARE)
    x = np.array(x)
    x[~np.isfinite(x)] = 0
    return x, np.array(error), key, np.array(w, float)


class Net(nn.Module):
    """NETS networks side by side, and the mean of what they say."""

    def __init__(self, x):
        super().__init__()
        mean, spread = x.mean(0), x.std(0)
        spread[spread == 0] = 1
        # spreads below the mean, at most FAR: OpenCV reads no clamp of this kind, but two rectifiers
        self.even = nn.Sequential(fixed(np.diag(1 / spread), FAR - mean / spread), nn.ReLU(), fixed(-np.eye(TRAITS), np.full(TRAITS, 2 * FAR)), nn.ReLU(),
                                  fixed(np.eye(TRAITS), np.full(TRAITS, -FAR)))
        self.first = nn.Conv2d(TRAITS, NETS * UNITS, 1)
        self.second = nn.Conv2d(NETS * UNITS, NETS * UNITS, 1, groups=NETS)
        self.last = nn.Conv2d(NETS * UNITS, NETS * len(TOLERANCES), 1, groups=NETS)
        self.mean = fixed(np.tile(np.eye(len(TOLERANCES)) / NETS, NETS), np.zeros(len(TOLERANCES)))

    def each(self, x):
        return self.last(torch.tanh(self.second(torch.tanh(self.first(self.even(x))))))

    def forward(self, x):
        return self.mean(self.each(x))


def fixed(weight, bias):
    conv = nn.Conv2d(weight.shape[1], weight.shape[0], 1).requires_grad_(False)
    conv.weight.data = torch.tensor(weight, dtype=torch.float32)[:, :, None, None]
    conv.bias.data = torch.tensor(bias, dtype=torch.float32)
    return conv


def curve(out):
    """Log odds from outputs [..., tolerances]."""
    return torch.cat([out[..., :1], out[..., :1] + torch.cumsum(F.softplus(out[..., 1:]), -1)], -1)


def planes(x):
    return torch.tensor(x, dtype=torch.float32)[:, :, None, None]


def read_back(net, path):
    """Sets a network to a file's weights: all of its convolutions, in the order of the graph."""
    layers = [m for m in net.modules() if isinstance(m, nn.Conv2d)]
    for layer, (weight, bias) in zip(layers, weights.convolutions(path), strict=True):
        layer.weight.data.copy_(weight)
        layer.bias.data.copy_(bias)


def train(x, error, w, seed, start=None):
    torch.manual_seed(seed)
    net, n = Net(x), len(x)
    if start:
        read_back(net, start)
    z, y, w = planes(x), torch.tensor(error[:, None] < np.array(TOLERANCES), dtype=torch.float32), torch.tensor(w, dtype=torch.float32)
    steps = EPOCHS * n // BATCH + (0 if start else 1000)
    rate = AGAIN if start else RATE
    adam = torch.optim.Adam([p for p in net.parameters() if p.requires_grad], lr=rate)
    pace = torch.optim.lr_scheduler.OneCycleLR(adam, rate, total_steps=steps)
    for _ in range(steps):
        some = torch.randint(n, (BATCH,))
        adam.zero_grad()
        odds = curve(net.each(z[some]).reshape(BATCH, NETS, -1))
        loss = F.binary_cross_entropy_with_logits(odds, y[some][:, None].expand_as(odds), w[some][:, None, None].expand_as(odds)) * NETS
        loss = loss + DECAY / n * sum((layer.weight ** 2).sum() for layer in (net.first, net.second, net.last))
        loss.backward()
        adam.step()
        pace.step()
    return net.eval()


def odds_by(net, x):
    with torch.no_grad():
        return curve(net(planes(x))[:, :, 0, 0]).numpy()


def held_out(x, error, key, w, start):
    pictures = sorted(set(key))
    fold = {k: i for k, i in zip(pictures, np.random.RandomState(0).randint(FOLDS, size=len(pictures)))}
    at = np.array([fold[k] for k in key])
    odds = np.zeros((len(x), len(TOLERANCES)))
    for f in range(FOLDS):
        odds[at == f] = odds_by(train(x[at != f], error[at != f], w[at != f], f, start), x[at == f])
    told(odds, error, key)


def told(odds, error, key):
    """Figures of all, and of heads alone."""
    figures(odds, error, key)
    heads = np.array([k[1] == 'heads' for k in key])
    if heads.any() and not heads.all():
        print('of heads:')
        figures(odds[heads], error[heads], [k for k in key if k[1] == 'heads'])


def right_where(share, gross, right):
    """Share of all pictures that are right and taken, by the chance beyond which they are refused where so many of all are wrong."""
    right = right[np.argsort(gross, kind='stable')]
    return right[:np.searchsorted(np.cumsum(~right), share * len(right), side='right')].sum() / len(right)


def figures(odds, error, key):
    right = error[:, None] < np.array(TOLERANCES)
    print('cross entropy of trials held out: %.4f' % np.log1p(np.exp(-np.where(right, odds, -odds))).mean())
    for t, tolerance in enumerate(TOLERANCES):
        if tolerance not in (0.02, 0.04):
            continue
        best = {}
        for i, k in enumerate(key):
            if k not in best or odds[i, t] > odds[best[k], t]:
                best[k] = i
        best = np.array(list(best.values()))
        gross = 1 / (1 + np.exp(odds[best, t]))
        print('of %d pictures are right to %.2f, where 0.1, 0.3 and 1 %% of all are wrong: %s' % (len(best), tolerance, ', '.join(
            '%.1f %%' % (100 * right_where(share, gross, error[best] < tolerance)) for share in (0.001, 0.003, 0.01))))
        for most in (0.1, 0.07, 0.05, 0.03):
            on = best[gross < most]
            print('of %d pictures %d with a chance below %.2f of being off by more than %.2f: %d are, %.1f expected; %d by more than 0.06'
                  % (len(best), len(on), most, tolerance, (error[on] >= tolerance).sum(), gross[gross < most].sum(), (error[on] >= 0.06).sum()))


parser = argparse.ArgumentParser()
parser.add_argument('--start')
parser.add_argument('--out')
parser.add_argument('traits', nargs='+')
args = parser.parse_args()
x, error, key, w = read(args.traits)
if args.start:
    net = Net(x).eval()
    read_back(net, args.start)
    told(odds_by(net, x), error, key)
held_out(x, error, key, w, args.start)
if args.out:
    weights.export(train(x, error, w, 0, args.start), args.out, 1, 1, planes=TRAITS)
