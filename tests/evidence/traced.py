"""Photographs of path-traced eyes, a third renderer's, with labels and ellipses, as heads.py --photographs writes them.

    blender -b -P tests/evidence/traced.py -- --eyes FOLDER --out PHOTOGRAPHS --first 50000 --count 60 [--sheet PNG] [--mirrors]

FOLDER: the generator of path-traced eyes (a refracting cornea, lids, lashes, tears, lamps and rooms), not part of this repository. Each number is
an eye: iris, pose, lids, skin, light, a limbus as sharp or as soft as people's; of each some photographs, as near and as far as heads' are. The limbus is the
middle of its ramp. Numbers below 59000 are for training, 59000 to 59499 for development, those above judge; irises are shared within each of them
alone, since their textures take longest. --mirrors: every eye is lit, nearly faces the camera and mirrors what lights it; it is rendered without its cornea's mirror image as well, and what that
adds more than a third of the iris' own light to is labelled a reflection; what is mirrored is a third to three times as bright in each photograph. Needs blender, python3-numpy, -scipy, -opencv.
"""
import argparse
import functools
import os
import sys
import tempfile

import cv2
import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import heads

DEVELOPMENT, JUDGE = 59000, 59500
IRISES, OTHERS, SCLERAS, SHOTS = 16, 6, 6, 4  # irises for training; for development and for judging each
SIZE, WHOLE = (576, 432), 144  # px; both sides are whole at every scale of so many
CLASS = np.array([heads.SKIN, heads.SKIN, heads.LASH, heads.SCLERA, heads.IRIS, heads.PUPIL, heads.IRIS, heads.SCLERA], np.uint8)
SKIN_TONES = ("fair", "light", "tan", "brown", "deep")
PRESETS = ("blue", "brown", "hazel", "green", "grey", "dark")
F32 = np.float32


def arguments(number, out, mirrors):
    """What an eye is drawn with."""
    rng = np.random.default_rng([91, number])
    u, pick = rng.uniform, lambda *names: str(rng.choice(names))
    iris = int(rng.integers(IRISES if number < DEVELOPMENT else OTHERS))
    iris += IRISES * (number >= DEVELOPMENT) + OTHERS * (number >= JUDGE)
    of_iris = np.random.default_rng([92, iris])
    a = dict(out=out, seed=number, eye_seed=50000 + iris, preset=PRESETS[iris % len(PRESETS)], pupil_r=of_iris.uniform(1, 3.6), pupil_dx=of_iris.uniform(-.15, .15),
             pupil_dy=of_iris.uniform(-.12, .12), freckles=int(of_iris.choice([0, 2, 4, 6])), iris_r=5.9, mode="lit" if rng.random() < .8 else "geo",
             theta=50 * rng.beta(1, 1.6), phi=u(0, 360), dist=float(np.exp(u(np.log(60), np.log(600)))), field=u(18, 40), gaze_share=u(0, .9),
             lids=pick("none", "normal", "normal", "normal", "low", "low", "wide", "squint"), skin=pick(*SKIN_TONES), side=pick("OD", "OS"),
             R=u(7.2, 8.4), p=u(.5, 1), cone=u(0, .3), relief=u(0, 1), noise=0, psf=0, limbus_w=float(np.exp(u(np.log(.04), np.log(.45)))), keep_linear=0,
             width=SIZE[0], height=SIZE[1], spp=12, threads=1)
    if a["mode"] == "lit":
        a.update(specular=int(rng.random() < .8), light=pick("softboxes", "ring", "side", "side", "room"))
    if mirrors:
        a.update(mode="lit", specular=1, light=pick("softboxes", "side", "room", "room", "room"), theta=25 * rng.random(), field=u(16, 22), width=320, height=240, spp=14)
    return [x for key, v in a.items() for x in ("--" + key.replace("_", "-"), str(v))]


def mirrored(light, plain, label):
    """Where reflections add more than a third of the iris' own light, over what is mirrored on half of the eye; white is the brightest of the plain picture."""
    added, own = (v @ np.array([.2126, .7152, .0722], F32) for v in (light - plain, plain))
    eye = (label == heads.IRIS) | (label == heads.PUPIL)
    if not (label == heads.IRIS).any():
        return np.zeros(label.shape, bool)
    iris = np.median(own[label == heads.IRIS])
    over = cv2.GaussianBlur(added, (0, 0), 1) - np.median(added[eye])
    return eye & (over > .01 * np.percentile(own, 99)) & (over > .3 * np.maximum(own, .5 * iris))


class Eye:
    """Linear picture, labels, ellipse of the limbus and which of its places show, tilt."""

    def __init__(self, number, work, mirrors=False):
        import eye_capture as capture
        import eye_model
        import eye_scene
        import exr_io
        import textures
        o = capture.parser().parse_args(arguments(number, work, mirrors))
        P = capture.draw(o)
        rng = np.random.default_rng([o.seed, 3])
        tex = capture.build_iris(o, P)
        scl, scl_meta = textures.sclera(o.eye_seed)
        hf = eye_model.HeightField(tex["height"], tex["extent"]) if P.relief else None
        eye_scene.reset(o.threads)
        M, gaze, cam_h, cam_e = capture.setup_pose(o, P)
        eye = eye_scene.Eye(P, hf)
        eye.set_images(tex["albedo"], tex["extent"], scl, scl_meta)
        eye.pose(M)
        lids = None
        if o.lids != "none":
            up, low = capture.lid_angles(o, P, rng)
            lids = eye_scene.Lids(P, o.side, o.eye_seed, capture.TONES[o.skin])
            lids.build(up + .75 * gaze["pitch_deg"], low + .35 * gaze["pitch_deg"], M)
        eye_scene.set_camera(cam_h)
        lit, spec = o.mode == "lit", bool(o.specular)
        if lit:
            capture.setup_lights(eye_scene, o, P, M, cam_h, rng)
        else:
            eye_scene.world("plain", strength=0.0)
        eye.materials(o.mode, spec, o.transport)
        if lids:
            lids.materials(o.mode, spec)
        file = work + "/pass.exr"

        def seen(samples, **more):
            eye_scene.render_exr(file, samples, depth="32", **more)
            return exr_io.read(file)
        e = seen(o.spp, seed=o.seed, clamp=8.0 if lit else 0.0)
        self.light = np.stack([e["R"], e["G"], e["B"]], -1).astype(F32)
        if mirrors:
            eye.materials(o.mode, spec, o.transport, 0.0)
            e = seen(o.spp, seed=o.seed, clamp=8.0)
            plain = np.stack([e["R"], e["G"], e["B"]], -1).astype(F32)
        eye.materials("label")
        if lids:
            lids.materials("label", False)
        eye_scene.world("plain", strength=0.0)
        for thing in eye_scene.bpy.data.objects:
            if thing.type == "LIGHT":
                thing.hide_render = True
        labels = np.round(seen(1, exact_centre=True)["B"]).astype(np.uint8)
        truth, _, front, uv = capture.analytic_truth(P, cam_e)
        status = capture.limbus_occlusion(labels, uv, front, eye_scene.L_SCLERA, (eye_scene.L_SKIN, eye_scene.L_LASH, eye_scene.L_CARUNCLE))
        self.label, self.limbus, self.theta = CLASS[np.minimum(labels, 7)], truth["limbus_ellipse_exact"], np.radians(o.theta)
        self.line, self.shown = uv, status == 0
        self.plain = plain if mirrors else None
        self.rng = np.random.default_rng([93, number])

    def photograph(self):
        """Some part of it, smaller or not, as a camera shows it: picture, labels, what kept.h reads."""
        rng, e = self.rng, self.limbus
        of_light, of_label = self.light, self.label
        if self.plain is not None:  # what surrounds it shines more or less
            of_light = self.plain + np.exp(rng.uniform(np.log(.3), np.log(3))) * (self.light - self.plain)
            of_label = np.where(mirrored(of_light, self.plain, self.label), np.uint8(heads.REFLECTION), self.label)
        scale = min(1, max(np.exp(rng.uniform(np.log(.3), np.log(1.1))), 26 / e["a"]))
        scale = np.ceil(scale * WHOLE) / WHOLE
        side = np.round(scale * np.array(of_light.shape[1::-1])).astype(int)
        light = cv2.resize(of_light, side, interpolation=cv2.INTER_AREA) if scale < 1 else of_light
        label = cv2.resize(of_label, side, interpolation=cv2.INTER_NEAREST)
        least = np.minimum(side, max(2.2 * e["a"] * scale, 100))
        size = (least + rng.random(2) * (side - least)).astype(int)
        at = (rng.random(2) * (side - size)).astype(int)
        cut = (slice(at[1], at[1] + size[1]), slice(at[0], at[0] + size[0]))
        p = self.line * scale - at
        shown = self.shown & (p >= 0).all(1) & (p < size).all(1)
        limbus = [e["cx"] * scale - at[0], e["cy"] * scale - at[1], e["a"] * scale, e["b"] * scale, np.radians(e["angle_deg"]), shown.mean(), self.theta]
        return heads.photographed(light[cut], rng), np.ascontiguousarray(label[cut]), np.array([limbus], F32)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--eyes", required=True, help="folder of the generator of path-traced eyes")
    p.add_argument("--out", required=True, help="photographs, added to what is there")
    p.add_argument("--first", type=int, default=50000)
    p.add_argument("--count", type=int, default=60)
    p.add_argument("--mirrors", action="store_true", help="lit eyes, their reflections labelled")
    p.add_argument("--sheet", metavar="PNG", help="a contact sheet of them")
    args = p.parse_args(sys.argv[sys.argv.index("--") + 1:])
    cv2.setNumThreads(1)
    sys.path.insert(0, args.eyes)
    import textures
    sclera = functools.cache(textures.sclera)  # one takes as long as the rest of an eye
    textures.sclera = lambda seed: sclera(seed % SCLERAS)
    tiles = []
    with tempfile.TemporaryDirectory() as work:
        for number in range(args.first, args.first + args.count):
            eye = Eye(number, work, args.mirrors)
            with open(args.out, "ab") as file:
                for _ in range(SHOTS):
                    picture, label, limbus = eye.photograph()
                    file.write(heads.kept(picture, label, limbus))
                    tiles.append((cv2.resize(picture, heads.SIZE), cv2.resize(label, heads.SIZE, interpolation=cv2.INTER_NEAREST)))
            print("eye %d" % number, flush=True)
    if args.sheet:
        heads.sheet(args.sheet, *zip(*tiles[-64:]))


main()
