# An exported eye in Blender's Cycles, under the light and camera of render's own pictures.
# blender -b --python tests/tools/eye_cycles.py -- EXPORT OUT SAMPLES DEG...   writes OUT/cycles_DEG.exr, linear RGBA: the mean of cycles_DEG_1.exr and _2.exr, each of
# half the samples and a seed of its own, whose difference tells the noise
import json
import math
import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_set

export, out, samples, *degrees = sys.argv[sys.argv.index("--") + 1:]
view = json.load(open(os.path.join(export, "eye.json")))["reference"]
bpy.ops.wm.read_factory_settings(use_empty=True)
script = os.path.join(export, "blender_eye.py")
exec(compile(open(script).read(), script, "exec"), {"__file__": script})

scene = cycles_set.scene(view["px"], view["px"], max(int(samples) // 2, 1))
cycles_set.camera(scene, (0, -view["camera_z_mm"] / 1000, 0), math.radians(view["field_of_view_deg"]))
cycles_set.light(scene, os.path.join(export, "studio.exr"))


def pixels(path):
    image = bpy.data.images.load(path)
    px = numpy.empty(4 * view["px"] * view["px"], numpy.float32)
    image.pixels.foreach_get(px)
    return px


root = bpy.data.objects["eye"]
root.rotation_mode = "XYZ"
for deg in degrees:
    root.rotation_euler = (0, 0, math.radians(float(deg)))
    path = os.path.join(out, "cycles_%02d" % float(deg))
    for seed in (1, 2):
        scene.cycles.seed = seed
        scene.render.filepath = path + "_%d.exr" % seed
        bpy.ops.render.render(write_still=True)
    mean = bpy.data.images.new("mean", view["px"], view["px"], alpha=True, float_buffer=True)
    mean.colorspace_settings.name = "Non-Color"  # numbers as they are; before there are any
    mean.pixels.foreach_set((pixels(path + "_1.exr") + pixels(path + "_2.exr")) / 2)
    mean.filepath_raw, mean.file_format = path + ".exr", "OPEN_EXR"
    mean.save()
