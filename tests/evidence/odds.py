#!/usr/bin/python3
"""Fits the weights of config/limbus.conf (odds_1 to odds_8, odds_sum) to what tests/tools/limbus_traits wrote.

    odds.py TRAITS.csv [...]      prints the lines for config/limbus.conf, and how the odds do on pictures held out

A layer of hyperbolic tangents, cross entropy (synthetic eyes and captures, which are few, count RARE times), weight decay, Adam; five folds by picture for the figures. Needs numpy and torch.
"""
import csv
import sys

import numpy as np
import torch

UNITS, RARE, DECAY, STEPS, FOLDS = 8, 6, 8.0, 2000, 5
TOLERANCES, USUAL = (0.01, 0.015, 0.02, 0.03, 0.04, 0.06), 0.02
TRAITS = 30  # and the tolerance


def read(paths):
    x, error, key, w = [], [], [], []
    for path in paths:
        for row in csv.reader(open(path)):
            x.append([float(v) for v in row[5:5 + TRAITS]])
            error.append(float(row[3]))
            key.append((path, row[0], row[1]))
            w.append(1 if row[0] in ('drawn', 'other') else RARE)
    x = np.array(x)
    x[~np.isfinite(x)] = 0
    return x, np.array(error), key, np.array(w, float)


def asked(z, tolerance):
    """Traits with that of the tolerance."""
    return np.c_[z, np.full(len(z), np.log(tolerance / USUAL))]


def train(z, error, w, seed):
    """At all tolerances together: a trial counts as one."""
    torch.manual_seed(seed)
    y = np.concatenate([error < t for t in TOLERANCES]).astype(float)
    z, w = np.concatenate([asked(z, t) for t in TOLERANCES]), np.tile(w, len(TOLERANCES))
    a = (torch.randn(UNITS, z.shape[1]) * 0.3).requires_grad_()
    v = (torch.randn(UNITS) * 0.3).requires_grad_()
    c = torch.zeros(1, requires_grad=True)
    adam = torch.optim.Adam([a, v, c], lr=0.02)
    z, y, w = (torch.tensor(v, dtype=torch.float32) for v in (z, y, w))
    for _ in range(STEPS):
        adam.zero_grad()
        p = torch.tanh(z @ a.T) @ v + c
        loss = torch.nn.functional.binary_cross_entropy_with_logits(p, y, w) + DECAY * len(TOLERANCES) * ((a ** 2).sum() + (v ** 2).sum()) / len(y)
        loss.backward()
        adam.step()
    return a.detach().numpy().astype(float), v.detach().numpy().astype(float), float(c)


def odds(z, weights):
    a, v, c = weights
    return np.tanh(z @ a.T) @ v + c


x, error, key, w = read(sys.argv[1:])
mean, spread = x.mean(0), x.std(0)
mean[0], spread[spread == 0] = 0, 1
spread[0] = 1
z = np.clip((x - mean) / spread, -4, 4)
pictures = sorted(set(key))
fold = {k: i for k, i in zip(pictures, np.random.RandomState(0).randint(FOLDS, size=len(pictures)))}
at = np.array([fold[k] for k in key])
held = {t: np.zeros(len(error)) for t in (0.02, 0.04)}
for f in range(FOLDS):
    weights = train(z[at != f], error[at != f], w[at != f], f)
    for t in held:
        held[t][at == f] = odds(asked(z[at == f], t), weights)
for t, h in held.items():
    best = {}
    for i, k in enumerate(key):
        if k not in best or h[i] > h[best[k]]:
            best[k] = i
    best = np.array(list(best.values()))
    gross = 1 / (1 + np.exp(h[best]))
    for most in (0.1, 0.07, 0.05, 0.03):
        on = best[gross < most]
        print('; held out: of %d pictures %d with a chance below %.2f of being off by more than %.2f: %d are, %.1f expected; %d by more than 0.06'
              % (len(best), len(on), most, t, (error[on] >= t).sum(), gross[gross < most].sum(), (error[on] >= 0.06).sum()))
a, v, c = train(z, error, w, 0)
a[:, :TRAITS] /= spread
a[:, 0] -= a[:, 1:TRAITS] @ mean[1:]
for i in range(UNITS):
    print('odds_%d = %s' % (i + 1, ' '.join('%.4g' % w for w in a[i])))
print('odds_sum = %s' % ' '.join('%.4g' % w for w in list(v) + [c]))
