# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera and settings by which Cycles shows what the viewer sees."""

import bpy
from mathutils import Vector

from . import frames, properties
from .solver import Trouble, told

# The least and the greatest shift that Blender's cameras take, in widths of the picture.
SHIFT = 10.0


def frame(root):
    """Turns the viewpoint's camera to the image's plane, so that its picture shows exactly the image: a pixel is an image point, wherever
    the eye is, as in midair's own views.

    The camera looks along the image's normal; lens and shift take the image's rectangle out of what it sees.
    """
    camera, image = properties.part(root, "VIEWPOINT"), properties.part(root, "IMAGE")
    if camera is None or image is None or camera.type != "CAMERA":
        return
    x, y, z = image.rotation_euler.to_quaternion().inverted() @ (camera.location - image.location)
    width = image.scale.x
    if z <= 0.0:
        raise Trouble(
            f"{root.name}: the viewpoint stands behind the image: move it to the image's front, or turn the image round"
        )
    camera.rotation_mode = frames.ORDER
    camera.rotation_euler = image.rotation_euler
    own = camera.data
    own.type, own.sensor_fit = "PERSP", "HORIZONTAL"
    own.lens = own.sensor_width * z / width
    own.shift_x, own.shift_y = (min(max(-c / width, -SHIFT), SHIFT) for c in (x, y))
    own.clip_start, own.clip_end = frames.unit(bpy.context.scene), 1e5 * frames.unit(bpy.context.scene)
    own.display_size = 30.0 * frames.unit(bpy.context.scene)


def is_framed(root):
    """Whether the camera's picture can show exactly the image: it cannot where the eye is more than ten widths aside."""
    camera, image = properties.part(root, "VIEWPOINT"), properties.part(root, "IMAGE")
    x, y, _ = image.rotation_euler.to_quaternion().inverted() @ (camera.location - image.location)
    return max(abs(x), abs(y)) <= SHIFT * image.scale.x


def nested(root):
    """Names of solids that are hollow, or whose bounds meet another's: Cycles knows no media within media."""
    solids = [
        thing
        for thing in properties.elements(root)
        if not thing.get("material.mirror") and not thing.get("material.opaque")
    ]
    found = {thing.name for thing in solids if "wall" in thing}
    bounds = [_bounds(thing) for thing in solids]
    for i, (low, high) in enumerate(bounds):
        for j, (other_low, other_high) in enumerate(bounds):
            if i != j and all(low[k] <= other_high[k] and other_low[k] <= high[k] for k in range(3)):
                found.add(solids[i].name)
    return sorted(found)


def _bounds(thing):
    corners = [thing.matrix_basis @ Vector(corner) for corner in thing.bound_box]
    return tuple(tuple(choose(corner[k] for corner in corners) for k in range(3)) for choose in (min, max))


def set_up(context, root, width, samples):
    """Cycles' settings: pixels are the mean over their square, and colours are the display's. A scene without a world is dark."""
    scene = context.scene
    image = properties.part(root, "IMAGE")
    scene.render.engine = "CYCLES"
    scene.camera = properties.part(root, "VIEWPOINT")
    scene.render.resolution_x = width
    scene.render.resolution_y = max(round(width * image.scale.y / image.scale.x), 4)
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1.0
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.view_settings.exposure, scene.view_settings.gamma = 0.0, 1.0
    own = scene.cycles
    own.samples, own.use_adaptive_sampling, own.use_denoising = samples, False, False
    own.pixel_filter_type, own.filter_width = "BOX", 1.0
    # As many meetings as a path may have in midair.
    own.max_bounces = own.transmission_bounces = own.glossy_bounces = own.transparent_max_bounces = 32
    own.caustics_reflective = own.caustics_refractive = True
    own.blur_glossy = own.sample_clamp_indirect = own.sample_clamp_direct = 0.0
    if scene.world is None:
        scene.world = bpy.data.worlds.new("Mid-air dark")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)


class MIDAIR_OT_set_up_render(properties.OfSetUp, bpy.types.Operator):
    """Set camera and Cycles so that a render shows what the viewer sees of the image"""

    bl_idname = "midair.set_up_render"
    bl_label = "Set Up the Render"
    bl_options = {"REGISTER", "UNDO"}

    width: bpy.props.IntProperty(
        name="Width", default=512, min=4, max=16384, description="The picture's pixels across the image"
    )
    samples: bpy.props.IntProperty(name="Samples", default=64, min=1, max=65536)

    def execute(self, context):
        with told(self) as outcome:
            root = properties.root_of(context)
            frame(root)
            if not is_framed(root):
                raise Trouble(
                    f"{root.name}: the viewpoint is more than ten image widths aside of the image's normal, further than "
                    "Blender shifts a camera's picture: turn the image towards the viewpoint, or render by a camera of your own"
                )
            set_up(context, root, self.width, self.samples)
            names = nested(root)
            if names:
                self.report(
                    {"WARNING"},
                    f"{', '.join(names)}: Cycles refracts at each surface as if against air: where solids overlap or are "
                    "hollow, what the viewer sees is shown by `midair view`, not by this render",
                )
        return outcome()


def register():
    bpy.utils.register_class(MIDAIR_OT_set_up_render)


def unregister():
    bpy.utils.unregister_class(MIDAIR_OT_set_up_render)
