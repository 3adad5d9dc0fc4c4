#!/usr/bin/python3
"""Trains the network that tells pupil, iris, sclera, lash and reflection from skin, on drawn eyes, and writes it as ONNX.

    train.py --make build/tests/evidence/make_eyes --minutes 60 --out config/evidence.onnx
    train.py --make build/tests/evidence/make_eyes --short        a minute: the loss falls, asserted
    train.py --make build/tests/evidence/make_eyes --judge FILE   IoU and calibration of a checkpoint (.pt) or a network (.onnx) on the test
                                                                  split; with --out it is calibrated and written as ONNX

Pictures are made while training runs; none is stored. Needs python3-torch and python3-numpy.
Input of the network: 1 x 3 x H x W, sRGB as encoded, 0..1, H and W multiples of 32. Output: 1 x 6 x H/2 x W/2, logits of
skin, lash, sclera, iris, pupil, reflection; its pixel (i, j) covers the input's 2i, 2i + 1 and 2j, 2j + 1.
"""
import argparse
import copy
import math
import os
import queue
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import torch
from torch import nn
from torch.nn import functional as F

sys.dont_write_bytecode = True  # nothing is left beside the sources
import ring
import weights

CLASSES = ("skin", "lash", "sclera", "iris", "pupil", "reflection")
WEIGHT = (0.8, 1.0, 1.2, 1.2, 1.5, 1.5)
CHANNELS = (16, 24, 40, 64, 80)
SMALL, LARGE = (128, 96), (192, 160)


def step(i, o, stride=1):
    return nn.Sequential(nn.Conv2d(i, o, 3, stride, 1, bias=False), nn.BatchNorm2d(o), nn.ReLU(inplace=True))


class Net(nn.Module):
    """A thin U-Net whose finest level is half of the picture's."""

    def __init__(self, c=CHANNELS):
        super().__init__()
        n = len(c)
        self.down = nn.ModuleList()
        for k in range(n):
            again = 2 if k >= 3 else 1
            self.down.append(nn.Sequential(step(c[k - 1] if k else 3, c[k], 2), *[step(c[k], c[k]) for _ in range(again)]))
        self.thin = nn.ModuleList([nn.Conv2d(c[k], c[k - 1], 1) for k in range(n - 1, 0, -1)])
        self.up = nn.ModuleList([step(c[k - 1], c[k - 1]) for k in range(n - 1, 0, -1)])
        self.out = nn.Conv2d(c[0], len(CLASSES), 1)

    def in_order(self):
        """Each convolution with its normalisation, or None, in the order in which they run."""
        blocks = [block for down in self.down for block in down]
        for thin, up in zip(self.thin, self.up):
            blocks += [(thin, None), up]
        return [(block[0], block[1]) for block in blocks] + [(self.out, None)]

    def forward(self, x):
        x = x * 4 - 2
        kept = []
        for down in self.down:
            x = down(x)
            kept.append(x)
        for k, (thin, up) in enumerate(zip(self.thin, self.up)):
            x = up(F.interpolate(thin(x), scale_factor=2, mode="nearest") + kept[len(kept) - 2 - k])
        return self.out(x)


class Pictures:
    """Batches from the generator, made beside the training. again: the share of a batch that was seen before, of the last KEPT.
    makers: generators side by side, their pictures' numbers APART from each other."""

    KEPT, APART = 3000, 1000000

    def __init__(self, make, first, size, batch, test=False, again=0.0, makers=1):
        self.size, self.batch, self.old = size, batch - int(batch * again), int(batch * again)
        self.kept, self.rng, self.process = [], np.random.default_rng(first), []
        self.queue = queue.Queue(4 * makers)
        for k in range(makers):
            command = [make, str(first + k * self.APART), "100000000", str(size[0]), str(size[1])] + (["test"] if test else [])
            self.process.append(subprocess.Popen(command, stdout=subprocess.PIPE, bufsize=1 << 22))
            threading.Thread(target=self.read, args=(self.process[-1],), daemon=True).start()

    def read(self, process):
        w, h = self.size
        one = w * h * 4
        while True:
            data = process.stdout.read(one * self.batch)
            if len(data) < one * self.batch:
                return
            a = np.frombuffer(data, np.uint8).reshape(self.batch, one)
            rgb = a[:, : 3 * w * h].reshape(self.batch, h, w, 3).transpose(0, 3, 1, 2)
            self.queue.put((torch.from_numpy(np.ascontiguousarray(rgb)), torch.from_numpy(a[:, 3 * w * h:].reshape(self.batch, h, w).copy())))

    def next(self):
        rgb, label = self.queue.get()
        if not self.old:
            return rgb, label
        self.kept.extend(zip(rgb, label))
        if len(self.kept) > self.KEPT:
            del self.kept[:self.batch]
        picked = [self.kept[i] for i in self.rng.integers(0, len(self.kept), self.old)]
        return torch.cat([rgb, torch.stack([p[0] for p in picked])]), torch.cat([label, torch.stack([p[1] for p in picked])])

    def close(self):
        for process in self.process:
            process.terminate()
        while not self.queue.empty():
            self.queue.get()
        for process in self.process:
            process.wait()


class Stored(Pictures):
    """The same for a device, which keeps all of them."""

    KEPT, LEAST, TOGETHER = 400000, 4000, 32

    def __init__(self, make, first, size, batch, device, makers):
        super().__init__(make, first, size, self.TOGETHER, makers=makers)
        self.drawn = batch
        self.ring = ring.Ring(self.KEPT, device, (((3, size[1], size[0]), torch.uint8), ((size[1], size[0]), torch.uint8)))

    def next(self):
        while self.ring.made < self.LEAST or not self.queue.empty():
            self.ring.add(*self.queue.get())
        return self.ring.draw(self.drawn)


class Lessons:
    """Pictures of LARGE that heads.py has written, or still writes, drawn at random; size: what is cut out of each, anywhere."""

    AGAIN = 200  # draws until the file is looked at again

    def __init__(self, path, seed, size=LARGE):
        self.path, self.kept, self.draws = path, None, 0
        self.rng, self.size = np.random.default_rng(seed), size

    def draw(self, count):
        w, h = LARGE
        if self.draws % self.AGAIN == 0:
            whole = os.path.getsize(self.path) // (w * h * 4)
            self.kept = np.memmap(self.path, np.uint8, "r", shape=(whole, w * h * 4))
        self.draws += 1
        lessons = self.kept[np.sort(self.rng.integers(0, len(self.kept), count))]
        x, y = self.rng.integers(0, w - self.size[0] + 1), self.rng.integers(0, h - self.size[1] + 1)
        rgb = lessons[:, : 3 * w * h].reshape(count, h, w, 3).transpose(0, 3, 1, 2)[:, :, y : y + self.size[1], x : x + self.size[0]]
        label = lessons[:, 3 * w * h :].reshape(count, h, w)[:, y : y + self.size[1], x : x + self.size[0]]
        return torch.from_numpy(rgb.copy()), torch.from_numpy(label.copy())


class Mixed:
    """Batches of which a number are lessons."""

    def __init__(self, pictures, lessons, count):
        self.pictures, self.lessons, self.count = pictures, lessons, count

    def next(self):
        pairs = [self.pictures.next(), self.lessons.draw(self.count)]
        return tuple(torch.cat([a, b.to(a.device)]) for a, b in zip(*pairs))

    def close(self):
        self.pictures.close()


def pictures_of(args, first, size):
    lessons = int(args.batch * args.share) if args.lessons else 0
    batch = args.batch - lessons
    if args.device == "cpu":
        pictures = Pictures(args.make, first, size, batch, again=args.again, makers=args.makers)
    else:
        pictures = Stored(args.make, first, size, batch, args.device, args.makers)
    return Mixed(pictures, Lessons(args.lessons, first, size), lessons) if lessons else pictures


def soft_label(label):
    """Shares of the classes in each 2 x 2 pixels."""
    hot = torch.zeros(label.shape[0], len(CLASSES), *label.shape[1:], device=label.device)
    hot.scatter_(1, label[:, None].long(), 1)
    return F.avg_pool2d(hot, 2)


def jitter(rgb, rng):
    """Colour, gamma, patches of one colour: what is cheap here."""
    x, device = rgb.float() / 255, rgb.device
    n, _, h, w = x.shape

    def draw(*shape, of=torch.rand):
        return of(*shape, generator=rng, device=device)

    gamma = torch.where(draw(n, 1, 1, 1) < 0.3, torch.exp(0.25 * draw(n, 1, 1, 1, of=torch.randn)), torch.ones(1, device=device))
    x = x.clamp(min=1e-4) ** gamma
    gain = torch.exp(0.12 * draw(n, 3, 1, 1, of=torch.randn) + 0.15 * draw(n, 1, 1, 1, of=torch.randn))
    x = (x * gain).clamp(0, 1)
    # A patch from 4 px to a third of the picture in one of eight.
    tall, wide = 4 + draw(n, 1, 1) * (h / 3 - 4), 4 + draw(n, 1, 1) * (w / 3 - 4)
    row, column = torch.arange(h, device=device)[None, :, None] - draw(n, 1, 1) * (h - tall), torch.arange(w, device=device) - draw(n, 1, 1) * (w - wide)
    inside = (row >= 0) & (row < tall) & (column >= 0) & (column < wide) & (draw(n, 1, 1) < 0.12)
    return torch.where(inside[:, None], draw(n, 3, 1, 1), x)


def turned(x, label, rng):
    """Mirrored, upside down: each picture by itself."""
    for axis, chance in ((2, 0.5), (1, 0.3)):
        here = torch.rand(len(x), 1, 1, generator=rng, device=x.device) < chance
        x, label = torch.where(here[:, None], x.flip(axis + 1), x), torch.where(here, label.flip(axis), label)
    return x, label


def loss_of(out, hot):
    weight = out.new_tensor(WEIGHT)
    cross = -(F.log_softmax(out, 1) * hot * weight[None, :, None, None]).sum(1).mean()
    p = out.softmax(1)
    dice = 1 - (2 * (p * hot).sum((0, 2, 3)) + 50) / ((p + hot).sum((0, 2, 3)) + 50)
    return cross + 0.3 * dice[1:].mean()


def judge(net, name, pictures, batches):
    """IoU per class on batches that pictures() makes, at the labels' resolution halved, and the expected calibration error of the probabilities of
    skin, sclera, iris and pupil: the mean distance of probability and share in ten bins of 0.02 and more, weighted by their pixels."""
    net.eval()
    judged = 0
    both, either, bins = np.zeros(6), np.zeros(6), np.zeros((3, 6, 10))
    with torch.no_grad():
        for _ in range(batches):
            rgb, label = pictures()
            judged += len(rgb)
            p, hot = net(rgb.float() / 255).softmax(1), soft_label(label)
            got, true = p.argmax(1), hot.argmax(1)
            for c in range(6):
                both[c] += int(((got == c) & (true == c)).sum())
                either[c] += int(((got == c) | (true == c)).sum())
                said = p[:, c].reshape(-1).numpy()
                seen = said > 0.02
                place = np.minimum((said[seen] * 10).astype(int), 9)
                for k, weight in enumerate((np.ones(seen.sum()), said[seen], hot[:, c].reshape(-1).numpy()[seen])):
                    bins[k, c] += np.bincount(place, weight, 10)
    iou, error = both / np.maximum(either, 1), np.abs(bins[1] - bins[2]).sum(1) / np.maximum(bins[0].sum(1), 1)
    print("  %s, %d pictures, IoU: " % (name, judged) + " ".join("%s %.3f" % p for p in zip(CLASSES, iou)), flush=True)
    print("  calibration error: " + " ".join("%s %.4f" % p for p in zip(CLASSES, error)), flush=True)
    return iou


def judge_all(net, args, batches, batch=16):
    """On the generator's test split, and on lessons held out, where they are told."""
    pictures = Pictures(args.make, 0, LARGE, batch, True)
    judge(net, "test split", pictures.next, batches)
    pictures.close()
    if args.held:
        lessons = Lessons(args.held, 0)
        judge(net, "lessons held out", lambda: lessons.draw(batch), batches)


def calibrated(net, args, pictures=800, batch=16, kept=200):
    """The network with true probabilities on pictures for training that it has not seen; kept pixels of each."""
    net, rng = copy.deepcopy(net).eval(), np.random.default_rng(0)
    source, logits, share = Pictures(args.make, 900000000, LARGE, batch), [], []
    if args.lessons:
        source = Mixed(source, Lessons(args.lessons, 1), int(batch * args.share))
    with torch.no_grad():
        for _ in range(pictures // batch):
            rgb, label = source.next()
            out, hot = net(rgb.float() / 255), soft_label(label)
            at = torch.from_numpy(rng.integers(0, out.shape[2] * out.shape[3], (len(out), 1, kept))).expand(-1, len(CLASSES), -1)
            for values, into in ((out, logits), (hot, share)):
                into.append(values.flatten(2).gather(2, at).transpose(1, 2).reshape(-1, len(CLASSES)))
    source.close()
    scale, bias = weights.calibrate(net, torch.cat(logits), torch.cat(share))
    print("  calibrated: scale %.3f, bias " % scale + " ".join("%+.2f" % b for b in bias), flush=True)
    return net


def pace(optimiser, rate, warm, done):
    """Sets the rate: its share while it warms up, then half a cosine over what is done of the schedule."""
    for group in optimiser.param_groups:
        group["lr"] = rate * warm * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * done)))


def blend(into, net, keep):
    """into = keep into + (1 - keep) net, for all that a network holds."""
    for a, b in zip(into.values(), net.values()):
        if a.dtype.is_floating_point:
            a.mul_(keep).add_(b, alpha=1 - keep)
        else:
            a.copy_(b)


class Meeting:
    """Weights in shared memory with which each worker now and then averages its own."""

    def __init__(self, net):
        self.state = {name: value.clone().contiguous().share_memory_() for name, value in net.state_dict().items()}
        self.lock = torch.multiprocessing.Lock()

    def visit(self, net):
        with torch.no_grad(), self.lock:
            blend(self.state, net.state_dict(), 0.5)
            blend(net.state_dict(), self.state, 0)


def optimise(net, optimiser, pictures, rng, half):
    rgb, label = pictures.next()
    x, label = turned(jitter(rgb, rng), label, rng)
    with torch.autocast(x.device.type, dtype=torch.bfloat16, enabled=half):
        out = net(x.to(memory_format=torch.channels_last))
    loss = loss_of(out.float(), soft_label(label))
    optimiser.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(net.parameters(), 2)
    optimiser.step()
    return loss.detach()


def new_net(args):
    torch.manual_seed(args.seed)
    net = Net().to(memory_format=torch.channels_last)
    if args.start:
        load(net, args.start, args)
    return net


def load(net, path, args):
    """A checkpoint, or a network that was written as ONNX."""
    if not path.endswith(".onnx"):
        net.load_state_dict(torch.load(path)["net"])
        return
    pictures = Pictures(args.make, 800000000, LARGE, 16)
    weights.read(net, path, (pictures.next()[0].float() / 255 for _ in range(40)))
    pictures.close()


def train(args, worker=0, meeting=None):
    """One worker of args.workers; the first keeps the weights' running mean, which is better than their last value."""
    torch.set_num_threads(args.threads)
    torch.set_flush_denormal(True)
    rng = torch.Generator(args.device).manual_seed(args.seed + worker)
    net = new_net(args).to(args.device)
    mean, visits = copy.deepcopy(net), 0
    optimiser = torch.optim.AdamW(net.parameters(), lr=args.rate, weight_decay=1e-3)
    begun, kept, number, losses = time.time(), time.time(), args.first + 100000000 * worker, []
    size = SMALL if args.small > 0 else LARGE
    pictures = pictures_of(args, number, size)
    while True:
        done = (time.time() - begun) / (60 * args.minutes) if not args.short else len(losses) / args.short_steps
        if done >= 1:
            break
        if size == SMALL and done > args.small:
            pictures.close()
            size, number = LARGE, number + 50000000
            pictures = pictures_of(args, number, size)
        pace(optimiser, args.rate, min(1, len(losses) / (20 if args.short or args.start else 200) + 0.02), done)
        losses.append(optimise(net, optimiser, pictures, rng, args.half))
        if meeting and len(losses) % 20 == 0:
            meeting.visit(net)
        if worker:
            continue
        if len(losses) % 4 == 0:
            visits += 1
            blend(mean.state_dict(), net.state_dict(), min(0.995, visits / (visits + 10)))
        if len(losses) % (50 if args.device == "cpu" else 1000) == 0:
            print("%5.1f min, step %d, loss %.4f" % ((time.time() - begun) / 60, len(losses), float(sum(losses[-50:]) / 50)), flush=True)
        if args.keep and time.time() - kept > 60 * args.every:
            kept = time.time()
            torch.save({"net": mean.state_dict(), "steps": len(losses)}, args.keep)
            judge_all(copy.deepcopy(mean).cpu(), args, 16)
    pictures.close()
    return mean.cpu(), [float(loss) for loss in losses]


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--make", required=True)
    p.add_argument("--out", help="ONNX file")
    p.add_argument("--keep", help="checkpoint file")
    p.add_argument("--start", help="checkpoint or ONNX file to begin with")
    p.add_argument("--every", type=float, default=4, help="minutes between checkpoints")
    p.add_argument("--minutes", type=float, default=60)
    p.add_argument("--small", type=float, default=0.8, help="share of the time on small pictures")
    p.add_argument("--rate", type=float, default=2e-3)
    p.add_argument("--batch", type=int, default=8)
    p.add_argument("--again", type=float, default=0.5, help="share of each batch that was seen before")
    p.add_argument("--first", type=int, default=0)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--workers", type=int, default=1, help="processes that train side by side and average their weights")
    p.add_argument("--threads", type=int, default=1, help="of each")
    p.add_argument("--device", default="cpu", help="where it trains: cpu, or cuda, whose memory keeps all pictures")
    p.add_argument("--makers", type=int, default=1, help="generators side by side")
    p.add_argument("--half", action="store_true", help="multiply in bfloat16: half as long again where the processor has it")
    p.add_argument("--short", action="store_true")
    p.add_argument("--short-steps", type=int, default=80)
    p.add_argument("--lessons", help="what heads.py has written, to mix in")
    p.add_argument("--share", type=float, default=0.35, help="of each batch, that is lessons")
    p.add_argument("--held", help="lessons to judge by, of other people")
    p.add_argument("--judge", metavar="FILE")
    p.add_argument("--pictures", type=int, default=512, help="of the test split, for --judge")
    args = p.parse_args()
    torch.set_num_threads(args.threads)
    if args.judge:
        net = Net()
        load(net, args.judge, args)
        if args.out:
            net = calibrated(net, args)
            weights.export(net, args.out, *LARGE)
        judge_all(net, args, args.pictures // 16)
        return
    if args.short:
        args.batch, args.small, args.keep, args.workers = 8, 1, None, 1
    # Ended from outside, it ends the workers beside it.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    meeting = Meeting(new_net(args)) if args.workers > 1 else None
    beside = [torch.multiprocessing.Process(target=train, args=(args, k, meeting), daemon=True) for k in range(1, args.workers)]
    for process in beside:
        process.start()
    net, losses = train(args, 0, meeting)
    for process in beside:
        process.join()
    if args.short:
        first, last = np.mean(losses[:10]), np.mean(losses[-20:])
        print("loss %.3f, at the end %.3f" % (first, last))
        assert last < 0.8 * first, "the loss does not fall"
        return
    if args.keep:
        torch.save({"net": net.state_dict(), "steps": len(losses)}, args.keep)
    if args.out:
        net = calibrated(net, args)
        weights.export(net, args.out, *LARGE)
    judge_all(net, args, args.pictures // 16)


if __name__ == "__main__":
    main()
