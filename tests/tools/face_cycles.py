# A driven face's .glb in Cycles, under the light and camera of render's own NAME_look (lib/draw/face/view.c: a long lens, 0.9 m off, field distances of the eyes
# across): as Blender imports it, but for the eyes' materials, which are those that EXPORT/blender_eye.py builds.
# blender -b --python tests/tools/face_cycles.py -- FACE.glb EXPORT OUT.exr SAMPLES WIDTH HEIGHT FIELD   writes OUT.exr, linear RGBA
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_set

glb, export, out, samples, width, height, field = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
script = os.path.join(export, "blender_eye.py")
exec(compile(open(script).read(), script, "exec"), {"__file__": script})
for o in list(bpy.data.objects):
    bpy.data.objects.remove(o)
assembled = {m.name: m for m in bpy.data.materials}
for m in assembled.values():
    m.use_fake_user = True
bpy.ops.import_scene.gltf(filepath=glb)
for o in bpy.data.objects:
    part = o.name.split("_", 2)[-1]
    if o.name.startswith("eye_") and o.type == "MESH":
        o.material_slots[0].material = assembled[part]
        if part in ("cornea", "sclera", "iris"):  # as blender_eye.py has them
            o.visible_shadow = o.visible_diffuse = False
bpy.context.view_layer.update()
left, right = (bpy.data.objects["eye_" + side].matrix_world.translation for side in ("left", "right"))
middle, apart = (left + right) / 2, (left - right).length

scene = cycles_set.scene(int(width), int(height), int(samples))
for o in scene.objects:  # at rest: the picture looks straight ahead
    if o.animation_data:
        o.animation_data_clear()
    if o.type == "MESH" and o.data.shape_keys:
        if o.data.shape_keys.animation_data:
            o.data.shape_keys.animation_data_clear()
        for key in o.data.shape_keys.key_blocks[1:]:
            key.value = 0
cycles_set.camera(scene, (middle.x, middle.y - 0.9, middle.z), 2 * math.atan(float(field) * apart / 2 / 0.9))
cycles_set.light(scene, os.path.join(export, "studio.exr"))
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
