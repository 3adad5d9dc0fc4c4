# A driven face's .glb in Cycles, under the light and camera of render's own NAME_look (lib/draw/face/view.c: a long lens, 0.9 m off, field distances of the eyes
# across): as Blender imports it, but for the eyes' materials, which are those that EXPORT/blender_eye.py builds.
# blender -b --python tests/tools/face_cycles.py -- FACE.glb EXPORT OUT.exr SAMPLES WIDTH HEIGHT FIELD   writes OUT.exr, linear RGBA, and
# OUT_parts.exr, whose channel ViewLayer.IndexOB.X is 1 on the eyeballs' white, 2 on their irises, hairs, tears and corneae away; OUT_hair.exr: 3 on lashes
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
    if part in ("cornea", "sclera", "iris", "tears"):  # as blender_eye.py has them
        o.visible_shadow = o.visible_diffuse = False
bpy.context.view_layer.update()
left, right = (bpy.data.objects["eye_" + side].matrix_world.translation for side in ("left", "right"))
middle, apart = (left + right) / 2, (left - right).length

scene = cycles_set.scene(int(width), int(height), int(samples))
# As its animation begins, which is how the picture stands: what importing leaves is the pose of another frame.
scene.frame_set(int(min(a.frame_range[0] for a in bpy.data.actions)))
cycles_set.camera(scene, (middle.x, middle.y - 0.9, middle.z), 2 * math.atan(float(field) * apart / 2 / 0.9))
cycles_set.light(scene, os.path.join(export, "studio.exr"))
scene.render.filepath = out
bpy.ops.render.render(write_still=True)

for o in scene.objects:
    o.pass_index = 3 if o.name == "lashes" else 2 if o.name.endswith("_iris") else o.name.startswith("eye_")
    o.hide_render = o.name in ("lashes", "brows", "tears") or o.name.endswith("_cornea")
scene.view_layers[0].use_pass_object_index = True
scene.cycles.samples, scene.cycles.pixel_filter_type, scene.cycles.filter_width = 1, "BOX", 0.01
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.filepath = out[:-4] + "_parts.exr"
bpy.ops.render.render(write_still=True)
for o in scene.objects:
    o.hide_render = o.name in ("brows", "tears")
scene.render.filepath = out[:-4] + "_hair.exr"
bpy.ops.render.render(write_still=True)
