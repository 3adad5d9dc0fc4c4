# What eyes and faces in Blender's Cycles share: an empty scene, the renderer's settings, the light of an exported studio.exr.
import math

import bpy


def scene(width, height, samples):
    s = bpy.context.scene
    s.render.engine = "CYCLES"
    s.cycles.device = "CPU"
    s.cycles.samples = samples
    s.cycles.use_denoising = False
    s.cycles.seed = 1
    s.view_settings.view_transform = "Standard"
    s.render.resolution_x, s.render.resolution_y = width, height
    s.render.film_transparent = True
    s.render.image_settings.file_format = "OPEN_EXR"
    s.render.image_settings.color_mode = "RGBA"
    return s


def camera(s, location, angle):
    """Before an eye or a face, which looks along -y: glTF's y up became Blender's z up. angle: across the picture's width, radians."""
    c = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    s.collection.objects.link(c)
    s.camera = c
    c.location = location
    c.rotation_euler = (math.pi / 2, 0, 0)
    c.data.sensor_fit, c.data.angle = "HORIZONTAL", angle
    c.data.clip_start, c.data.clip_end = 0.1, 2


def light(s, path):
    """The middle of Blender's maps lies at +x, that of ours where the eye looks, at -y."""
    s.world = world = bpy.data.worlds.new("studio")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(path)
    picture.image.colorspace_settings.name = "Linear" if bpy.app.version < (4, 0) else "Linear Rec.709"
    where, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value[2] = math.pi / 2
    links.new(where.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])
