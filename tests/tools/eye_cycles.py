# An exported eye in Blender's Cycles, under the light and camera of render's own pictures.
# blender -b --python tests/tools/eye_cycles.py -- EXPORT OUT SAMPLES DEG...   writes OUT/cycles_DEG.exr, linear RGBA
import json
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_set

export, out, samples, *degrees = sys.argv[sys.argv.index("--") + 1:]
view = json.load(open(os.path.join(export, "eye.json")))["reference"]
bpy.ops.wm.read_factory_settings(use_empty=True)
script = os.path.join(export, "blender_eye.py")
exec(compile(open(script).read(), script, "exec"), {"__file__": script})

scene = cycles_set.scene(view["px"], view["px"], int(samples))
cycles_set.camera(scene, (0, -view["camera_z_mm"] / 1000, 0), math.radians(view["field_of_view_deg"]))
cycles_set.light(scene, os.path.join(export, "studio.exr"))

root = bpy.data.objects["eye"]
root.rotation_mode = "XYZ"
for deg in degrees:
    root.rotation_euler = (0, 0, math.radians(float(deg)))
    scene.render.filepath = os.path.join(out, "cycles_%02d.exr" % float(deg))
    bpy.ops.render.render(write_still=True)
