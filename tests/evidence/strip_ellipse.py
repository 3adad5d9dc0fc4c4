"""The ellipse that follows from what the strip network says of the rays (lib/limbus/strip.h), linearised about an ellipse of the strip: five
waves round the rays, of rows. A loss by it, and how far off it is.

Each ray has a place, the mean of its rows near the ellipse, and a weight, what it counts for over their variance, as strip_fit has them.
"""
import math

import numpy as np
import torch

COUNTS = 6, 30            # rays that count as one where the limbus is seen, and where it is hidden (config/limbus.conf)
NOISE = 0.3               # rows: of every ray
KNOWN = 8.0               # rows: sigma of a wave before anything is read
FREEDOM = 5               # of Student's t
REACH = 6, 20             # rows about the truth in which a ray has its place: seen, hidden
SEEN, CLIMB = 0.3, (16, 12, 8, 6, 4, 4, 4)   # as strip_fit: chance from which a ray is seen; rows of each step


def waves(rays, device="cpu"):
    """[rays, 5]: centre, radius, and the two of an ellipse's shape."""
    phi = 2 * math.pi * torch.arange(rays, device=device) / rays
    return torch.stack([phi.cos(), phi.sin(), torch.ones(rays), (2 * phi).cos(), (2 * phi).sin()], 1)


def places(rows, about, reach):
    """Mean of each ray's rows within reach of `about`, from there, and their variance. rows: chances [n, rows, rays]."""
    off = torch.arange(rows.shape[1], device=rows.device)[None, :, None] - about[:, None]
    some = rows * (off.abs() <= reach[:, None])
    total = some.sum(1) + 1e-9
    mean = (some * off).sum(1) / total
    return mean, (some * (off - mean[:, None]) ** 2).sum(1) / total, total


def solve(mean, variance, seen, use, known=KNOWN):
    """The waves that fit best, and the matrix of their normal equations. Rays with use 0 are left out."""
    basis = waves(mean.shape[1], mean.device)
    weight = use * (seen / COUNTS[0] + (1 - seen) / COUNTS[1]) / (variance + NOISE ** 2)
    normal = torch.einsum("ja,nj,jb->nab", basis, weight, basis) + torch.eye(5, device=mean.device) / known ** 2
    return torch.linalg.solve(normal, torch.einsum("ja,nj->na", basis, weight * mean)), normal


def loss(rows, chance, truth, seen, least=0.6):
    """Minus log likelihood of the true ellipse, nats a strip, by Student's t round the fitted one with its own covariance: what rays are off
    together costs as much as it does in the ellipse. chance: told of being seen. truth [n, rays]: rows; seen: of these. Strips less than `least`
    of whose rays cross the limbus say nothing."""
    within = ((truth > -0.5) & (truth < rows.shape[1] - 0.5)).float()
    whole = (within.mean(1) > least).float()
    mean, variance, _ = places(rows, truth, torch.where(seen > 0.5, float(REACH[0]), float(REACH[1])))
    off, normal = solve(mean, variance, chance, within)
    chi2 = torch.einsum("na,nab,nb->n", off, normal, off)
    each = 0.5 * (FREEDOM + 5) * torch.log1p(chi2 / FREEDOM) - torch.logdet(normal) / 2
    return (each * whole).sum() / len(whole)


def errors(rows, chance, truth, step):
    """How far centre and semi-axes of the ellipse are off that is read round each strip's own, semi-axes: the largest of them, as the search
    would find it. NAN: the limbus does not cross two in three rays of the strip."""
    n, count, rays = rows.shape
    basis, valid = waves(rays), (truth > -0.5) & (truth < count - 0.5)
    known = solve(torch.where(valid, truth, torch.zeros(())) - 0.5 * (count - 1), torch.zeros(n, rays), torch.ones(n, rays), valid.float(), 1e3)[0]
    found = torch.zeros(n, 5)
    for reach in CLIMB:
        about = 0.5 * (count - 1) + found @ basis.T
        mean, variance, total = places(rows, about, torch.full((n, rays), float(reach)))
        hidden = chance < SEEN
        wide, spread, _ = places(rows, about, torch.full((n, rays), float(count)))
        use = ((chance * total > SEEN) | hidden).float()
        found = found + solve(torch.where(hidden, wide, mean), torch.where(hidden, spread, variance), chance, use)[0]
    d, axes = found - known, [w[:, 2:3] + torch.hypot(w[:, 3], w[:, 4])[:, None] * torch.tensor([[1.0, -1.0]]) for w in (found, known)]
    worst = torch.maximum(torch.hypot(d[:, 0], d[:, 1]), (axes[0] - axes[1]).abs().max(1).values) * step
    return torch.where(valid.float().mean(1) > 2 / 3, worst, torch.full((), math.nan)).numpy()


def tell(name, worst):
    worst = worst[np.isfinite(worst)]
    print("  ellipse, %s: off %.2f %% of the axis, 80 %% %.2f, 90 %% %.2f; within 2 %% %.1f %% of %d"
          % (name, *(100 * np.quantile(worst, (0.5, 0.8, 0.9))), 100 * (worst < 0.02).mean(), len(worst)), flush=True)
