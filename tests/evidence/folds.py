"""folds.py CLIP OUT: wrinkles drawn into a rendered clip of the shared video data (video.mp4, truth.npz, truth.json, subject.ply), which has none of its own.

Skin folds where an expression pushes it together. Each fold is a groove with banks in the skin's surface, uneven in depth and course, that deepens with the expression's
weight and is carried by the skin. The clip is lit again by it: light of every direction, as the neutral frame's shading tells it (spherical harmonics of order 2), is summed over
what each spot of the folded skin can see of it, skin that faces it gives its own light back, and light that has been below the skin is softened, red most.
Of the groove's shape, its shading and its softness nothing is as lib/track/wrinkle has it. Writes OUT/face.mp4 (frames from the last key frame before the first fold are encoded anew,
the others are the clip's own bytes) and OUT/folds.json: the grooves' courses in the first frame, px, and on the mesh, their depth and half width, mm, in every frame.
"""
import json
import subprocess
import sys

import cv2
import numpy as np
from scipy.ndimage import map_coordinates
from scipy.interpolate import LinearNDInterpolator, make_interp_spline
from scipy.spatial import cKDTree

CLIP, OUT = sys.argv[1:3]
TRUTH = json.load(open(f"{CLIP}/truth.json"))
NPZ = np.load(f"{CLIP}/truth.npz")
FIRST = int(sys.argv[3]) if len(sys.argv) > 3 else 250
K = np.array(TRUTH["K"])
ALBEDO = np.array([0.30, 0.42, 0.62])        # blue, green, red of skin, linear: what a wall gives back to the other
SOFT_MM = np.array([0.12, 0.18, 0.35])       # how far light spreads below the skin
AROUND = 32
RNG = np.random.default_rng(12)

# Courses in the first frame, px; mm. An adult's first lines: forehead across both brows, crow's feet, below the lower lids. Hatzis (2004): 0.1 mm and more.
FOLDS = [
    ("brows_up", [(110, 138), (225, 122), (335, 122), (455, 140), (560, 156), (640, 161), (715, 157), (820, 140), (940, 121), (1060, 121), (1165, 136)], 0.36, 0.42),
    ("brows_up", [(215, 77), (330, 70), (480, 86), (640, 105), (790, 88), (945, 69), (1075, 78)], 0.27, 0.40),
    ("squint", [(66, 362), (42, 352), (12, 336)], 0.26, 0.34),
    ("squint", [(68, 396), (40, 402), (8, 412)], 0.28, 0.34),
    ("squint", [(80, 430), (52, 446), (16, 472)], 0.20, 0.34),
    ("squint", [(1212, 366), (1240, 354), (1270, 336)], 0.26, 0.34),
    ("squint", [(1208, 400), (1240, 405), (1272, 416)], 0.28, 0.34),
    ("squint", [(1196, 434), (1222, 452), (1262, 474)], 0.20, 0.34),
    ("squint", [(168, 500), (225, 525), (300, 533), (370, 519), (425, 488)], 0.22, 0.40),
    ("squint", [(230, 566), (300, 573), (362, 558)], 0.15, 0.42),
    ("squint", [(850, 489), (905, 518), (975, 533), (1050, 528), (1105, 505)], 0.22, 0.40),
    ("squint", [(915, 559), (975, 573), (1045, 569)], 0.15, 0.42),
]
DRIVEN = {"brows_up": ("browInnerUp_L", "browInnerUp_R", "browOuterUp_L", "browOuterUp_R"), "squint": ("eyeSquint_L", "eyeSquint_R")}


def linear(x):
    x = np.asarray(x, np.float64) / 255
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def encoded(x):
    x = np.clip(x, 0, 1)
    return 255 * np.where(x <= 0.0031308, x * 12.92, 1.055 * x ** (1 / 2.4) - 0.055)


def frames_of(path):
    film = cv2.VideoCapture(path)
    while True:
        ok, image = film.read()
        if not ok:
            return
        yield image


def planes_of(path, width, height):
    """The film's frames as it holds them, YUV 4:2:0: what is not lit anew stays as it was."""
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"], capture_output=True, check=True).stdout
    return [np.frombuffer(one, np.uint8) for one in np.split(np.frombuffer(raw, np.uint8), len(raw) // (width * height * 3 // 2))]


def lit(planes, by):
    """Planes with a change of encoded blue, green, red added; as OpenCV decoded them, ITU-R BT.601."""
    height, width = by.shape[:2]
    b, g, r = by[..., 0] / 255, by[..., 1] / 255, by[..., 2] / 255
    y = 65.481 * r + 128.553 * g + 24.966 * b
    u, v = [cv2.resize(c, (width // 2, height // 2), interpolation=cv2.INTER_AREA) for c in (-37.797 * r - 74.203 * g + 112 * b, 112 * r - 93.786 * g - 18.214 * b)]
    change = np.concatenate([y.ravel(), u.ravel(), v.ravel()])
    return np.clip(np.round(planes + change), 0, 255).astype(np.uint8)


def splice(planes, width, height):
    """The clip's own stream up to its key frame FIRST, then what is encoded anew as that was."""
    def run(*what, given=None):
        subprocess.run(["ffmpeg", "-v", "error", "-y", *what], input=given, check=True)
    run("-i", f"{CLIP}/video.mp4", "-c", "copy", "-frames:v", str(FIRST), f"{OUT}/head.mp4")
    run("-f", "rawvideo", "-pix_fmt", "yuv420p", "-s", f"{width}x{height}", "-r", str(TRUTH["fps"]), "-color_range", "tv", "-i", "-", "-c:v", "libx264", "-preset", "fast", "-threads", "2", "-crf",
        str(TRUTH["crf"]), "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-video_track_timescale", "15360", f"{OUT}/tail.mp4",
        given=b"".join(p.tobytes() for p in planes[FIRST:]))
    open(f"{OUT}/parts", "w").write(f"file head.mp4\nduration {FIRST / TRUTH['fps']:.9f}\nfile tail.mp4\n")
    run("-f", "concat", "-i", f"{OUT}/parts", "-c", "copy", "-movflags", "+faststart", "-video_track_timescale", "15360", f"{OUT}/face.mp4")


def save(record, share):
    """A line a fold."""
    with open(f"{OUT}/folds.json", "w") as out:
        out.write('{"folds": [\n' + ",\n".join(json.dumps(f) for f in record) + '],\n"share": {\n' + ",\n".join(f'"{name}": {json.dumps(s)}' for name, s in share.items()) + "}}\n")


def mesh_of(path):
    lines = open(path).read().split("\n")
    n = [int(line.split()[2]) for line in lines if line.startswith("element")]
    at = lines.index("end_header") + 1
    v = np.array([line.split()[:3] for line in lines[at:at + n[0]]], float)
    return v, np.array([line.split()[1:4] for line in lines[at + n[0]:at + n[0] + n[1]]], int)


def weight(name, frame):
    names = TRUTH["au_names"]
    return float(np.mean([NPZ["au_weights"][frame][names.index(n)] for n in DRIVEN[name]]))


def folded(name, frame):
    """Share of its depth that a fold has: skin gives way before it buckles."""
    x = np.clip((weight(name, frame) / max(weight(name, f) for f in range(len(NPZ["frame"]))) - 0.15) / 0.85, 0, 1)
    return x * x * (3 - 2 * x)


def profile(s):
    """A groove that is sharp at its bottom, skin that is pushed up beside it; s: half widths from its middle."""
    return -1 / (1 + (s / 0.9) ** 2) ** 2 + 0.22 * np.exp(-((s - 2.6) / 1.1) ** 2)


def noise(n, length):
    """Smooth, of standard deviation 1, over n samples; length: of its bumps, samples."""
    x = cv2.GaussianBlur(RNG.normal(size=(1, n + 8 * length)), (0, 0), length)[0, 4 * length:4 * length + n]
    return x / x.std()


def spherical(n):
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    return np.stack([np.ones_like(x), x, y, z, x * y, x * z, y * z, x * x - y * y, 3 * z * z - 1], -1)


def main():
    v, faces = mesh_of(f"{CLIP}/subject.ply")
    r, t = NPZ["head_R"][0], NPZ["head_t"][0]
    cam = v @ r.T + t
    px = cam @ K.T
    px = px[:, :2] / px[:, 2:]
    normal = np.zeros_like(cam)
    for k in range(3):
        np.add.at(normal, faces[:, k], np.cross(cam[faces[:, 1]] - cam[faces[:, 0]], cam[faces[:, 2]] - cam[faces[:, 0]]))
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    normal *= -np.sign(np.nanmedian(normal[:, 2]))
    height, width = TRUTH["height"], TRUTH["width"]
    neutral = linear(next(frames_of(f"{CLIP}/video.mp4")))
    seen = (px[:, 0] > 2) & (px[:, 0] < width - 2) & (px[:, 1] > 2) & (px[:, 1] < height - 2) & (normal[:, 2] < -0.3)
    grid = np.stack(np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5), -1)
    mm_px = 10 * np.median(cam[seen, 2]) / K[0, 0]

    # Light on a normal, from skin that is not lashes, brows or gloss: least squares of green light, thrice without what is far off.
    green = cv2.GaussianBlur(neutral[..., 1], (0, 0), 6)
    a, b = spherical(normal[seen]), green[px[seen, 1].astype(int), px[seen, 0].astype(int)]
    keep = np.ones(len(b), bool)
    for _ in range(4):
        light = np.linalg.lstsq(np.vstack([a[keep], 0.3 * np.eye(9)]), np.concatenate([b[keep], 0.3 * np.eye(9)[0] * np.median(b)]), rcond=None)[0]
        off = b - a @ light
        keep = np.abs(off) < 2 * np.median(np.abs(off)) + 1e-4
    # What falls in from a direction, of what falls on a normal (Ramamoorthi and Hanrahan 2001).
    radiance = light / np.array([np.pi] + 3 * [2 * np.pi / 3] + 5 * [np.pi / 4])
    n = 400
    k = np.arange(n) + 0.5
    z, turn = 1 - 2 * k / n, np.pi * (1 + 5 ** 0.5) * k
    sky = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1)
    shine = np.maximum(spherical(sky) @ radiance, 0)

    # The folds: of each pixel near one its distance, how deep it is there, and the direction across.
    folds, total = [], np.zeros((height, width))
    for name, points, depth, w in FOLDS:
        s = np.linspace(0, len(points) - 1, 40 * len(points))
        course = make_interp_spline(np.arange(len(points)), np.array(points, float), k=min(3, len(points) - 1))(s)
        step = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(course, axis=0), axis=1))])
        at = np.arange(0, step[-1], 1.0)
        course = np.stack([np.interp(at, step, course[:, i]) for i in range(2)], -1)
        along = np.gradient(course, axis=0)
        along /= np.linalg.norm(along, axis=1)[:, None]
        across = np.stack([-along[:, 1], along[:, 0]], -1)
        course = course + across * (1.6 * noise(len(at), 25) + 0.6 * noise(len(at), 8))[:, None]
        ends = np.clip(np.minimum(at, at[-1] - at) / min(45, 0.35 * at[-1]), 0, 1)
        far, near = cKDTree(course).query(grid.reshape(-1, 2), distance_upper_bound=6 * w / mm_px)
        folds.append(dict(i=np.flatnonzero(np.isfinite(far)), s=far[np.isfinite(far)] * mm_px / w, near=near[np.isfinite(far)],name=name, course=course, across=across, w=w, depth=depth * np.sin(0.5 * np.pi * ends) * np.clip(1 + 0.22 * noise(len(at), 30), 0.4, 1.5)))

    surface = LinearNDInterpolator(px[seen], normal[seen])(grid)
    surface /= np.linalg.norm(surface, axis=2)[..., None]
    film = list(frames_of(f"{CLIP}/video.mp4"))
    skin0, ok = NPZ["skin_px"][0], NPZ["skin_visible"][0] > 0
    planes = planes_of(f"{CLIP}/video.mp4", width, height)
    for frame in range(FIRST, len(film)):
        share = {name: folded(name, frame) for name in DRIVEN}
        if max(share.values()) < 1e-3:
            continue
        h = np.zeros((height, width))
        for f in folds:
            if share[f["name"]] < 1e-3:
                continue
            i, s, d = f["i"], f["s"], share[f["name"]] * f["depth"][f["near"]]
            h.reshape(-1)[i] += d * profile(s)
        gy, gx = np.gradient(h, mm_px)
        where = (np.abs(h) > 1e-4) | (np.hypot(gx, gy) > 1e-3)
        where &= np.isfinite(surface[..., 0])
        y, x = np.nonzero(where)
        m = surface[y, x]
        # Axes of the skin along the picture's; the normal looks at the camera.
        e = np.array([1.0, 0, 0]) - m * m[:, :1]
        e /= np.linalg.norm(e, axis=1)[:, None]
        g = np.cross(m, e)
        g *= np.sign(g[:, 1:2])
        tilted = m - e * gx[y, x][:, None] - g * gy[y, x][:, None]
        tilted /= np.linalg.norm(tilted, axis=1)[:, None]
        before = np.maximum(m @ sky.T, 0) @ shine
        after, hidden = np.zeros(len(y)), np.zeros(len(y))
        # How steeply the folded skin rises on every side: what of the sky it hides.
        rise = np.full((AROUND, len(y)), -np.inf)
        for k in range(AROUND):
            way = np.cos(2 * np.pi * k / AROUND), np.sin(2 * np.pi * k / AROUND)
            for mm in (0.15, 0.3, 0.5, 0.8, 1.2, 1.7):
                there = map_coordinates(h, [y + way[1] * mm / mm_px, x + way[0] * mm / mm_px], order=1, mode="nearest")
                rise[k] = np.maximum(rise[k], (there - h[y, x]) / mm)
        for direction, bright in zip(sky, shine):
            up, right, down = m @ direction, e @ direction, g @ direction
            cosine = np.maximum(tilted @ direction, 0)
            side = np.round(np.arctan2(down, right) / (2 * np.pi) * AROUND).astype(int) % AROUND
            clear = np.clip(0.5 - (rise[side, np.arange(len(y))] - up / (np.hypot(right, down) + 1e-9)) / 0.2, 0, 1)
            after += cosine * bright * clear
            hidden += cosine * (1 - clear)
        ratio = np.ones((height, width, 3))
        open_sky = np.maximum(m @ sky.T, 0).sum(1)
        ratio[y, x] = (after / np.maximum(before, 1e-9))[:, None] + (hidden / open_sky)[:, None] * ALBEDO
        for c in range(3):
            ratio[..., c] = cv2.GaussianBlur(ratio[..., c], (0, 0), SOFT_MM[c] / mm_px)
        # Carried by the skin: where the skin of each pixel was in the first frame.
        now = NPZ["skin_px"][frame][ok]
        pins = np.concatenate([now, [[-400, -400], [width + 400, -400], [-400, height + 400], [width + 400, height + 400]]])
        back = np.concatenate([skin0[ok] - now, np.zeros((4, 2))])
        coarse = grid[::4, ::4]
        shift = cv2.resize(LinearNDInterpolator(pins, back)(coarse).astype(np.float32), (width, height), interpolation=cv2.INTER_LINEAR)
        shift = cv2.GaussianBlur(shift, (0, 0), 8)
        at = (grid - 0.5 + shift).astype(np.float32)
        ratio = cv2.remap(ratio.astype(np.float32), at[..., 0], at[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=(1, 1, 1))
        planes[frame] = lit(planes[frame], encoded(linear(film[frame]) * ratio) - film[frame])
        print(frame, share, ratio.min(), ratio.max(), flush=True)
    splice(planes, width, height)
    # Depths are from the banks' tops.
    high = np.ptp(profile(np.linspace(0, 8, 8000)))
    place, record = LinearNDInterpolator(px[seen], 10 * v[seen]), []
    for f in folds:
        pick = np.unique(np.linspace(0, len(f["course"]) - 1, max(4, len(f["course"]) // 12)).astype(int))
        record.append(dict(expression=f["name"], half_width_mm=f["w"], px=np.round(f["course"][pick], 2).tolist(), head_mm=np.round(place(f["course"][pick]), 2).tolist(),
                           depth_mm=np.round(high * f["depth"][pick], 4).tolist()))
    save(record, {name: [round(folded(name, f), 4) for f in range(len(film))] for name in DRIVEN})


main()
