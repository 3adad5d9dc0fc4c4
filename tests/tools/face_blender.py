# A driven face's .glb in Blender's Cycles: what shows round each eye, as tests/browser/face_glb.js counts it in three.js.
# blender -b --python tests/tools/face_blender.py -- FACE.glb OUT [EXPRESSION...]   of open eyes and such that look about and are shut, or shut in each of those expressions and look down; prints a line a pose and side: how many pixels show the eye, skin, skin from behind, nothing at all
# between; OUT/blender_POSE_SIDE.png is what it counted (green, red, blue, black)
import math
import os
import sys

import bpy
import numpy
from mathutils import Quaternion, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_set

if not hasattr(numpy, "bool"):  # Blender 3.4 reads glTF with a name that newer numpy has dropped
    numpy.bool = bool
SIZE, FIELD = 256, 0.045  # m across, round one eye
POSES = {  # weights of both sides' targets, and how far the eyes turn to the person's left and up, degrees
    "open": ({}, (0, 0)),
    "shut": ({"eyeBlinkLeft": 1, "eyeBlinkRight": 1}, (0, 0)),
    "shut_down": ({"eyeLookDownLeft": 1, "eyeLookDownRight": 1, "eyeBlinkLeft": 1, "eyeBlinkRight": 1, "eyeBlinkLeft_down": 1, "eyeBlinkRight_down": 1}, (0, -20)),
    "down": ({"eyeLookDownLeft": 1, "eyeLookDownRight": 1}, (0, -20)),
    "up": ({"eyeLookUpLeft": 1, "eyeLookUpRight": 1}, (0, 20)),
    "left": ({"eyeLookOutLeft": 1, "eyeLookInRight": 1}, (25, 0)),
    "right": ({"eyeLookInLeft": 1, "eyeLookOutRight": 1}, (-25, 0)),
}


def flat(name, front, back):
    """A surface that shines in one colour, another from behind."""
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    nodes, links = m.node_tree.nodes, m.node_tree.links
    nodes.clear()
    out, mix, geometry = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeNewGeometry")
    links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    for k, rgb in enumerate((front, back)):
        shine = nodes.new("ShaderNodeEmission")
        shine.inputs[0].default_value = (*rgb, 1)
        links.new(shine.outputs[0], mix.inputs[1 + k])
    links.new(mix.outputs[0], out.inputs[0])
    return m


glb, out, *expressions = sys.argv[sys.argv.index("--") + 1:]
if expressions:
    shut = {name: POSES[name] for name in ("shut", "shut_down")}
    POSES = {"open": POSES["open"]}
    for e in expressions:
        for name, (weights, turn) in shut.items():
            POSES[f"{e}_{name}"] = ({**weights, e: 1, f"eyeBlinkLeft_{e}": 1, f"eyeBlinkRight_{e}": 1}, turn)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
meshes = [o for o in bpy.data.objects if o.type == "MESH"]
skin, eye = flat("skin", (1, 0, 0), (0, 0, 1)), flat("eye", (0, 1, 0), (0, 1, 0))
for o in meshes:
    if o.name in ("lashes", "brows", "tears"):
        o.hide_render = True
        continue
    for slot in o.material_slots:
        slot.material = eye if o.name.startswith("eye_") else skin
    if not o.material_slots:
        o.data.materials.append(skin)
for o in bpy.data.objects:  # poses are set here, not by the file's animation
    o.animation_data_clear()
for k in bpy.data.shape_keys:
    k.animation_data_clear()
eyes = {side: bpy.data.objects["eye_" + side] for side in ("left", "right")}
for o in eyes.values():
    o.rotation_mode = "QUATERNION"
    o.rotation_quaternion = Quaternion()
scene = cycles_set.scene(SIZE, SIZE, 1)
scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
scene.view_settings.view_transform = "Raw"
scene.render.image_settings.file_format = "PNG"
scene.render.film_transparent = False
scene.world = bpy.data.worlds.new("nothing")
scene.world.color = (0, 0, 0)
for name, (weights, (aside, above)) in POSES.items():
    for k in bpy.data.shape_keys:
        for block in k.key_blocks[1:]:
            block.value = weights.get(block.name, 0)
    for o in eyes.values():  # Blender's importer turns y up into z up: the eyes' nodes keep glTF's axes turned with it
        o.rotation_quaternion = Quaternion((0, 0, 1), math.radians(aside)) @ Quaternion((1, 0, 0), math.radians(-above))
    bpy.context.view_layer.update()
    for side, o in eyes.items():
        at = o.matrix_world.translation
        cycles_set.camera(scene, (at.x, at.y - 0.5, at.z), 2 * math.atan(FIELD / 2 / 0.5))
        scene.render.filepath = os.path.join(out, f"blender_{name}_{side}.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        px = numpy.array(picture.pixels[:]).reshape(SIZE, SIZE, 4)[:, :, :3] > 0.5
        bpy.data.images.remove(picture)
        red, green, blue = (px[:, :, c] for c in range(3))
        # Within the head: between the first and the last of a row that show any of it.
        anything = red | green | blue
        inside = numpy.maximum.accumulate(anything, 1) & numpy.maximum.accumulate(anything[:, ::-1], 1)[:, ::-1]
        print(f"blender {name} {side} eye {green.sum()} skin {red.sum()} behind {blue.sum()} nothing {(inside & ~anything).sum()}")
