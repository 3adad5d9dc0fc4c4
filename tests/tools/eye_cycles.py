# An exported eye in Blender's Cycles, under the light and camera of render's own pictures.
# blender -b --python tests/tools/eye_cycles.py -- EXPORT OUT SAMPLES DEG...   writes OUT/cycles_DEG.exr, linear RGBA
import json
import math
import os
import sys

import bpy

export, out, samples, *degrees = sys.argv[sys.argv.index("--") + 1:]
view = json.load(open(os.path.join(export, "eye.json")))["reference"]
bpy.ops.wm.read_factory_settings(use_empty=True)
script = os.path.join(export, "blender_eye.py")
exec(compile(open(script).read(), script, "exec"), {"__file__": script})

scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = int(samples)
scene.cycles.use_denoising = False
scene.cycles.seed = 1
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x = scene.render.resolution_y = view["px"]
scene.render.film_transparent = True
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_mode = "RGBA"

# glTF's y up became Blender's z up: the eye looks along -y.
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera
camera.location = (0, -view["camera_z_mm"] / 1000, 0)
camera.rotation_euler = (math.pi / 2, 0, 0)
camera.data.angle = math.radians(view["field_of_view_deg"])
camera.data.clip_start, camera.data.clip_end = 0.1, 2

# The middle of Blender's maps lies at +x, that of ours where the eye looks, at -y.
world = bpy.data.worlds.new("studio")
scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
picture = nodes.new("ShaderNodeTexEnvironment")
picture.image = bpy.data.images.load(os.path.join(export, "studio.exr"))
picture.image.colorspace_settings.name = "Linear" if bpy.app.version < (4, 0) else "Linear Rec.709"
where, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
turn.inputs["Rotation"].default_value[2] = math.pi / 2
links.new(where.outputs["Generated"], turn.inputs["Vector"])
links.new(turn.outputs["Vector"], picture.inputs["Vector"])
links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])

root = bpy.data.objects["eye"]
root.rotation_mode = "XYZ"
for deg in degrees:
    root.rotation_euler = (0, 0, math.radians(float(deg)))
    scene.render.filepath = os.path.join(out, "cycles_%02d.exr" % float(deg))
    bpy.ops.render.render(write_still=True)
