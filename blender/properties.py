# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's objects know of the set-up that they belong to.

Values of the scene file that Blender has a place for are where it has it: position, rotation, size. Other values are custom
properties of the object, named as in the scene file: `material.ior`, `shape.radius`, `pitch`.
"""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

ROLES = [
    ("NONE", "None", "Not part of a mid-air set-up"),
    ("SETUP", "Set-up", "The frame of a mid-air set-up"),
    ("VIEWPOINT", "Viewpoint", "The eye that the image is compensated for"),
    ("IMAGE", "Image", "The undistorted mid-air image"),
    ("PLATE", "Plate", "The micro-mirror array plate"),
    ("DISPLAY", "Display", "The light source"),
    ("ELEMENT", "Element", "A distortive object: a refractive solid, or a reflective surface"),
]

BLOCKS = {"VIEWPOINT": "viewpoint", "IMAGE": "image", "PLATE": "plate", "DISPLAY": "display"}

# First words of the keys that are custom properties; other custom properties of an object are nobody's business here.
KEYS = {
    "ELEMENT": {"shape", "material", "absorption", "priority", "wall", "open", "fill"},
    "PLATE": {
        *("model", "pitch", "layer_depth", "azimuth", "reflectance", "ior"),
        *("glass_absorption", "cover_glass", "mirror_thickness", "luminance"),
    },
    "DISPLAY": {
        *("resolution", "model", "ppi", "diagonal_inches", "portrait", "emission", "polarisation", "response"),
        *("gamma", "black", "bits", "wavelengths"),
    },
}


def own_keys(thing):
    """An object's custom properties that are values of the scene file."""
    known = KEYS.get(thing.midair.role, ())
    return [key for key in thing.keys() if key.split(".")[0] in known]


def _is_root(_, thing):
    return thing.midair.role == "SETUP"


def _live_changed(properties, _):
    from . import live

    if properties.live:
        live.start()


class MidairFinding(bpy.types.PropertyGroup):
    """A sentence about the set-up, and what helps."""

    severity: StringProperty()
    sentence: StringProperty()
    remedy: StringProperty()


class MidairObject(bpy.types.PropertyGroup):
    """An object's part in a mid-air set-up."""

    role: EnumProperty(items=ROLES)
    setup: PointerProperty(type=bpy.types.Object, poll=_is_root, description="The set-up that it belongs to")
    index: IntProperty(description="Which of the scene file's elements it is, from 0")
    seen: StringProperty(description="The values that the scene file has been brought up to date with")
    built: StringProperty(description="The shape that the mesh was made by")
    mesh: StringProperty(description="What the mesh was when its file was written or read")

    # Of the frame, which stands for the whole set-up.
    text: PointerProperty(
        type=bpy.types.Text,
        name="Scene",
        description="The scene file's text; the Text Editor shows it",
    )
    folder: StringProperty(
        name="Folder", subtype="DIR_PATH", description="Where files that the scene names are looked for"
    )
    picture: PointerProperty(
        type=bpy.types.Image, name="Picture", description="What the mid-air image is to show: a picture or a movie"
    )
    way: EnumProperty(
        name="Display shows",
        items=[
            (
                "MAP",
                "Through the map",
                "Nodes look the picture up through the map: movies play, and what moves is followed",
            ),
            ("BAKED", "A baked picture", "The compensated picture itself, filtered and with what the display can show"),
        ],
    )
    optimal: BoolProperty(
        name="Best picture",
        description="Bake the display picture whose view is nearest to the picture, by least squares",
    )
    live: BoolProperty(name="Live", description="Compensate again while things move", update=_live_changed)
    show_rays: BoolProperty(name="Rays", description="Draw light's ways from the viewpoint to the display")
    ray_count: IntProperty(name="Rays a side", default=7, min=2, max=64)
    findings: CollectionProperty(type=MidairFinding)
    formed: FloatProperty(description="Share of the image that is formed; -1 where it is not known", default=-1.0)
    said: StringProperty(description="What went wrong last")


def root_of(context):
    """The set-up that is meant: the active object's, else the scene's only one; None if there is none."""
    thing = context.active_object
    if thing is not None:
        if thing.midair.role == "SETUP":
            return thing
        own = thing.midair.setup
        if own is not None and own.users_scene:
            return own
    roots = roots_in(context.scene)
    return roots[0] if len(roots) == 1 else None


class OfSetUp:
    """What is there only while a set-up is meant: the poll of operators and panels."""

    @classmethod
    def poll(cls, context):
        return root_of(context) is not None


def roots_in(scene):
    """All set-ups of a scene."""
    return [thing for thing in scene.objects if thing.midair.role == "SETUP" and thing.midair.text is not None]


def parts(root):
    """What belongs to a set-up, in the scene file's order of elements."""
    found = [
        thing
        for thing in bpy.data.objects
        if thing.midair.setup == root and thing.midair.role not in ("NONE", "SETUP") and thing.users_scene
    ]
    return sorted(found, key=lambda thing: (thing.midair.role != "ELEMENT", thing.midair.index, thing.name))


def part(root, role):
    """The set-up's viewpoint, image, plate or display; None if someone has removed it."""
    return next((thing for thing in parts(root) if thing.midair.role == role), None)


def elements(root):
    """The set-up's elements in the scene file's order."""
    return [thing for thing in parts(root) if thing.midair.role == "ELEMENT"]


def prefix(thing):
    """Where an object's values stand in the scene file."""
    role = thing.midair.role
    return f"element.{thing.midair.index}" if role == "ELEMENT" else BLOCKS[role]


CLASSES = (MidairFinding, MidairObject)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def register():
    _register_classes()
    bpy.types.Object.midair = PointerProperty(type=MidairObject)


def unregister():
    del bpy.types.Object.midair
    _unregister_classes()
