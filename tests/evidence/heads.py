#!/usr/bin/python3
"""Lessons for the evidence network from heads in three dimensions: another renderer's eyes, lids and skin, in other lights, with labels.

    heads.py --faces FOLDER --data FOLDER --out LESSONS --first 30000 --count 60 [--sheet PNG]
    heads.py --faces FOLDER --data FOLDER --out PHOTOGRAPHS --photographs --first 33000 --count 60

FOLDER: the generator of face clips (ICT-FaceKit's head, a rasteriser, gaze and lids that follow it) and the meshes that it reads; neither is
part of this repository. Each number is a person: identity, skin, iris, lashes. Of each some poses, and of each pose windows round both eyes and
elsewhere on the face. What the generator lacks is added: irises of any colour, soft limbi, lids made up, the shadow of lids on the globe, windows and
lamps in the cornea, light from all sides, exposure, white balance, blur, grain, JPEG. LESSONS is what train.py --lessons reads: pictures of
192 x 160, RGB and then labels, one after the other. PHOTOGRAPHS, with the limbi's ellipses, are for what learns of the limbus
(kept.h tells the format). A person follows from its number. Needs python3-numpy, -scipy, -opencv and gcc.
"""
import argparse
import contextlib
import ctypes
import functools
import os
import subprocess
import sys
import tempfile

import cv2
import numpy as np

sys.dont_write_bytecode = True
SIZE = (192, 160)
SKIN, LASH, SCLERA, IRIS, PUPIL, REFLECTION = range(6)
# Linear colours of irises, from nearly black to pale.
IRISES = [(.014, .008, .005), (.032, .017, .010), (.065, .032, .016), (.11, .055, .025), (.16, .095, .038), (.15, .125, .060), (.13, .14, .09),
          (.15, .19, .19), (.17, .22, .28), (.24, .30, .34)]
POSES, WINDOWS = 10, 10
F32 = np.float32
NO_LAMPS = np.zeros((1, 12), F32)
TEXTURE_LIMBUS = (.97, 1.03)  # radius in the texture, over that of its limbus: iris inside, sclera outside


def limbus_angle():
    """Where half of the light is the sclera's, over the angle of the rig's limbus from the axis. The shader goes from what the cornea shows to the
    texture between .955 and 1.03, and what it takes from the texture there is sclera from TEXTURE_LIMBUS on only."""
    x = np.linspace(.9, 1.1, 20001)
    t = np.clip((x - .955) / .075, 0, 1)
    radius = np.where(x < 1, x, 1 + .62 * (x - 1))
    share = t * t * (3 - 2 * t) * np.clip((radius - TEXTURE_LIMBUS[0]) / (TEXTURE_LIMBUS[1] - TEXTURE_LIMBUS[0]), 0, 1)
    return float(np.interp(.5, share, x))


LIMBUS = limbus_angle()
SOFT, SOFTEST = 7700000, (.01, .07)  # of a person's limbus: what its random numbers start from; standard deviation of its blur, radii of the limbus


def soften(picture, ball, away, sigma):
    """The picture with its limbus as people have it, less sharp than the shader's: blurred near it by sigma px, lids and lashes left out. What is blurred alike to both
    sides has its middle where it was. away: from the limbus, radii of it."""
    mask = ball.astype(F32)
    mean = cv2.GaussianBlur(picture * mask[..., None], (0, 0), sigma) / np.maximum(cv2.GaussianBlur(mask, (0, 0), sigma), 1e-3)[..., None]
    share = mask * np.clip((.3 - away) / .1, 0, 1)
    return picture + share[..., None] * (mean - picture)


def brows_of(skin, build, *args):
    """Runs the skin generator, and takes the hairs of the brows out of its frame as it returns: its pictures do not tell them apart."""
    kept = {}

    def look(frame, event, _):
        if event == "return" and frame.f_code is build.__code__:
            kept["hair"] = frame.f_locals["hair"]

    sys.setprofile(look)
    build(*args)
    sys.setprofile(None)
    return kept["hair"]


def linear(x):
    return np.where(x <= .04045, x / 12.92, ((x + .055) / 1.055) ** 2.4)


def encoded(x):
    x = np.clip(x, 0, 1)
    return np.where(x <= .0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - .055)


def iris_texture(texture, rng):
    """The eyeball's texture with another iris and another sclera; its pupil ends at half of the iris' radius, 0.1385 of the width."""
    h, w = texture.shape[:2]
    x = linear(texture[..., :3].astype(F32) / 255)
    yy, xx = np.mgrid[:h, :w]
    radius = np.hypot(xx / w - .5, yy / h - .5) / .1385
    level = x.mean(-1)
    fibres = level / level[(radius > .55) & (radius < .95)].mean()
    base = np.array(IRISES[rng.integers(len(IRISES))]) * np.exp(rng.normal(0, .2, 3)) * np.exp(rng.normal(0, .2))
    inner = base * np.exp(rng.normal(0, .25, 3)) if rng.random() < .5 else np.array([.08, .04, .016]) * np.exp(rng.normal(0, .3))
    share = 1 / (1 + np.exp((radius - rng.uniform(.6, .85)) / .06)) * (rng.random() < .5)
    new = (base * (1 - share[..., None]) + inner * share[..., None]) * fibres[..., None] ** rng.uniform(.5, 1.5)
    ring = 1 - rng.uniform(0, .7) * np.clip((radius - rng.uniform(.8, .95)) / .12, 0, 1)
    new *= ring[..., None]
    new = np.where(radius[..., None] < .49, x * .3, new)
    white = linear(np.array([.93, .90, .87]) * np.array([1, rng.uniform(.93, 1), rng.uniform(.85, 1)])) * rng.uniform(.7, 1.05)
    red = rng.uniform(0, 1.4)
    sclera = np.clip(x / np.maximum(x[radius > 1.4].mean(0), 1e-3), .02, 1.6) ** red * white
    blend = np.clip((radius - TEXTURE_LIMBUS[0]) / (TEXTURE_LIMBUS[1] - TEXTURE_LIMBUS[0]), 0, 1)[..., None]
    return np.ascontiguousarray(np.clip(encoded(new * (1 - blend) + sclera * blend) * 255 + .5, 0, 255).astype(np.uint8))


def boxes(rng, key):
    """Lamps and windows that the cornea mirrors: direction, sides, half widths, strength."""
    out = []

    def axes(d, roll):
        d = d / np.linalg.norm(d)
        u = np.cross([0, 1, 0], d)
        u /= np.linalg.norm(u) + 1e-9
        v = np.cross(d, u)
        return d, np.cos(roll) * u + np.sin(roll) * v, np.cos(roll) * v - np.sin(roll) * u

    def add(d, half_w, half_h, strength, roll):
        d, u, v = axes(d, roll)
        out.append([*d, *u, *v, half_w, half_h, strength])

    for k in range(rng.integers(0, 4)):
        d = key if k == 0 else np.array([rng.uniform(-1, 1), rng.uniform(-.9, .4), -rng.uniform(.4, 1)])
        strength = np.exp(rng.uniform(np.log(2), np.log(60)))
        half_w, half_h, roll = rng.uniform(.03, .35), rng.uniform(.03, .4), rng.normal(0, .1)
        if rng.random() < .35:  # the panes of a window
            n, m = rng.integers(1, 4), rng.integers(1, 4)
            d, u, v = axes(d, roll)
            for i in range(n):
                for j in range(m):
                    add(d + u * half_w * (2 * i + 1 - n) / n + v * half_h * (2 * j + 1 - m) / m, half_w / n * .88, half_h / m * .88, strength, roll)
        else:
            add(d, half_w, half_h, strength, roll)
    return np.array(out, F32).reshape(-1, 12)


def paint(albedo, mesh, ids, rng):
    """Lids made up, in the skin's map: the rings of vertices round the opening."""
    size = albedo.shape[0]
    mask = np.zeros((size, size), F32)
    at = {}
    for f, t in zip(mesh["fv"], mesh["ft"]):
        if max(f) < 9409:
            for i, j in zip(f, t):
                if mesh["vt"][j][0] < 1:
                    at[i] = mesh["vt"][j]
    cm = size * .034
    for side in "LR":
        rings = mesh["A"]["concentric_rings_0_15_unordered"][side]
        for k in ids:
            for i in rings[k]:
                if i in at:
                    cv2.circle(mask, (int(at[i][0] * size), int((1 - at[i][1]) * size)), int(.09 * cm), 1., -1)
    mask = cv2.GaussianBlur(mask, (0, 0), rng.uniform(.03, .15) * cm)[..., None] * rng.uniform(.3, .95)
    return np.clip(albedo * (1 - mask) + mask * np.array(rng.uniform(0, 110) * np.exp(rng.normal(0, .5, 3)), F32), 0, 255).astype(np.uint8)


class Person:
    def __init__(self, number, args, work):
        import clips
        import scene
        import skin
        self.rng = rng = np.random.default_rng([number, 77])
        self.name, self.lib_path = "face_%d" % number, work + "/rast.so"
        c = clips.CL[self.name]
        c["ids"] = {i: float(np.clip(rng.normal(0, .8), -2, 2)) for i in range(10)}
        c["skin"] = tuple(int(np.clip(v * np.exp(rng.normal(0, .06)), 20, 250)) for v in c["skin"])
        c["lash"] = (int(rng.uniform(50, 170)), int(rng.uniform(25, 100)), rng.uniform(.45, 1.0), rng.uniform(.2, .5))
        hair = brows_of(skin, skin.build, args.data, work, self.name)
        self.S, self.scene = scene.Scene(self.name, args.data, self.lib_path), scene
        size = self.size = 3072
        albedo = cv2.imread(work + "/skin_%s.png" % self.name)[..., ::-1]
        height = cv2.imread(work + "/bump_%s.png" % self.name, 0).astype(F32)
        for kind in ("skin", "bump"):
            os.remove(work + "/%s_%s.png" % (kind, self.name))
        albedo = np.ascontiguousarray(cv2.resize(albedo, (size, size), interpolation=cv2.INTER_AREA))
        if rng.random() < .35:
            albedo = paint(albedo, self.S.M, [[3], [3, 4], [4, 5, 6], [3, 4, 5, 6, 7]][rng.integers(4)], rng)
        self.albedo = np.ascontiguousarray(albedo)
        self.brow = cv2.resize(hair, (size, size), interpolation=cv2.INTER_AREA)
        rough = rng.uniform(.6, 2.)
        height = (cv2.resize(height, (size, size), interpolation=cv2.INTER_AREA) - 128) / 36 * F32(1.25e-3 * rough)
        gx, gy = cv2.Sobel(height, cv2.CV_32F, 1, 0, ksize=3) / 8, cv2.Sobel(height, cv2.CV_32F, 0, 1, ksize=3) / 8
        self.slope = float(max(np.percentile(np.abs(gx), 99.7), np.percentile(np.abs(gy), 99.7)) / 127)
        self.bumps = np.ascontiguousarray(np.clip(np.stack([gx, gy], -1) / self.slope, -127, 127).astype(np.int8))
        texture = cv2.imread(args.data + "/eyeballs/%s.png" % ("eyeball_green", "eyeball_brown")[rng.integers(2)])[..., :3][..., ::-1]
        self.eye = iris_texture(texture, rng)
        self.lash = np.array([.018, .013, .010]) * np.exp(rng.normal(.2, .6))
        other = np.random.default_rng(number + SOFT)
        self.soft = other.uniform(*SOFTEST) if other.random() < .6 else 0

    def pose(self):
        """Another head pose, gaze, opening and light."""
        S, rng, scene = self.S, self.rng, self.scene
        c = S.c
        yaw, pitch = np.radians(rng.normal(0, 16)), np.radians(rng.normal(0, 9))
        roll = np.radians(rng.normal(0, 7) if rng.random() < .85 else rng.uniform(-180, 180))
        cy, sy, cp, sp, cr, sr = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
        turn = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        S.Rhc = np.diag([1, -1, -1.]) @ turn
        S.t0 = np.array([0, 0, rng.uniform(35, 90)]) - S.Rhc @ S.look
        key = np.array([rng.uniform(-1, 1), rng.uniform(-1, .35), -rng.uniform(.1, 1)])
        key /= np.linalg.norm(key)
        colour = np.exp(rng.normal(0, .18) * np.array([1, 0, -1.2]))
        strong, lights, n = rng.uniform(.2, 1.6), [], 5
        for _ in range(n):
            d = key + rng.normal(0, rng.uniform(.02, .3), 3)
            lights.append([*(d / np.linalg.norm(d)), *(1.3 / n * strong * colour)])
        fill, tint, up = rng.uniform(.25, 1.1), np.exp(rng.normal(0, .05, 3)), rng.uniform(0, .8)
        for i in range(16):
            z = 1 - (i + .5) / 16 * 1.02
            a, r = i * 2.39996, np.sqrt(max(0, 1 - z * z))
            d = np.array([r * np.cos(a), r * np.sin(a), -z])
            lights.append([*(d / np.linalg.norm(d)), *(.07 * fill * (1 + up * -d[1]) * (.6 + .5 * z) * tint)])
        S.L = scene.C(np.array(lights))
        g = S.assemble(int(rng.integers(0, 180)) * 16 + 8)
        E, D = S.light(g)
        n, rg = len(g["V"]), S.rig
        uv, vc = np.zeros((n, 2), F32), np.zeros(n, F32)
        uv[:g["nskin"]], vc[:g["nskin"]] = np.nan_to_num(rg.R.uv), rg.VC
        at, deep, wide = g["nskin"], rng.uniform(0, .85), rng.uniform(.04, .16)
        for s in rg.eyes:
            m = len(rg.eyeP)
            ball = slice(at, at + m)
            q0, q1 = g["V"][rg.lid[s]["cin"]], g["V"][rg.lid[s]["cout"]]
            u = (q1 - q0) / np.linalg.norm(q1 - q0)
            q = g["V"][ball] - (q0 - u * .03)
            d = np.sqrt((q @ u / 1.5) ** 2 + (q ** 2).sum(1) - (q @ u) ** 2)
            vc[ball] = .9 / (1 + np.exp(np.minimum((d - .13) / .025, 60)))
            # Lids stand before the globe, and take its light near their margins: the upper one most of it.
            for margin, share in (("full_up", 1.), ("full_lo", .5)):
                lid = g["V"][rg.lid[s][margin]]
                near = np.sqrt(((g["V"][ball][:, None] - lid[None]) ** 2).sum(-1).min(1))
                E[ball] *= (1 - deep * share * np.exp(-near / wide))[:, None].astype(F32)
            at += m
        self.g, self.E, self.D, self.uv, self.vc = g, E, D, uv, vc
        eyes = [np.r_[rg.c[s] @ g["Rc"].T + g["t"], (g["Rc"] @ g["R"][s]).ravel()] for s in "LR"]
        self.eyes, self.key, self.pupil = scene.C(np.concatenate(eyes)), key, rng.uniform(.22, .6)
        self.boxes = boxes(rng, key)
        self.ground = rng.uniform(.02, .6, 3)

    def parameters(self):
        """Of the shader's eyes: angle of the limbus, iris plane and radius, its radius in the texture, the pupil's."""
        import rig
        return self.scene.C([rig.THL, 1.30, .552, .1385, self.pupil])

    def lamps(self):
        return self.boxes if len(self.boxes) else NO_LAMPS

    def seen(self, size, camera, triangles, vertices):
        """Depth, triangle and place in it, in each pixel of a picture of size (width, height). camera: focal length and principal point, px."""
        (w, h), (f, cx, cy), p, cf = size, camera, self.scene.p, ctypes.c_float
        z, t, b = np.full((h, w), 1e9, F32), np.full((h, w), -1, np.int32), np.zeros((h, w, 2), F32)
        self.scene.lib.visib(w, h, cf(f), cf(cx), cf(cy), len(triangles), p(triangles), p(vertices), p(z), p(t), p(b))
        return z, t, b

    def shaded(self, camera, found, lamps, into, share, vertices, normals, direct, eyes):
        """Adds a share of the light of what seen() has found to a linear picture."""
        (z, t, b), (f, cx, cy), g, p, C, cf = found, camera, self.g, self.scene.p, self.scene.C, ctypes.c_float
        self.scene.lib.shade(into.shape[1], into.shape[0], cf(f), cf(cx), cf(cy), p(g["T"]), p(g["mat"]), p(vertices), p(normals), p(self.uv), p(self.E), p(direct),
                             p(self.vc), p(z), p(t), p(b), p(into), cf(share), self.size, self.size, p(self.albedo), p(self.bumps), cf(0), cf(1), cf(self.size),
                             cf(self.size), cf(self.slope), cf(.9), self.eye.shape[1], self.eye.shape[0], p(self.eye), p(eyes), p(self.parameters()), p(lamps),
                             len(lamps), p(C([0, 0, 0])), p(C(self.lash)))

    def window(self, w, h, f, cx, cy):
        """Linear picture and labels of a window of a camera of focal length f (px), its principal point at cx, cy of the window."""
        import rig
        scene, g = self.scene, self.g
        parameters, lamps = self.parameters(), self.lamps()
        picture, cover = np.zeros((h, w, 3), F32), np.zeros((h, w), F32)
        bare, lashes = np.zeros((h, w, 3), F32), np.zeros((h, w), F32)

        for dx, dy in ((.125, .375), (-.375, .125), (.375, -.125), (-.125, -.375)):
            camera = f, cx + dx, cy + dy
            z, t, b = self.seen((w, h), camera, g["T"], g["V"])
            cover += .25 * (t < 0)
            lashes += .25 * ((t >= 0) & (g["mat"][t] == 4))
            for boxes_seen, into in ((lamps, picture), (NO_LAMPS, bare)):
                self.shaded(camera, (z, t, b), boxes_seen, into, .25, g["V"], g["N"], self.D, self.eyes)
        ground = np.clip(1 + .3 * cv2.GaussianBlur(cv2.resize(self.rng.standard_normal((6, 7)).astype(F32), (w, h), interpolation=cv2.INTER_CUBIC), (0, 0), 3), .1, 3)
        picture += (cover * ground)[..., None] * self.ground.astype(F32)
        hard = scene.C(g["T"][g["mat"] != 4], np.int32)
        material = g["mat"][g["mat"] != 4]
        z, t, b = self.seen((w, h), (f, cx, cy), hard, g["V"])
        label, away = np.full((h, w), SKIN, np.uint8), np.full((h, w), np.inf, F32)
        yy, xx = np.nonzero((t >= 0))
        tri, bary = hard[t[yy, xx]], b[yy, xx]
        weight = np.c_[1 - bary.sum(1), bary]
        uv = (self.uv[tri] * weight[..., None]).sum(1)
        kind = material[t[yy, xx]]
        skin = kind == 0
        tx, ty = np.abs(uv[:, 0] * self.size).astype(int), np.abs((1 - uv[:, 1]) * self.size).astype(int)
        brow = self.brow[np.clip(ty, 0, self.size - 1), np.clip(tx, 0, self.size - 1)]
        dense = np.zeros((h, w), F32)
        dense[yy[skin], xx[skin]] = brow[skin]
        label[cv2.GaussianBlur(dense, (0, 0), 1.) > .3] = LASH
        for m in (2, 3):
            on = kind == m
            if not on.any():
                continue
            place = (g["V"][tri[on]] * weight[on][..., None]).sum(1)
            normal = (g["N"][tri[on]] * weight[on][..., None]).sum(1)
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            centre, turn = self.eyes[12 * (m - 2):12 * (m - 2) + 3], self.eyes[12 * (m - 2) + 3:12 * (m - 1)].reshape(3, 3)
            view = -place / np.linalg.norm(place, axis=1, keepdims=True)
            q, n, v = (place - centre) @ turn, normal @ turn, view @ turn
            theta = np.arccos(np.clip(q[:, 2] / np.linalg.norm(q, axis=1), -1, 1))
            eta, ci = 1 / 1.336, (n * v).sum(1)
            k2 = eta * ci - np.sqrt(np.maximum(1 - eta * eta * (1 - ci * ci), 0))
            ray = -eta * v + k2[:, None] * n
            reach = (parameters[1] - q[:, 2]) / np.minimum(ray[:, 2], -.05)
            inner = np.hypot(q[:, 0] + reach * ray[:, 0], q[:, 1] + reach * ray[:, 1]) / parameters[2] < self.pupil
            label[yy[on], xx[on]] = np.where(theta / rig.THL > LIMBUS, SCLERA, np.where(inner, PUPIL, IRIS))
            away[yy[on], xx[on]] = np.abs(theta / rig.THL - LIMBUS)
        ball = np.isin(label, (SCLERA, IRIS, PUPIL))
        mirrored = (picture - bare).max(-1)
        label[ball & (mirrored > .06) & (mirrored > .35 * bare.max(-1))] = REFLECTION
        if self.soft > 0 and ball.any():
            radius = f * float(rig.rho_eye(np.array([rig.THL]))[0]) * self.S.rig.es * np.sin(rig.THL) / self.eyes.reshape(2, 12)[:, 2].mean()
            picture += soften(bare, ball & (lashes < .05), away, self.soft * radius) - bare
        label[lashes >= .5] = LASH
        return picture, label

    def lesson(self):
        """A window as a camera's picture: encoded, 8 bits, and its labels."""
        import rig
        w, h = SIZE
        rng, S, g = self.rng, self.S, self.g
        side = "LR"[rng.integers(2)]
        eye = (S.rig.c[side] + np.array([0, 0, rig.ZL]) * S.rig.es @ g["R"][side].T) @ g["Rc"].T + g["t"]
        elsewhere = rng.random() < .12
        radius = np.exp(rng.uniform(np.log(5), np.log(55)))
        f = radius * eye[2] / (rig.RL * S.rig.es)
        if elsewhere:
            eye = g["V"][rng.integers(0, g["nskin"])].astype(float)
        reach = 1.2 if radius < 25 else .7
        px, py = w / 2 + rng.uniform(-.5, .5) * reach * (w * .6), h / 2 + rng.uniform(-.5, .5) * reach * (h * .6)
        picture, label = self.window(w, h, f, px - f * eye[0] / eye[2], py - f * eye[1] / eye[2])
        return photographed(picture, self.rng), label

    def ellipses(self, f, cx, cy, label):
        """Of both eyes in a window: limbus (x, y, semi-axes, angle), share of it that shows, angle to the camera."""
        import rig
        S, g = self.S, self.g
        theta = LIMBUS * rig.THL
        rho = float(rig.rho_eye(np.array([theta]))[0]) * S.rig.es
        a = np.linspace(0, 2 * np.pi, 64, endpoint=False)
        circle = rho * np.stack([np.sin(theta) * np.cos(a), np.sin(theta) * np.sin(a), np.full(64, np.cos(theta))], 1)
        out = []
        for s in "LR":
            turn = g["Rc"] @ g["R"][s]
            centre = S.rig.c[s] @ g["Rc"].T + g["t"]
            x = circle @ turn.T + centre
            e = conic(np.stack([f * x[:, 0] / x[:, 2] + cx, f * x[:, 1] / x[:, 2] + cy], 1))
            yy, xx = np.mgrid[:label.shape[0], :label.shape[1]]
            u = (xx + .5 - e[0]) * np.cos(e[4]) + (yy + .5 - e[1]) * np.sin(e[4])
            v = (yy + .5 - e[1]) * np.cos(e[4]) - (xx + .5 - e[0]) * np.sin(e[4])
            shows = np.isin(label[(u / e[2]) ** 2 + (v / e[3]) ** 2 < 1], (IRIS, PUPIL, REFLECTION)).sum() / (np.pi * e[2] * e[3])
            away = np.arccos(np.clip(-turn[:, 2] @ centre / np.linalg.norm(centre), -1, 1))
            out.append([*e, shows, away])
        return np.array(out, F32)

    def photograph(self):
        """A picture of 230 px and more, an iris of 24 px radius and more, with what kept.h reads."""
        import rig
        rng, S, g = self.rng, self.S, self.g
        w = int(230 * 2.4 ** rng.random())
        h = int(w * rng.uniform(.6, .85))
        side = "LR"[rng.integers(2)]
        eye = (S.rig.c[side] + np.array([0, 0, rig.ZL]) * S.rig.es @ g["R"][side].T) @ g["Rc"].T + g["t"]
        radius = np.exp(rng.uniform(np.log(24), np.log(.42 * h)))
        f = radius * eye[2] / (rig.RL * S.rig.es)
        cx = rng.uniform(1.05 * radius, w - 1.05 * radius) - f * eye[0] / eye[2]
        cy = rng.uniform(1.05 * radius, h - 1.05 * radius) - f * eye[1] / eye[2]
        picture, label = self.window(w, h, f, cx, cy)
        return photographed(picture, self.rng), label, self.ellipses(f, cx, cy, label)


def photographed(x, rng):
    """Linear light as a camera shows it: veil, exposure, white balance, blur, curve, grain, JPEG; RGB bytes."""
    h, w = x.shape[:2]
    if rng.random() < .3:  # the veil of stray light
        x = x + x.mean() * rng.uniform(0, .25)
    x = x + (x.mean(-1, keepdims=True) * np.array([1.04, 1, .94]) - x) * rng.uniform(0, .5)
    x = x * np.exp(rng.normal(0, .12) * np.array([1, 0, -1.3])) * np.exp(rng.normal(0, .03, 3))
    x = x * (rng.uniform(.18, .62) / max(np.percentile(x.mean(-1), 75), 1e-4))
    blur = rng.uniform(.35, .8) if rng.random() < .7 else rng.uniform(.8, 1.8)
    x = cv2.GaussianBlur(x.astype(F32), (0, 0), blur)
    x = np.where(x > .7, .7 + .3 * (1 - np.exp(-(x - .7) / .3)), x) if rng.random() < .6 else x
    x = encoded(x)
    if rng.random() < .5:  # a camera's curve
        x = x + rng.uniform(-.12, .16) * np.sin(2 * np.pi * np.clip(x, 0, 1)) / np.pi * -1
    grain = rng.standard_normal((h, w, 3))
    if rng.random() < .5:
        grain = .8 * cv2.GaussianBlur(grain, (0, 0), rng.uniform(.5, 1.1)) / .45
    x = x + np.exp(rng.uniform(np.log(.002), np.log(.03))) * grain * np.sqrt(np.clip(x, .05, 1))
    x = np.clip(x * 255 + .5, 0, 255).astype(np.uint8)
    if rng.random() < .6:
        x = cv2.imdecode(cv2.imencode(".jpg", x[..., ::-1], [1, int(rng.uniform(35, 96))])[1], 1)[..., ::-1]
    return np.ascontiguousarray(x)


def conic(p):
    """The ellipse through points that lie on one: centre, semi-axes, angle."""
    middle, scale = p.mean(0), p.std()
    x, y = ((p - middle) / scale).T
    a, b, c, d, e, k = np.linalg.svd(np.stack([x * x, x * y, y * y, x, y, np.ones_like(x)], 1))[2][-1]
    q = np.array([[a, b / 2], [b / 2, c]])
    at = np.linalg.solve(q, [-d / 2, -e / 2])
    value, axes = np.linalg.eigh(q / (at @ q @ at - k))
    return [*(at * scale + middle), scale / np.sqrt(value[0]), scale / np.sqrt(value[1]), np.arctan2(axes[1, 0], axes[0, 0])]


def kept(picture, label, eyes):
    """What kept.h reads."""
    return np.array([picture.shape[1], picture.shape[0], len(eyes)], np.int32).tobytes() + eyes.tobytes() + picture.tobytes() + label.tobytes()


def sheet(path, pictures, labels, across=8):
    """Pictures above their labels, to look at."""
    colours = np.array([(60, 60, 60), (0, 0, 0), (255, 255, 255), (60, 120, 255), (255, 220, 0), (255, 0, 255)], np.uint8)
    rows = [np.hstack([np.vstack([p, colours[l]]) for p, l in zip(pictures[k:k + across], labels[k:k + across])])
            for k in range(0, len(pictures) - across + 1, across)]
    cv2.imwrite(path, np.vstack(rows)[..., ::-1])


@contextlib.contextmanager
def workshop(args):
    """The generator in reach of imports, its rasteriser built; gives a folder for what it writes."""
    cv2.setNumThreads(1)
    sys.path.insert(0, args.faces)
    import mesh
    mesh.load = functools.cache(mesh.load)  # the same for all people
    with tempfile.TemporaryDirectory() as work:
        subprocess.run(["gcc", "-O3", "-march=native", "-ffast-math", "-shared", "-fPIC", args.faces + "/rast.c", "-o", work + "/rast.so", "-lm"], check=True)
        yield work


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--faces", required=True, help="folder of the generator of face clips")
    p.add_argument("--data", required=True, help="folder of meshes and eyeballs that it reads")
    p.add_argument("--out", required=True, help="lessons, added to what is there")
    p.add_argument("--first", type=int, default=30000)
    p.add_argument("--count", type=int, default=60, help="people")
    p.add_argument("--poses", type=int, default=POSES, help="of each")
    p.add_argument("--photographs", action="store_true", help="larger pictures, with ellipses")
    p.add_argument("--sheet", metavar="PNG", help="a contact sheet of the last ones")
    args = p.parse_args()
    with workshop(args) as work:
        for number in range(args.first, args.first + args.count):
            person, made = Person(number, args, work), []
            for _ in range(args.poses):
                person.pose()
                made += [person.photograph() for _ in range(WINDOWS // 3)] if args.photographs else [person.lesson() for _ in range(WINDOWS)]
            with open(args.out, "ab") as file:
                for picture, label, *eyes in made:
                    file.write(kept(picture, label, *eyes) if eyes else picture.tobytes() + label.tobytes())
            print("%d: %d lessons" % (number, len(made)), flush=True)
            if args.sheet and not args.photographs:
                sheet(args.sheet, [m[0] for m in made], [m[1] for m in made])


if __name__ == "__main__":
    main()
