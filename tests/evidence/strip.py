#!/usr/bin/python3
"""Trains the network that tells where the limbus crosses the rays of a strip (lib/limbus/strip.h), on strips that make_strips writes, and
writes it as ONNX.

    strip.py --make build/tests/evidence/make_strips --minutes 40 --out config/strip.onnx
    strip.py --make build/tests/evidence/make_strips --short         a minute: the loss falls, asserted
    strip.py --make build/tests/evidence/make_strips --start config/strip.onnx --minutes 0      figures alone
    strip.py --make build/tests/evidence/make_strips --mean FIRST.onnx SECOND.onnx 0.7 --out config/strip.onnx      seven tenths of the second's weights

Input: 1 x 8 x 64 x 160: planes, rows, rays; the first and last 16 rays are repeated beyond each other. Red, green and blue without their
means, over the standard deviation of their mean. Output: 1 x 1 x 65 x 160, logits of the row in which a ray crosses the limbus, be it seen or
hidden, and last the logit of its being seen, iris against sclera, within the strip. Needs python3-torch and python3-numpy.
"""
import argparse
import math
import queue
import subprocess
import sys
import threading
import time

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

sys.dont_write_bytecode = True
import ring
import strip_ellipse
import train as evidence
import weights

PLANES, ROWS, RAYS, WRAP = 8, 64, 128, 16
FROM, STEP = 0.6, 0.0125
BYTES = PLANES * ROWS * RAYS + 5 * RAYS
CHANNELS = (16, 24, 40, 56, 64)   # the last levels see the whole round of rays
SPREAD = 0.8   # rows: of the truth
KEPT = 24000   # strips in memory
APART, TOGETHER = 1000000, 64   # numbers of the photographs of two generators; strips that go to a device together
HELD, STARTS, NEAR = 900000000, 8, slice(2, 6)   # photographs that are never learnt from; strips of each, those near a limbus


class Net(nn.Module):
    def __init__(self, c=CHANNELS):
        super().__init__()
        self.first = evidence.step(PLANES, c[0])
        self.down = nn.ModuleList([nn.Sequential(evidence.step(c[k], c[k + 1], 2), evidence.step(c[k + 1], c[k + 1])) for k in range(len(c) - 1)])
        self.deep = evidence.step(c[-1], c[-1])
        self.thin = nn.ModuleList([nn.Conv2d(c[k + 1], c[k], 1) for k in reversed(range(len(c) - 1))])
        self.up = nn.ModuleList([evidence.step(c[k], c[k]) for k in reversed(range(len(c) - 1))])
        self.row = nn.Conv2d(c[0], 1, 1)
        self.seen = nn.Conv2d(c[0], 1, 1)

    def forward(self, x):
        x = self.first(x)
        kept = [x]
        for down in self.down:
            x = down(x)
            kept.append(x)
        x = self.deep(x)
        for k, (thin, up) in enumerate(zip(self.thin, self.up)):
            x = up(F.interpolate(thin(x), scale_factor=2, mode="nearest") + kept[len(kept) - 2 - k])
        return torch.cat([self.row(x), self.seen(F.avg_pool2d(x, (ROWS, 1)))], 2)

    def in_order(self):
        """Convolutions and their normalisations (None: without one) as forward runs them, for weights.read."""
        steps = [self.first] + [s for down in self.down for s in down] + [self.deep]
        pairs = [(s[0], s[1]) for s in steps]
        for thin, up in zip(self.thin, self.up):
            pairs += [(thin, None), (up[0], up[1])]
        return pairs + [(self.row, None), (self.seen, None)]


class Strips:
    """Batches from the generator; the last KEPT strips are kept and drawn from."""

    def __init__(self, make, first, batch, fresh=0.6, kept=KEPT, makers=1, photographs=()):
        self.batch, self.fresh, self.rng, self.process = batch, max(1, int(batch * fresh)), np.random.default_rng(first), []
        self.queue, self.kept, self.most, self.seen = queue.Queue(64 * makers), [], kept, 0
        for k in range(makers):
            self.process.append(subprocess.Popen([make, str(first + k * APART), "100000000", *photographs], stdout=subprocess.PIPE, bufsize=1 << 22))
            threading.Thread(target=self.read, args=(self.process[-1],), daemon=True).start()

    def read(self, process):
        while True:
            data = process.stdout.read(BYTES)
            if len(data) < BYTES:
                return
            a = np.frombuffer(data, np.uint8)
            n = PLANES * ROWS * RAYS
            self.queue.put((a[:n].reshape(PLANES, ROWS, RAYS), a[n:n + 4 * RAYS].copy().view(np.float32), a[n + 4 * RAYS:]))

    def next(self):
        while len(self.kept) < min(512, self.most):
            self.kept.append(self.queue.get())
        fresh = 0
        while fresh < self.fresh and not self.queue.empty():
            strip, fresh, self.seen = self.queue.get(), fresh + 1, self.seen + 1
            if len(self.kept) < self.most:
                self.kept.append(strip)
            else:
                self.kept[self.rng.integers(self.most)] = strip
        picked = [self.kept[i] for i in self.rng.integers(0, len(self.kept), self.batch)]
        return [torch.from_numpy(np.stack([p[k] for p in picked])) for k in range(3)]

    def fresh_only(self, n):
        picked = [self.queue.get() for _ in range(n)]
        return [torch.from_numpy(np.stack([p[k] for p in picked])) for k in range(3)]

    def close(self):
        for process in self.process:
            process.terminate()
        while not self.queue.empty():
            self.queue.get()
        for process in self.process:
            process.wait()


class Stored(Strips):
    """The same for a device, which keeps all of them."""

    MOST, LEAST = 500000, 6000

    def __init__(self, make, first, batch, device, makers, photographs):
        super().__init__(make, first, batch, makers=makers, photographs=photographs)
        self.ring = ring.Ring(self.MOST, device, (((PLANES, ROWS, RAYS), torch.uint8), ((RAYS,), torch.float32), ((RAYS,), torch.uint8)))

    def next(self):
        while self.seen < self.LEAST or self.queue.qsize() >= TOGETHER:
            self.ring.add(*self.fresh_only(TOGETHER))
            self.seen = self.ring.made
        return self.ring.draw(self.batch)


def strips_of(args):
    if args.device == "cpu":
        return Strips(args.make, args.first, args.batch, kept=96 if args.short else KEPT, makers=args.makers, photographs=args.photographs)
    return Stored(args.make, args.first, args.batch, args.device, args.makers, args.photographs)


def target(crossing, seen):
    """Rows [n, ROWS, RAYS], 0 where the limbus crosses none; whether it is seen [n, RAYS]."""
    row = (crossing - FROM) / STEP - 0.5
    at = torch.arange(ROWS, device=row.device)[None, :, None]
    within = (row > -0.5) & (row < ROWS - 0.5)
    hot = torch.exp(-0.5 * ((at - row[:, None]) / SPREAD) ** 2) * within[:, None]
    return hot / hot.sum(1, keepdim=True).clamp(min=1e-6), ((seen > 0) & within).float()


def jitter(x, rng):
    rgb = x[:, :3]
    n = len(rgb)

    def draw(*shape, of=torch.rand):
        return of(*shape, generator=rng, device=x.device)

    rgb = rgb.clamp(min=1e-3) ** torch.exp(0.25 * draw(n, 1, 1, 1, of=torch.randn))
    rgb = rgb * torch.exp(0.15 * draw(n, 3, 1, 1, of=torch.randn))
    grey = (draw(n, 1, 1, 1) < 0.1).float()
    rgb = rgb * (1 - grey) + grey * rgb.mean(1, keepdim=True)
    rgb = rgb + 0.02 * draw(n, 1, 1, 1) ** 2 * draw(*rgb.shape, of=torch.randn)
    chance = x[:, 3:7] * (draw(n, 1, 1, 1) > 0.1).float()
    return torch.cat([rgb, chance, x[:, 7:]], 1)


def even(x):
    """Photograph without mean and contrast; wrapped."""
    rgb = x[:, :3] - x[:, :3].mean((2, 3), keepdim=True)
    rgb = rgb / (rgb.mean(1, keepdim=True).std((1, 2, 3), keepdim=True) + 0.02)
    x = torch.cat([rgb, 2 * x[:, 3:] - 0.5], 1)
    return torch.cat([x[..., -WRAP:], x, x[..., :WRAP]], 3)


def losses_of(out, crossing, hot, seen):
    """Of a batch: cross entropy of rows, half of it where the limbus is hidden, and of being seen; that of the ellipse that follows."""
    out = out[:, 0, :, WRAP:-WRAP]
    rows = -(F.log_softmax(out[:, :ROWS], 1) * hot).sum(1)
    rays = (rows * (0.5 + 0.5 * seen)).mean() + F.binary_cross_entropy_with_logits(out[:, ROWS], seen)
    truth = (crossing - FROM) / STEP - 0.5
    return rays, strip_ellipse.loss(out[:, :ROWS].softmax(1), out[:, ROWS].sigmoid().detach(), truth, seen)


def judge(net, held, batch=32):
    """How far the mean of the likeliest rows is off, where the limbus is seen and where it is hidden; of what is said to be seen, how much is;
    how far off the ellipse is."""
    net.eval()
    off, z, told, seen, loss, ellipse = [[], []], [[], []], [], [], [0, 0], []
    count = len(held[0]) // batch
    with torch.no_grad():
        for k in range(count):
            x, crossing, shown = (v[k * batch:(k + 1) * batch] for v in held)
            out = net(even(x.float() / 255))
            hot, s = target(crossing, shown)
            for i, v in enumerate(losses_of(out, crossing, hot, s)):
                loss[i] += float(v) / count
            out = out[:, 0, :, WRAP:-WRAP]
            p, t = out[:, :ROWS].softmax(1), out[:, ROWS].sigmoid()
            truth = (crossing - FROM) / STEP - 0.5
            ellipse.append(np.where(s.mean(1) > 0.25, strip_ellipse.errors(p, t, truth, STEP), math.nan))
            at = torch.arange(ROWS)[None, :, None]
            for i, (near, where) in enumerate(((4, (t > 0.5) & (s > 0.5)), (ROWS, (s < 0.5) & (hot.sum(1) > 0.5)))):
                some = p * ((at - p.argmax(1, keepdim=True)).abs() <= near)
                mean = (some * at).sum(1) / some.sum(1)
                var = (some * (at - mean[:, None]) ** 2).sum(1) / some.sum(1)
                d = mean - truth
                off[i].append(d[where])
                z[i].append((d / (var + 0.01).sqrt())[where])
            told.append(t.flatten())
            seen.append(s.flatten())
    net.train()
    told, seen = torch.cat(told).numpy(), torch.cat(seen).numpy()
    print("  loss %.3f, ellipse %.3f; seen %.3f, told %.3f, of these seen %.3f, of seen told %.3f"
          % (*loss, seen.mean(), (told > 0.5).mean(), seen[told > 0.5].mean(), (told > 0.5)[seen > 0.5].mean()))
    for name, o, v in zip(("seen", "hidden"), off, z):
        o, v = torch.cat(o).abs().numpy() * STEP * 100, torch.cat(v).abs().numpy()
        print("  %s: off %.2f %% of the axis, 90 %% %.2f; of sigma %.2f, %.2f" % (name, *np.quantile(o, (0.5, 0.9)), *np.quantile(v, (0.5, 0.9))))
    ellipse = np.concatenate(ellipse).reshape(-1, STARTS)
    strip_ellipse.tell("read near a limbus", ellipse[:, NEAR])


def load(net, path, args):
    """A checkpoint, or a network that was written as ONNX."""
    if not path.endswith(".onnx"):
        net.load_state_dict(torch.load(path), strict=False)
        return
    strips = Strips(args.make, 800000000, 24)
    weights.read(net, path, [even(strips.fresh_only(24)[0].float() / 255) for _ in range(20)])
    strips.close()


def deepen(net, path, args):
    """A network of one level less, of the same function: what comes up from the last level begins at zero."""
    less, state = Net(CHANNELS[:-1]), net.state_dict()
    load(less, path, args)
    for name, value in less.state_dict().items():
        part, *rest = name.split(".")
        if part in ("thin", "up"):
            rest[0] = str(int(rest[0]) + 1)
        state[".".join(["up", "0", *rest] if part == "deep" else [part, *rest])].copy_(value)
    nn.init.zeros_(net.thin[0].weight)
    nn.init.zeros_(net.thin[0].bias)


def held_out(args):
    strips = Strips(args.make, HELD, STARTS, photographs=args.held_photographs)
    held = strips.fresh_only(STARTS * args.held)
    strips.close()
    return held


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--make", required=True)
    p.add_argument("--out")
    p.add_argument("--keep")
    p.add_argument("--start", help="checkpoint or ONNX file to begin with")
    p.add_argument("--mean", nargs=3, metavar=("FIRST", "SECOND", "PART"), help="the mean of two networks' weights, part of the second, and its figures")
    p.add_argument("--deepen", action="store_true", help="the network to begin with has one level less")
    p.add_argument("--photographs", nargs="+", default=[], help="what heads.py --photographs and traced.py have written: every second lesson is of these files in turn")
    p.add_argument("--held-photographs", nargs="+", default=[], help="the same, of other people and eyes, to judge on")
    p.add_argument("--minutes", type=float, default=40)
    p.add_argument("--rate", type=float, default=2e-3)
    p.add_argument("--batch", type=int, default=24)
    p.add_argument("--first", type=int, default=1000000)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--threads", type=int, default=1)
    p.add_argument("--ellipse", type=float, default=0, help="weight of the ellipse's loss beside that of the rays, reached half way: 0.15 counts about as much")
    p.add_argument("--device", default="cpu", help="where it trains: cpu, or cuda, whose memory keeps all strips")
    p.add_argument("--makers", type=int, default=1, help="generators side by side")
    p.add_argument("--held", type=int, default=96, help="photographs to judge on")
    p.add_argument("--half", action="store_true", help="multiply in bfloat16: half as long again where the processor has it")
    p.add_argument("--short", action="store_true")
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    torch.set_flush_denormal(True)
    torch.manual_seed(args.seed)
    rng = torch.Generator(args.device).manual_seed(args.seed)
    net = Net().to(memory_format=torch.channels_last)
    if args.start:
        (deepen if args.deepen else load)(net, args.start, args)
    if args.mean:
        weights.mean(net, args.mean[0], args.mean[1], float(args.mean[2]))
        args.minutes = 0
    print("%d parameters" % sum(v.numel() for v in net.parameters()), flush=True)
    held = None if args.short else held_out(args)
    if held and (args.start or args.mean):
        judge(net, held)
    net = net.to(args.device)
    mean = {k: v.clone() for k, v in net.state_dict().items()}
    optimiser = torch.optim.AdamW(net.parameters(), lr=args.rate, weight_decay=1e-3)
    if args.short:
        args.batch = 8
    strips = strips_of(args)
    begun, losses, ellipse, last = time.time(), [], [], time.time()
    while True:
        done = (time.time() - begun) / max(60 * args.minutes, 1e-9) if not args.short else len(losses) / 60
        if done >= 1:
            break
        evidence.pace(optimiser, args.rate, min(1, len(losses) / (20 if args.short else 100) + 0.02), done)
        x, crossing, shown = strips.next()
        x, (hot, seen) = jitter(x.float() / 255, rng), target(crossing, shown)
        if torch.rand(1, generator=rng, device=args.device) < 0.5:  # mirrored left to right: phi becomes pi - phi
            order = (RAYS // 2 - torch.arange(RAYS)) % RAYS
            x, crossing, hot, seen = x[..., order], crossing[..., order], hot[..., order], seen[..., order]
        if torch.rand(1, generator=rng, device=args.device) < 0.25:
            by = int(torch.randint(RAYS, (1,), generator=rng, device=args.device))
            x, crossing, hot, seen = x.roll(by, 3), crossing.roll(by, 1), hot.roll(by, 2), seen.roll(by, 1)
        with torch.autocast(x.device.type, dtype=torch.bfloat16, enabled=args.half):
            out = net(even(x).to(memory_format=torch.channels_last))
        loss, follows = losses_of(out.float(), crossing, hot, seen)
        optimiser.zero_grad()
        (loss + args.ellipse * min(1, 2 * done) * follows if args.ellipse else loss).backward()
        nn.utils.clip_grad_norm_(net.parameters(), 2)
        optimiser.step()
        losses.append(loss.detach())
        ellipse.append(follows.detach())
        with torch.no_grad():
            evidence.blend(mean, net.state_dict(), min(0.998, len(losses) / (len(losses) + 10)))
        if len(losses) % (100 if args.device == "cpu" else 1000) == 0:
            print("%5.1f min, step %d, of %d strips, loss %.4f, ellipse %.3f"
                  % ((time.time() - begun) / 60, len(losses), strips.seen, float(sum(losses[-100:]) / 100), float(sum(ellipse[-100:]) / 100)), flush=True)
        if args.keep and time.time() - last > 180:
            last = time.time()
            torch.save(mean, args.keep)
            other = Net()
            other.load_state_dict(mean)
            judge(other, held)
    losses, mean = [float(loss) for loss in losses], {name: value.cpu() for name, value in mean.items()}
    if args.short:
        first, end = np.mean(losses[:10]), np.mean(losses[-20:])
        print("loss %.3f, at the end %.3f" % (first, end))
        strips.close()
        assert end < 0.9 * first, "the loss does not fall"
        return
    strips.close()
    net = net.cpu()
    net.load_state_dict(mean)
    if losses:
        judge(net, held)
    if args.keep:
        torch.save(mean, args.keep)
    if args.out:
        weights.export(net, args.out, RAYS + 2 * WRAP, ROWS, PLANES, small=True)


if __name__ == "__main__":
    main()
