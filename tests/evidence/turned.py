#!/usr/bin/python3
"""Lessons for the network that tells how a head is turned: heads in three dimensions, of many shapes, in many lights, with hair and glasses.

    turned.py --faces FOLDER --data FOLDER --out LESSONS --first 35000 --count 100 [--sheet PNG]

FOLDER: the generator of face clips and the meshes that it reads, as for heads.py, whose irises, lamps and camera these are. Each number is a
person: shape, skin, hair, beard. The generator's ten modes of shape are widened (depth, nose, jaw, forehead), its mouth speaks, and what it
lacks is added: hair and beards, glasses, shoulders, what is behind. A lesson is a picture of SIDE px, RGB, whose eyes lie level, the middle
between them at MIDDLE and APART px apart, and LABELS floats: how the head is turned aside and how it nods (radians, Ry Rx from the head's
axes, x to its left, y up, z forward, to the camera's, seen along the line to the middle of its eyes), and 68 landmarks (px). A person
follows from its number. Needs python3-numpy, -scipy, -opencv and gcc.
"""
import argparse
import functools
import json
import sys

import cv2
import numpy as np

sys.dont_write_bytecode = True
import heads

SIDE, MIDDLE, APART = 144, (72, 58), 40
LABELS = 2 + 2 * 68
LIGHTS, VIEWS = 12, 6
F32 = np.float32
MOUTH = ["jawOpen", "jawLeft", "jawRight", "jawForward", "mouthSmile_", "mouthFrown_", "mouthPucker", "mouthFunnel", "mouthStretch_", "mouthPress_",
         "mouthUpperUp_", "mouthLowerDown_", "mouthRollLower", "mouthShrugUpper", "cheekPuff_", "mouthLeft", "mouthRight", "mouthDimple_"]
HAIR = [(.008, .006, .005), (.02, .013, .009), (.05, .03, .017), (.11, .065, .03), (.25, .17, .08), (.30, .28, .26), (.16, .05, .02)]


def step(x, a, b):
    t = np.clip((x - a) / (b - a), 0, 1)
    return t * t * (3 - 2 * t)


def noise(rng, shape, cells):
    small = rng.standard_normal((max(2, cells), max(2, cells))).astype(F32)
    return cv2.resize(small, shape[::-1], interpolation=cv2.INTER_CUBIC)


class Head(heads.Person):
    def __init__(self, number, args, work):
        import clips
        import skin
        whole = skin.build
        clips.CL["face_%d" % number]["ids"] = {}
        skin.build = functools.partial(whole, S=1024)
        skin.build.__code__ = whole.__code__
        try:
            super().__init__(number, args, work)
        finally:
            skin.build = whole
        S, rig = self.S, self.S.rig
        S.mo["H"][:] = 0
        self.middle = np.mean([rig.c[s] for s in "LR"], 0)
        S.look = self.middle
        expressions = np.load(args.data + "/meshes/ict/expressions.npz")
        self.mouth = {name: expressions[name].astype(float)[rig.R.ids] for name in expressions.files if name.split("_")[0] in [m.rstrip("_") for m in MOUTH]}
        marks = json.load(open(args.data + "/meshes/ict/vertex_indices.json"))["idx_to_landmark_verts"]
        self.marks = np.array([rig.R.mp[i] for i in marks])
        self.rest = rig.S @ rig.V0.astype(F32)
        self.shape = rig.S @ self.another_shape(rig.V0).astype(F32)
        self.hair_on()
        pose = rig.pose
        rig.pose = lambda w, G: (lambda P, R, v: (P + self.moved, R, v))(*pose(w, G))

    def another_shape(self, v):
        """Displacements of vertices, cm: none at the eyes."""
        rng, d = self.rng, v - self.middle
        nose = v[self.S.rig.R.mp[3615]] - self.middle
        near = np.min([np.linalg.norm(v - self.S.rig.c[s], axis=1) for s in "LR"], 0)
        out = d * np.array([rng.normal(0, .04), rng.normal(0, .05), rng.normal(0, .06)])
        blob = np.exp(-(((d - nose) / [1.5, 2.2, 1.8]) ** 2).sum(1))[:, None]
        out += blob * np.c_[d[:, 0] * rng.normal(0, .15), np.full(len(d), rng.normal(0, .22)), np.full(len(d), rng.normal(0, .3))]
        below = step(-d[:, 1], 2, 10)
        out += np.c_[d[:, 0] * below * rng.normal(0, .06) + below * rng.normal(0, .12), below * rng.normal(0, .5), below * rng.normal(0, .4)]
        above = step(d[:, 1], 1.5, 7)
        out += np.c_[np.zeros(len(d)), above * rng.normal(0, .5), above * rng.normal(0, .3)]
        return out * (1 - np.exp(-(near / 2.2) ** 4))[:, None]

    def hair_on(self):
        """How much each vertex is hair, and how far it stands out."""
        rng, d = self.rng, self.rest - self.middle
        kind = rng.choice(["bald", "short", "half", "long"], p=[.1, .4, .2, .3])
        line = rng.uniform(4.5, 7.5) + .25 * np.sin(3 * np.arctan2(d[:, 0], 6) + rng.uniform(0, 6.3)) - rng.uniform(.02, .07) * d[:, 0] ** 2
        low = dict(bald=99, short=rng.uniform(-3, 1), half=rng.uniform(-7, -2), long=-40)[kind]
        side = rng.uniform(-6.5, -3.5) + (rng.uniform(0, 2.5) if kind in ("half", "long") else 0)
        top = step(d[:, 1] - line, -.2, .5)
        back = step(side - d[:, 2], -.3, .8) * step(d[:, 1] - low, -.5, .5) * step(np.abs(d[:, 0]) + np.maximum(0, -d[:, 2] - 9), 3.5, 5)
        self.hair = (np.zeros(len(d)) if kind == "bald" else np.maximum(top, back)).astype(F32)
        out = d * [1, 1, .8] / np.linalg.norm(d, axis=1)[:, None]
        self.stands = (self.hair * rng.uniform(.2, 2.2))[:, None] * out
        self.hair_colour = np.array(HAIR[rng.integers(len(HAIR))]) * np.exp(rng.normal(0, .2, 3) * .5 + rng.normal(0, .25))
        self.falls = kind == "long" or (kind == "half" and rng.random() < .4)
        self.beard = rng.uniform(.1, .9) if rng.random() < .25 else 0
        self.beard_high = rng.uniform(-5.5, -3)
        self.skin_level = float(heads.linear(np.array(self.S.c["skin"]) / 255).mean())

    def speak(self):
        rng, moved = self.rng, 0
        if rng.random() < .7:
            for name in rng.choice(MOUTH, rng.integers(1, 4), replace=False):
                for end in ("L", "R") if name[-1] == "_" else ("",):
                    moved = moved + rng.uniform(0, .9) * (1 if not end else rng.uniform(.6, 1)) * self.mouth[name + end]
        self.moved = (self.shape + self.stands + (self.S.rig.S @ moved.astype(F32) if np.ndim(moved) else 0)).astype(F32)

    def view(self):
        """A picture from another side, and its labels."""
        rng, S, g, C = self.rng, self.S, self.g, self.scene.C
        wide = rng.random() < .5
        yaw = np.radians(np.clip(rng.uniform(-45, 45) if wide else rng.normal(0, 14), -50, 50))
        nod = np.radians(np.clip(rng.uniform(-32, 32) if rng.random() < .4 else rng.normal(0, 10), -38, 38))
        cy, sy, cn, sn = np.cos(yaw), np.sin(yaw), np.cos(nod), np.sin(nod)
        head = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cn, -sn], [0, sn, cn]])
        to = np.diag([1, -1, -1.]) @ head
        turn = (to @ g["Rc"].T).astype(F32)
        away = np.array([0, 0, np.exp(rng.uniform(np.log(30), np.log(200)))])
        origin = self.middle @ g["Rc"].T + g["t"]

        def moved(x):
            return C((x - origin) @ turn.T + away)

        V, N, D = moved(g["V"]), C(g["N"] @ turn.T), C(self.D @ turn.T)
        eyes = []
        for k in range(2):
            e = self.eyes[12 * k:12 * k + 12]
            eyes += [moved(e[:3]).ravel(), (turn @ e[3:].reshape(3, 3)).ravel()]
        eyes = C(np.concatenate(eyes))
        opening = {s: V[[S.rig.lid[s]["cin"], S.rig.lid[s]["cout"]]] for s in "LR"}
        flat = {s: (o[:, :2] / o[:, 2:]).mean(0) for s, o in opening.items()}
        apart = np.linalg.norm(flat["L"] - flat["R"])
        big = 2 * SIDE
        f = 2 * APART / apart
        centre = 2 * np.array(MIDDLE) - f * (flat["L"] + flat["R"]) / 2
        camera, x = (f, *centre), np.zeros((big, big, 3), F32)
        z, t, b = self.seen((big, big), camera, g["T"], V)
        self.shaded(camera, (z, t, b), self.lamps(), x, 1, V, N, D, eyes)
        x = self.dressed(x, t, b, f, centre, turn, away)
        x = cv2.resize(x, (SIDE, SIDE), interpolation=cv2.INTER_AREA)
        # skin's vertices come first, coarse ones before finer ones
        marks = V[self.marks]
        px = (f * marks[:, :2] / marks[:, 2:] + centre) / 2
        return heads.photographed(x, self.rng), np.r_[yaw, nod, px.ravel()].astype(F32)

    def dressed(self, x, t, b, f, centre, turn, away):
        """Hair, beard, what is behind, shoulders, glasses."""
        rng, g = self.rng, self.g
        big = x.shape[:2]
        strands = np.exp(.5 * noise(rng, big, 60) + .3 * noise(rng, big, 20))[..., None]
        skin = (t >= 0) & np.isin(g["mat"][t], (0, 1))
        tri, bary = g["T"][t[skin]], b[skin]
        weight = np.c_[1 - bary.sum(1), bary]
        hair, d = np.zeros(big, F32), np.zeros((*big, 3), F32)
        hair[skin] = (self.hair[tri] * weight).sum(1)
        d[skin] = ((self.rest - self.middle)[tri] * weight[..., None]).sum(1)
        level = x.mean(-1, keepdims=True) / self.skin_level
        shade = level * self.hair_colour * strands * (.6 + .8 * np.clip(level, 0, 1))
        ragged = np.clip(hair + .35 * noise(rng, big, rng.integers(30, 140)) * ((hair > .02) & (hair < .98)), 0, 1)[..., None]
        x = x * (1 - ragged) + shade * ragged
        if self.beard:
            mouth = np.exp(-((d[..., 0] / 2.6) ** 2 + ((d[..., 1] + 7.2) / .9) ** 2))
            on = step(self.beard_high - d[..., 1] + .3 * noise(rng, big, 12), 0, 1.5) * step(d[..., 2], -11, -7) * step(d[..., 1], -15, -12) * (1 - mouth) * skin
            on = (np.clip(on * self.beard * (.8 + .4 * noise(rng, big, 90)), 0, 1))[..., None]
            x = x * (1 - on) + level * self.hair_colour * on
        behind = np.clip(1 + rng.uniform(.1, .7) * noise(rng, big, rng.integers(2, 12)), .05, 4)[..., None] * rng.uniform(.01, .7, 3) * np.exp(.3 * noise(rng, big, 3))[..., None]
        behind = np.ascontiguousarray(behind, F32)
        for _ in range(rng.integers(0, 6)):
            q = (rng.uniform(-.2, 1.2, (rng.integers(3, 6), 2)) * big[0]).astype(np.int32)
            cv2.fillPoly(behind, [q], [float(v) for v in rng.uniform(.01, .8, 3)])

        def at(points):  # cm from the middle between the eyes, head's axes
            q = np.atleast_2d(points) @ (turn @ g["Rc"]).T + away
            return f * q[:, :2] / q[:, 2:] + centre

        if self.falls:
            a = np.linspace(0, np.pi, 12)
            wide = rng.uniform(8, 12)
            shell = np.c_[wide * np.cos(a), 4 + rng.uniform(7, 9) * np.sin(a), np.full(12, -9.)]
            shell = np.r_[shell, [[-wide * rng.uniform(.7, 1.4), rng.uniform(-25, -8), -9]], [[wide * rng.uniform(.7, 1.4), rng.uniform(-25, -8), -9]]]
            layer = np.zeros(big, F32)
            cv2.fillPoly(layer, [at(shell).astype(np.int32)], 1.)
            behind = behind * (1 - layer[..., None]) + layer[..., None] * self.hair_colour * strands * rng.uniform(.2, 1)
        if rng.random() < .85:
            w, y = rng.uniform(14, 24), rng.uniform(-20, -14)
            body = np.array([[-5.5, y + 2, -8], [5.5, y + 2, -8], [w, y - 4, -10], [w, -60, -10], [-w, -60, -10], [-w, y - 4, -10]])
            body = np.ascontiguousarray(at(body).astype(np.int32))
            colour = np.array([float(v) for v in rng.uniform(.01, .7, 3)])
            layer = np.zeros(big, F32)
            cv2.fillPoly(layer, [body], 1.)
            layer *= (t < 0) | (np.arange(big[0])[:, None] > at([[0, y + rng.uniform(0, 2), -6]])[0, 1])
            cloth = np.exp(.25 * noise(rng, big, 10))[..., None] * colour
            behind = behind * (1 - layer[..., None]) + layer[..., None] * cloth
            low = (layer * (t >= 0))[..., None]
            x = x * (1 - low) + low * cloth
        open_ = (t < 0)[..., None]
        x = np.where(open_, behind, x).astype(F32)
        if rng.random() < .25:
            x = self.glasses(x, at)
        return x

    def glasses(self, x, at):
        rng = self.rng
        a = np.linspace(0, 2 * np.pi, 40)
        w, h, power = rng.uniform(2.1, 2.9), rng.uniform(1.5, 2.4), rng.choice([.5, .7, 1.])
        eye = self.S.rig.c["L"] - self.middle
        front, drop = eye[2] + rng.uniform(2.6, 3.4), rng.uniform(-.6, .2)
        frame, lens = np.zeros(x.shape[:2], F32), np.zeros(x.shape[:2], F32)
        thick = int(rng.integers(1, 6))
        for side in (-1, 1):
            ring = np.c_[side * abs(eye[0]) + w * np.sign(np.cos(a)) * np.abs(np.cos(a)) ** power, drop + h * np.sign(np.sin(a)) * np.abs(np.sin(a)) ** power, np.full(40, front)]
            q = (at(ring) * 8).astype(np.int32)
            cv2.fillPoly(lens, [q], 1., cv2.LINE_AA, 3)
            if rng.random() < .9:
                cv2.polylines(frame, [q], True, 1., thick, cv2.LINE_AA, 3)
            arm = np.array([[side * (abs(eye[0]) + w), drop + .4 * h, front], [side * 7.6, drop + .4 * h, front - 2], [side * 7.8, drop, -9]])
            if (arm[1] - arm[0]) @ arm[1] > -99:
                cv2.polylines(frame, [(at(arm[:2]) * 8).astype(np.int32)], False, 1., thick, cv2.LINE_AA, 3)
        bridge = np.array([[-abs(eye[0]) + w, drop + .3, front], [0, drop + .5, front + .3], [abs(eye[0]) - w, drop + .3, front]])
        cv2.polylines(frame, [(at(bridge) * 8).astype(np.int32)], False, 1., thick, cv2.LINE_AA, 3)
        tint, shine = rng.uniform(.6, 1), rng.uniform(0, .08) * (rng.random() < .5)
        x = x * (1 - lens[..., None] * (1 - tint)) + lens[..., None] * shine
        return (x * (1 - frame[..., None]) + frame[..., None] * np.array(HAIR[rng.integers(len(HAIR))]) * rng.uniform(.5, 2)).astype(F32)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--faces", required=True, help="folder of the generator of face clips")
    p.add_argument("--data", required=True, help="folder of meshes and eyeballs that it reads")
    p.add_argument("--out", required=True, help="lessons, added to what is there")
    p.add_argument("--first", type=int, default=35000)
    p.add_argument("--count", type=int, default=60, help="people")
    p.add_argument("--sheet", metavar="PNG", help="a contact sheet of the last ones")
    args = p.parse_args()
    with heads.workshop(args) as work:
        for number in range(args.first, args.first + args.count):
            head, made = Head(number, args, work), []
            for _ in range(LIGHTS):
                head.speak()
                head.pose()
                made += [head.view() for _ in range(VIEWS)]
            with open(args.out, "ab") as file:
                for picture, labels in made:
                    file.write(picture.tobytes() + labels.tobytes())
            print("%d: %d lessons" % (number, len(made)), flush=True)
            if args.sheet:
                cv2.imwrite(args.sheet, np.vstack([np.hstack([m[0] for m in made[k:k + 12]]) for k in range(0, len(made), 12)])[..., ::-1])


if __name__ == "__main__":
    main()
