# Assembles the exported eye in Blender 3.4 and later, for Cycles: imports eye.glb from this file's folder, and builds its materials from
# textures/. Run it from Blender's text editor, or: blender --python blender_eye.py
import os
import bpy
import numpy

numpy.bool = getattr(numpy, "bool", bool)  # Debian 12's Blender asks its newer numpy for it

folder = os.path.dirname(os.path.abspath(bpy.context.space_data.text.filepath if bpy.context.space_data and
                                         getattr(bpy.context.space_data, "text", None) else __file__))
index = {{#cornea}}{{index}}{{/cornea}}


def texture(nodes, name, colour):
    """An image node; the EXR where it was written, which is linear, else the PNG."""
    path = os.path.join(folder, "textures", name)
    image = bpy.data.images.load(path + ".exr" if os.path.exists(path + ".exr") else path + ".png", check_existing=True)
    linear = "Linear" if bpy.app.version < (4, 0) else "Linear Rec.709"
    image.colorspace_settings.name = "sRGB" if colour and image.filepath.endswith(".png") else "Non-Color" if not colour else linear
    node = nodes.new("ShaderNodeTexImage")
    node.image, node.extension = image, "EXTEND"
    return node.outputs["Color"]


def fresh(name):
    material = bpy.data.materials[name]
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    return nodes, links, nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]


def normal(nodes, links, name):
    # The EXR holds -1..1, Blender's node wants 0..1: the PNG is that.
    node, picture = nodes.new("ShaderNodeNormalMap"), nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.load(os.path.join(folder, "textures", name + ".png"), check_existing=True)
    picture.image.colorspace_settings.name, picture.extension = "Non-Color", "EXTEND"
    node.inputs["Strength"].default_value = {{#iris}}{{normal_scale}}{{/iris}}
    links.new(picture.outputs["Color"], node.inputs["Color"])
    return node.outputs["Normal"]


def matt(nodes, links, colour, bump):
    node = nodes.new("ShaderNodeBsdfDiffuse")
    links.new(texture(nodes, colour, True), node.inputs["Color"])
    links.new(normal(nodes, links, bump), node.inputs["Normal"])
    return node.outputs["BSDF"]


def wet(nodes, links, colour, rough):
    node = nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["IOR"].default_value = index
    # Until Blender 4 "Specular" alone tells how much is mirrored; from then on the index does, where "Specular IOR Level" stays a half.
    if "Specular" in node.inputs:
        node.inputs["Specular"].default_value = ((index - 1) / (index + 1)) ** 2 / 0.08
    links.new(texture(nodes, colour, True), node.inputs["Base Color"])
    links.new(texture(nodes, rough, False), node.inputs["Roughness"])
    return node.outputs["BSDF"]


def build():
    nodes, links, out = fresh("iris")
    links.new(matt(nodes, links, "iris_albedo", "iris_normal"), out)
    nodes, links, out = fresh("pupil_back")
    black = nodes.new("ShaderNodeBsdfDiffuse")
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    links.new(black.outputs["BSDF"], out)
    nodes, links, out = fresh("sclera")
    links.new(wet(nodes, links, "sclera_albedo", "sclera_roughness"), out)
    # The limbus: sclera where the cornea's map of clearness is black, glass of the fitted index where it is white.
    nodes, links, out = fresh("cornea")
    glass, mix = nodes.new("ShaderNodeBsdfGlass"), nodes.new("ShaderNodeMixShader")
    glass.inputs["IOR"].default_value = index
    glass.inputs["Roughness"].default_value = 0
    links.new(texture(nodes, "cornea_clear", False), mix.inputs["Fac"])
    links.new(wet(nodes, links, "cornea_colour", "cornea_roughness"), mix.inputs[1])
    links.new(glass.outputs["BSDF"], mix.inputs[2])
    links.new(mix.outputs["Shader"], out)
    # Light goes straight to the iris, whose albedo holds what the cornea takes of it and its own shadows; sight is refracted. Bent light
    # would be a caustic: true, and noise for thousands of samples. It also comes from aside, where the sclera would stand before it. Tears, where
    # there are lids, are as clear.
    for part in map(bpy.data.objects.get, ("cornea", "sclera", "iris", "tears")):
        if part:
            part.visible_shadow = part.visible_diffuse = False


bpy.ops.import_scene.gltf(filepath=os.path.join(folder, "eye.glb"))
build()
bpy.context.scene.render.engine = "CYCLES"
bpy.context.scene.cycles.blur_glossy = 0
