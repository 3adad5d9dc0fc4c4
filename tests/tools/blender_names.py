# An export's blender_eye.py against the names and rules of Blender's versions: python3 blender_names.py EXPORT. What it touches of bpy is stood in for, so that it can be
# asked for versions that are not installed; release notes of 4.0 have what was renamed: the space "Linear", the Principled shader's "Specular", which beside the index is now
# a factor whose middle is 0.5. Prints a line a version: how much a surface mirrors straight on, by that version's rule, and spaces given to images.
import os
import re
import runpy
import sys
import types


class Socket:
    def __init__(self):
        self.default_value = None


class Space:
    """Refuses a name that the version does not have, as Blender does."""

    def __init__(self, version):
        object.__setattr__(self, "known", {"sRGB", "Non-Color", "Linear" if version < (4, 0) else "Linear Rec.709"})

    def __setattr__(self, key, value):
        if value not in self.known:
            raise TypeError('enum "%s" not found in %s' % (value, sorted(self.known)))
        object.__setattr__(self, key, value)


class Any:
    """Takes whatever is set, and has whatever is asked for."""

    def __getattr__(self, key):
        if key.startswith("__"):
            raise AttributeError(key)
        value = Any()
        setattr(self, key, value)
        return value

    def __getitem__(self, key):
        return self.__dict__.setdefault("item_%s" % key, Any())

    def __call__(self, *args, **kwargs):
        return Any()

    def __bool__(self):
        return False


def principled(version):
    names = ["Base Color", "Roughness", "IOR", "Specular" if version < (4, 0) else "Specular IOR Level"]
    return {n: Socket() for n in names}


def run(path, version):
    images, shaders = [], []

    class Nodes(Any):
        def new(self, kind):
            node = Any()
            if kind == "ShaderNodeBsdfPrincipled":
                node.inputs = principled(version)
                shaders.append(node.inputs)
            return node

    class Images(Any):
        def load(self, file, check_existing=False):
            image = Any()
            image.filepath, image.colorspace_settings = file, Space(version)
            images.append(image)
            return image

    class Material(Any):
        def __init__(self):
            self.node_tree = Any()
            self.node_tree.nodes = Nodes()

    class Materials(dict):
        def __missing__(self, name):
            self[name] = Material()
            return self[name]

    bpy = Any()
    bpy.app.version, bpy.context.space_data = version, None
    bpy.data = Any()
    bpy.data.images, bpy.data.materials = Images(), Materials()
    sys.modules["bpy"], sys.modules["numpy"] = bpy, types.SimpleNamespace(bool=bool)
    runpy.run_path(path)
    mirrors = set()
    for inputs in shaders:
        index = inputs["IOR"].default_value
        if version < (4, 0):
            mirrors.add(0.08 * inputs["Specular"].default_value)
        else:
            level = inputs["Specular IOR Level"].default_value
            mirrors.add(((index - 1) / (index + 1)) ** 2 * 2 * (0.5 if level is None else level))
    spaces = sorted({re.sub(r".*\.", "", i.filepath) + " " + i.colorspace_settings.name for i in images})
    print("%d.%d: mirrors %s; %s" % (*version, " ".join("%.6f" % m for m in sorted(mirrors)), ", ".join(s.replace("Linear Rec.709", "Linear") for s in spaces)))


for version in ((3, 4), (3, 6), (4, 0), (4, 5), (5, 0)):
    run(os.path.join(sys.argv[1], "blender_eye.py"), version)
