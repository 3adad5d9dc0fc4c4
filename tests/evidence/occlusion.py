#!/usr/bin/python3
"""Trains the network that tells what hides an iris (lib/limbus/occlusion.h), on lessons that make_occlusions writes, and writes it as ONNX.

    occlusion.py --make build/tests/evidence/make_occlusions --minutes 40 --out config/occlusion.onnx
    occlusion.py --make build/tests/evidence/make_occlusions --short      a minute: the loss falls, asserted
    occlusion.py --make build/tests/evidence/make_occlusions --start config/occlusion.onnx --minutes 0      figures alone, of the test split
    occlusion.py --make build/tests/evidence/make_occlusions --mean FIRST.onnx SECOND.onnx 0.5 --minutes 0 --out config/occlusion.onnx    half of the second's weights

Input: 1 x 8 x 128 x 128: red, green and blue without their means, over the standard deviation of their mean; four chances; the darkest channel as it is.
Output: 1 x 4 x 64 x 64, logits of iris, pupil, reflection, and what lies before the eye. Needs python3-torch and python3-numpy.
"""
import argparse
import subprocess
import sys
import queue
import threading
import time

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

sys.dont_write_bytecode = True
import train as evidence
import weights

SEEN, PLANES, SIDE, CELLS, CLASSES, REACH = 7, 8, 128, 64, 4, 1.2
BYTES = SEEN * SIDE * SIDE + CLASSES * CELLS * CELLS
CHANNELS = (24, 40, 56, 72)
NAMES, MIRROR = ("iris", "pupil", "reflection", "before it"), 2
KEPT, HELD = 12000, 900000000   # lessons in memory; numbers that are never learnt from


class Net(nn.Module):
    def __init__(self, c=CHANNELS):
        super().__init__()
        self.first = nn.Sequential(evidence.step(PLANES, c[0], 2), evidence.step(c[0], c[0]))
        self.down = nn.ModuleList([nn.Sequential(evidence.step(c[k], c[k + 1], 2), evidence.step(c[k + 1], c[k + 1])) for k in range(len(c) - 1)])
        self.deep = nn.Sequential(evidence.step(c[-1], c[-1]), evidence.step(c[-1], c[-1]))
        self.thin = nn.ModuleList([nn.Conv2d(c[k + 1], c[k], 1) for k in reversed(range(len(c) - 1))])
        self.up = nn.ModuleList([evidence.step(c[k], c[k]) for k in reversed(range(len(c) - 1))])
        self.out = nn.Conv2d(c[0], CLASSES, 1)

    def forward(self, x):
        x = self.first(x)
        kept = [x]
        for down in self.down:
            x = down(x)
            kept.append(x)
        x = self.deep(x)
        for k, (thin, up) in enumerate(zip(self.thin, self.up)):
            x = up(F.interpolate(thin(x), scale_factor=2, mode="nearest") + kept[len(kept) - 2 - k])
        return self.out(x)

    def in_order(self):
        """Convolutions and their normalisations (None: without one) as forward runs them, for weights.read."""
        pairs = [(s[0], s[1]) for s in [*self.first, *(s for down in self.down for s in down), *self.deep]]
        for thin, up in zip(self.thin, self.up):
            pairs += [(thin, None), (up[0], up[1])]
        return pairs + [(self.out, None)]


class Lessons:
    """From the generator; the last KEPT are kept and drawn from."""

    def __init__(self, make, first, kept, more=None):
        self.queue, self.kept, self.most, self.made, self.rng = queue.Queue(256), [], kept, 0, np.random.default_rng(first)
        self.process = subprocess.Popen([make, str(first), "100000000", *([more] if more else [])], stdout=subprocess.PIPE, bufsize=1 << 22)
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        while len(data := self.process.stdout.read(BYTES)) == BYTES:
            a = np.frombuffer(data, np.uint8)
            self.queue.put((a[:SEEN * SIDE * SIDE].reshape(SEEN, SIDE, SIDE), a[SEEN * SIDE * SIDE:].reshape(CLASSES, CELLS, CELLS)))

    def fresh(self, n):
        """The next n, none kept."""
        return [torch.from_numpy(np.stack(v)) for v in zip(*(self.queue.get() for _ in range(n)))]

    def next(self, batch):
        while len(self.kept) < min(256, self.most) or not self.queue.empty():
            lesson, self.made = self.queue.get(), self.made + 1
            if len(self.kept) < self.most:
                self.kept.append(lesson)
            else:
                self.kept[self.rng.integers(self.most)] = lesson
        return [torch.from_numpy(np.stack(v)) for v in zip(*(self.kept[i] for i in self.rng.integers(0, len(self.kept), batch)))]

    def close(self):
        self.process.terminate()
        while not self.queue.empty():
            self.queue.get()
        self.process.wait()


def jitter(x, truth, rng):
    n = len(x)

    def draw(*shape, of=torch.rand):
        return of(*shape, generator=rng)

    rgb = x[:, :3]
    rgb = rgb.clamp(min=1e-3) ** torch.exp(0.2 * draw(n, 1, 1, 1, of=torch.randn))
    rgb = (rgb * torch.exp(0.1 * draw(n, 3, 1, 1, of=torch.randn))).clamp(max=1)
    grey = (draw(n, 1, 1, 1) < 0.1).float()
    rgb = rgb * (1 - grey) + grey * rgb.mean(1, keepdim=True)
    rgb = rgb + 0.03 * draw(n, 1, 1, 1) ** 2 * draw(*rgb.shape, of=torch.randn)
    chance = x[:, 3:] * (draw(n, 1, 1, 1) > 0.15).float()
    chance = torch.cat([chance[:, :3], chance[:, 3:] * (draw(n, 1, 1, 1) > 0.3).float()], 1)  # of a reflection above all: it is often missed in photographs
    x = torch.cat([rgb, chance], 1)
    over = (draw(n, 1, 1, 1) < 0.5)
    return torch.where(over, x.flip(3), x), torch.where(over, truth.flip(3), truth)


def even(x):
    rgb = x[:, :3] - x[:, :3].mean((2, 3), keepdim=True)
    rgb = rgb / (rgb.mean(1, keepdim=True).std((1, 2, 3), keepdim=True) + 0.05)
    return torch.cat([rgb, 2 * x[:, 3:] - 0.5, 2 * x[:, :3].amin(1, keepdim=True) - 0.5], 1)


def disc():
    """Cells by what they count for: within the limbus."""
    at = (2 * (torch.arange(CELLS) + 0.5) / CELLS - 1) * REACH
    r = (at[:, None] ** 2 + at[None] ** 2).sqrt()
    return (r < 0.97).float() + 0.2 * (r >= 0.97).float()


def loss_of(out, truth, weight):
    return -(F.log_softmax(out, 1) * truth).sum(1).mul(weight).sum() / (len(out) * weight.sum())


def judge(net, held, batch=32):
    """Intersection over union of the classes within the limbus; of reflections, the share found and the share of iris lost at some chances."""
    net.eval()
    inside = disc() > 0.5
    both, either, found, lost, loss = np.zeros(CLASSES), np.zeros(CLASSES), {}, {}, 0
    with torch.no_grad():
        for k in range(0, len(held[0]), batch):
            x, truth = held[0][k:k + batch].float() / 255, held[1][k:k + batch].float() / 255
            out = net(even(x))
            loss += float(loss_of(out, truth, disc())) * len(x) / len(held[0])
            is_, told = truth.argmax(1)[:, inside], out.argmax(1)[:, inside]
            for c in range(CLASSES):
                both[c] += ((is_ == c) & (told == c)).sum()
                either[c] += ((is_ == c) | (told == c)).sum()
            p, sure = out.softmax(1)[:, MIRROR][:, inside], truth.amax(1)[:, inside] > 0.9
            for at in (0.15, 0.3, 0.5):
                found.setdefault(at, []).append(((p > at) & (is_ == MIRROR) & sure).sum(1) / ((is_ == MIRROR) & sure).sum(1).clamp(min=1e-9))
                lost.setdefault(at, []).append(((p > at) & (is_ == 0) & sure).sum(1) / ((is_ == 0) & sure).sum(1).clamp(min=1))
    net.train()
    print("  loss %.4f; IoU " % loss + ", ".join("%s %.3f" % (NAMES[c], both[c] / either[c]) for c in range(CLASSES)))
    for at in found:
        f = torch.cat(found[at])
        print("  a chance of %.2f: of reflections %.1f %% found, of iris %.2f %% lost" % (at, 100 * f[f <= 1].mean(), 100 * torch.cat(lost[at]).mean()), flush=True)


def held_out(args, more=None, first=HELD):
    lessons = Lessons(args.make, first, 0, more)
    held = lessons.fresh(args.held)
    lessons.close()
    return held


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--make", required=True)
    p.add_argument("--out")
    p.add_argument("--keep")
    p.add_argument("--start", help="checkpoint or ONNX file to begin with")
    p.add_argument("--mean", nargs=3, metavar=("FIRST", "SECOND", "PART"), help="the mean of two networks' weights, part of the second, and its figures")
    p.add_argument("--minutes", type=float, default=40)
    p.add_argument("--rate", type=float, default=3e-3)
    p.add_argument("--batch", type=int, default=24)
    p.add_argument("--first", type=int, default=1000000)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--held", type=int, default=384, help="lessons to judge on")
    p.add_argument("--photographs", help="what traced.py --mirrors has written: every second lesson is of these")
    p.add_argument("--half", action="store_true", help="multiply in bfloat16: faster where the processor has it")
    p.add_argument("--short", action="store_true")
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    torch.set_flush_denormal(True)
    torch.manual_seed(args.seed)
    rng = torch.Generator().manual_seed(args.seed)
    net = Net().to(memory_format=torch.channels_last)
    if args.mean:
        weights.mean(net, args.mean[0], args.mean[1], float(args.mean[2]))
    elif args.start and args.start.endswith(".onnx"):
        lessons = Lessons(args.make, 800000000, 0)
        weights.read(net, args.start, [even(lessons.fresh(24)[0].float() / 255) for _ in range(12)])
        lessons.close()
    elif args.start:
        net.load_state_dict(torch.load(args.start))
    print("%d parameters" % sum(v.numel() for v in net.parameters()), flush=True)
    held = None if args.short else held_out(args)
    mean = {k: v.clone() for k, v in net.state_dict().items()}
    optimiser = torch.optim.AdamW(net.parameters(), lr=args.rate, weight_decay=1e-3)
    if args.short:
        args.batch = 8
    lessons, weight = Lessons(args.make, args.first, 96 if args.short else KEPT, args.photographs), disc()
    begun, losses, last = time.time(), [], time.time()
    while True:
        done = (time.time() - begun) / max(60 * args.minutes, 1e-9) if not args.short else len(losses) / 60
        if done >= 1:
            break
        evidence.pace(optimiser, args.rate, min(1, len(losses) / (20 if args.short else 100) + 0.02), done)
        x, truth = lessons.next(args.batch)
        x, truth = jitter(x.float() / 255, truth.float() / 255, rng)
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=args.half):
            out = net(even(x).to(memory_format=torch.channels_last))
        loss = loss_of(out.float(), truth, weight)
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(net.parameters(), 2)
        optimiser.step()
        losses.append(float(loss))
        with torch.no_grad():
            evidence.blend(mean, net.state_dict(), min(0.998, len(losses) / (len(losses) + 10)))
        if len(losses) % 100 == 0:
            print("%5.1f min, step %d, of %d lessons, loss %.4f" % ((time.time() - begun) / 60, len(losses), lessons.made, np.mean(losses[-100:])), flush=True)
        if args.keep and time.time() - last > 240:
            last = time.time()
            torch.save(mean, args.keep)
            other = Net()
            other.load_state_dict(mean)
            judge(other, held)
    lessons.close()
    if args.short:
        first, end = np.mean(losses[:10]), np.mean(losses[-20:])
        print("loss %.3f, at the end %.3f" % (first, end))
        assert end < 0.9 * first, "the loss does not fall"
        return
    net.load_state_dict(mean)
    judge(net, held)
    print("the test split:")
    judge(net, held_out(args, "test"))
    if args.keep:
        torch.save(mean, args.keep)
    if args.out:
        weights.export(net, args.out, SIDE, SIDE, PLANES, small=True)


if __name__ == "__main__":
    main()
