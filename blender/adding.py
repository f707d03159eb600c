# SPDX-License-Identifier: GPL-3.0-or-later
"""Add > Light > Mid-air: a set-up from scratch or from a scene file, and elements for it."""

import os

import bpy

from . import blocks, building, files, frames, meshes, properties, solver, sync
from .solver import Trouble, told

# A set-up to begin from: an image 150 mm before a plate at 45 degrees over a display that lies.
TEXT = """\
# A mid-air display, begun in Blender. Millimetres and degrees; +y up, +z towards the viewer.
name = "Mid-air display"

[viewpoint]
position = [0.0, 0.0, 800.0]

[image]
size = [28.0, 28.0]

[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]

[display]                               # it stands where it belongs
resolution = [1024, 1024]
size = [36.5, 36.5]
"""

ELEMENTS = {
    "BALL": {"name": "ball", "shape": {"kind": "sphere", "radius": 25.0}, "material": {"ior": 1.49}},
    "CUBE": {"name": "cube", "shape": {"kind": "box", "size": [50.0, 50.0, 50.0]}, "material": {"ior": 1.49}},
    "CYLINDER": {
        "name": "cylinder",
        "shape": {"kind": "cylinder", "radius": 25.0, "height": 60.0},
        "material": {"ior": 1.49},
    },
    "CONE": {
        "name": "cone",
        "shape": {"kind": "cone", "radius": 25.0, "top_radius": 15.0, "height": 50.0},
        "material": {"ior": 1.49},
    },
    "MIRROR": {
        "name": "mirror",
        "shape": {"kind": "plane", "size": [200.0, 200.0]},
        "position": [0.0, -30.0, 0.0],
        "rotation": [-90.0, 0.0, 0.0],
        "material": {"mirror": True, "reflectance": 0.95},
    },
    "BENT_MIRROR": {
        "name": "bent mirror",
        "shape": {"kind": "cylinder-mirror", "radius": 250.0, "size": [200.0, 300.0], "facing": "convex"},
        "position": [0.0, -30.0, 0.0],
        "rotation": [-90.0, 0.0, 0.0],
        "material": {"mirror": True},
    },
}

KINDS = [(key, block["name"].capitalize(), f"A {block['name']}") for key, block in ELEMENTS.items()]


def add_element(context, root, block):
    """A new element of a set-up, by its block of the scene file."""
    sync.bring_up_to_date(context, root)
    own = root.midair
    text = blocks.appended(own.text.as_string(), block)
    found = solver.load(text, own.folder)
    meshes.check(block, own.folder)
    own.text.from_string(text)
    thing = building.add_element(context, root, len(properties.elements(root)), block)
    building.place_all(root, found)
    context.view_layer.update()
    building.remember(root)
    return thing


class MIDAIR_OT_add(bpy.types.Operator):
    """Add a mid-air display: viewpoint, image, plate, display and an object around the image"""

    bl_idname = "midair.add"
    bl_label = "Mid-air Display"
    bl_options = {"REGISTER", "UNDO"}

    element: bpy.props.EnumProperty(
        name="Object",
        items=[("NONE", "None", "The image floats in air"), *[kind for kind in KINDS if "MIRROR" not in kind[0]]],
        default="BALL",
    )

    def execute(self, context):
        with told(self) as outcome:
            folder = bpy.path.abspath("//") if bpy.data.filepath else bpy.app.tempdir
            text = TEXT
            if self.element != "NONE":
                text = blocks.appended(text, ELEMENTS[self.element])
            root = building.build(context, text, os.path.abspath(folder), "mid-air.toml")
            root.location = context.scene.cursor.location
            context.view_layer.objects.active = root
        return outcome()


class MIDAIR_OT_add_element(bpy.types.Operator):
    """Add an object that refracts or reflects to the mid-air set-up"""

    bl_idname = "midair.add_element"
    bl_label = "Element"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Kind", items=KINDS)

    def execute(self, context):
        with told(self) as outcome:
            root = properties.root_of(context)
            if root is None:
                raise Trouble(
                    "there is no mid-air set-up yet, or more than one: add one, or select the one that is meant"
                )
            context.view_layer.objects.active = add_element(context, root, ELEMENTS[self.kind])
        return outcome()


class MIDAIR_OT_add_mesh(bpy.types.Operator):
    """Add an element from a mesh file: OBJ, STL, PLY or glTF"""

    bl_idname = "midair.add_mesh"
    bl_label = "Element from a Mesh File"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH")
    unit: bpy.props.EnumProperty(name="Unit", items=[(unit, unit, "") for unit in meshes.UNITS], default="mm")
    ior: bpy.props.FloatProperty(name="IOR", default=1.49, min=1.0, max=5.0)

    def invoke(self, context, _):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        with told(self) as outcome:
            root = properties.root_of(context)
            if root is None:
                raise Trouble(
                    "there is no mid-air set-up yet, or more than one: add one, or select the one that is meant"
                )
            path = os.path.abspath(self.filepath)
            block = {
                "name": os.path.splitext(os.path.basename(path))[0],
                "shape": {"kind": "mesh", "file": path, "unit": self.unit},
                "material": {"ior": frames.rounded(self.ior)},
            }
            context.view_layer.objects.active = add_element(context, root, block)
        return outcome()


class MIDAIR_MT_add(bpy.types.Menu):
    bl_idname = "MIDAIR_MT_add"
    bl_label = "Mid-air"

    def draw(self, _):
        layout = self.layout
        layout.operator_menu_enum("midair.add", "element", text="From Scratch")
        layout.operator(files.MIDAIR_OT_import.bl_idname, text="From a Scene File...")
        layout.separator()
        layout.operator_menu_enum("midair.add_element", "kind", text="Element")
        layout.operator("midair.add_mesh", text="Element from a Mesh File...")
        layout.operator("midair.element_from_mesh")


def _in_light(menu, _):
    menu.layout.separator()
    menu.layout.menu("MIDAIR_MT_add", icon="LIGHT_AREA")


CLASSES = (MIDAIR_OT_add, MIDAIR_OT_add_element, MIDAIR_OT_add_mesh, MIDAIR_MT_add)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def register():
    _register_classes()
    bpy.types.VIEW3D_MT_light_add.append(_in_light)


def unregister():
    bpy.types.VIEW3D_MT_light_add.remove(_in_light)
    _unregister_classes()
