#!/usr/bin/python3
"""Fits the weights of config/limbus.conf (odds_1 to odds_6, odds_sum) to what tests/tools/limbus_traits wrote.

    odds.py TRAITS.csv [...]      prints the lines for config/limbus.conf, and how the odds do on pictures held out

A layer of six hyperbolic tangents, cross entropy (synthetic eyes and captures, which are few, count RARE times), weight decay, Adam; five folds by picture for the figures. Needs numpy and torch.
"""
import csv
import sys

import numpy as np
import torch

UNITS, RARE, DECAY, STEPS, FOLDS = 6, 15, 25.0, 2500, 5
BLUR = 5  # the trait that tells the width of the step


def right(row):
    """limbus_right of lib/limbus/find.h."""
    return float(row[3]) < min(max(0.02, 0.75 * float(row[5 + BLUR])), 0.04)


def read(paths):
    x, y, key, w = [], [], [], []
    for path in paths:
        for row in csv.reader(open(path)):
            x.append([float(v) for v in row[5:]])
            y.append(right(row))
            key.append((path, row[0], row[1]))
            w.append(1 if row[0] in ('drawn', 'other') else RARE)
    x = np.array(x)
    x[~np.isfinite(x)] = 0
    return x, np.array(y, float), key, np.array(w, float)


def train(z, y, w, seed):
    torch.manual_seed(seed)
    a = (torch.randn(UNITS, z.shape[1]) * 0.3).requires_grad_()
    v = (torch.randn(UNITS) * 0.3).requires_grad_()
    c = torch.zeros(1, requires_grad=True)
    adam = torch.optim.Adam([a, v, c], lr=0.02)
    z, y, w = (torch.tensor(v, dtype=torch.float32) for v in (z, y, w))
    for _ in range(STEPS):
        adam.zero_grad()
        p = torch.tanh(z @ a.T) @ v + c
        loss = torch.nn.functional.binary_cross_entropy_with_logits(p, y, w) + DECAY * ((a ** 2).sum() + (v ** 2).sum()) / len(y)
        loss.backward()
        adam.step()
    return a.detach().numpy().astype(float), v.detach().numpy().astype(float), float(c)


def odds(z, weights):
    a, v, c = weights
    return np.tanh(z @ a.T) @ v + c


x, y, key, w = read(sys.argv[1:])
mean, spread = x.mean(0), x.std(0)
mean[0], spread[spread == 0] = 0, 1
spread[0] = 1
z = np.clip((x - mean) / spread, -4, 4)
pictures = sorted(set(key))
fold = {k: i for k, i in zip(pictures, np.random.RandomState(0).randint(FOLDS, size=len(pictures)))}
at = np.array([fold[k] for k in key])
held = np.zeros(len(y))
for f in range(FOLDS):
    held[at == f] = odds(z[at == f], train(z[at != f], y[at != f], w[at != f], f))
best = {}
for i, k in enumerate(key):
    if k not in best or held[i] > held[best[k]]:
        best[k] = i
best = np.array(list(best.values()))
for least in (0, 1, 2.2, 3, 4):
    on = best[held[best] > least]
    print('; held out: of %d pictures %d with log odds above %.1f, %d wrong, %.1f expected'
          % (len(best), len(on), least, (1 - y[on]).sum(), (1 / (1 + np.exp(held[on]))).sum()))
a, v, c = train(z, y, w, 0)
a /= spread
a[:, 0] -= a[:, 1:] @ mean[1:]
for i in range(UNITS):
    print('odds_%d = %s' % (i + 1, ' '.join('%.4g' % w for w in a[i])))
print('odds_sum = %s' % ' '.join('%.4g' % w for w in list(v) + [c]))
