# SPDX-License-Identifier: GPL-3.0-or-later
"""Compensate: the map for the active camera, and what the display shows."""

import bpy

from . import frames, properties, solver, surfaces, sync
from .solver import Trouble, told

# Pixels that the map goes on beyond what it answers, so that interpolation has neighbours there.
BLEED = 4


def eye(context, root):
    """Where the active camera is, mm in the set-up's frame: the set-up's own viewpoint, or another that looks at it."""
    camera = context.scene.camera
    own = properties.part(root, "VIEWPOINT")
    if camera is None or camera == own:
        return frames.pose(own, root)[0]
    return list(root.matrix_world.inverted() @ camera.matrix_world.translation)


def scene_of(context, root):
    """midair's scene as things stand now, for the active camera."""
    sync.bring_up_to_date(context, root)
    own = root.midair
    found = solver.load(own.text.as_string(), own.folder)
    if context.scene.camera not in (None, properties.part(root, "VIEWPOINT")):
        found = solver.at_eye(found, eye(context, root))
    return found


def compensate(context, root, coarse=1):
    """Makes the display show what its picture asks for; with `coarse` above 1, by a map of so many times fewer pixels."""
    found = scene_of(context, root)
    width, height = solver.resolution(found)
    size = (max(width // coarse, 16), max(height // coarse, 16))
    made = solver.solve(found, size)
    picture = root.midair.picture
    if picture is None:
        picture = root.midair.picture = lattice()
    material = properties.part(root, "DISPLAY").data.materials[0]
    if root.midair.way == "BAKED" and coarse == 1:
        surfaces.show(material, baked(root, made, picture))
    else:
        surfaces.show(material, picture, map_image(root, made))
    if coarse == 1:
        judge(root, found, made)
    return made


def lattice():
    """A lattice of 7 x 7 yellow lines on black, as midair draws it: what is shown until a picture is chosen."""
    import numpy as np

    size, lines = 512, 7
    across = (np.arange(size) + 0.5) / size * lines
    on_line = np.abs(across - np.floor(across) - 0.5) < 0.06
    pixels = np.zeros((size, size, 3), np.uint8)
    pixels[on_line[:, None] | on_line[None, :]] = (255, 255, 0)
    return as_image("Mid-air lattice", pixels)


def map_image(root, made):
    """The map as an image: u and v, and in alpha whether there is an answer."""
    import numpy as np

    uv, ok = solver.looked_up(made, BLEED)
    height, width = ok.shape
    pixels = np.zeros((height, width, 4), np.float32)
    pixels[..., :2] = np.nan_to_num(uv, nan=-1.0)
    pixels[..., 3] = ok
    name = f"{root.name} map"
    image = bpy.data.images.get(name)
    if image is None or tuple(image.size) != (width, height):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.use_half_precision = False
    # Blender's row 0 is at the bottom.
    image.pixels.foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    image.update()
    return image


def baked(root, made, picture):
    """The picture that the display must show, as an image of its own."""
    if picture.source in ("MOVIE", "SEQUENCE"):
        raise Trouble(
            f"{picture.name}: a movie is not baked here: show it through the map, or apply the map to the file by "
            "`midair apply`"
        )
    shown = solver.applied(made, as_array(picture), root.midair.optimal)
    return as_image(f"{root.name} display", shown)


def as_array(image):
    """A picture's pixels, row 0 at the top: uint8 sRGB of one with 8 bits, else float32 in linear light."""
    import numpy as np

    width, height = image.size
    if width == 0 or height == 0:
        raise Trouble(f"{image.name}: the picture cannot be read: choose another, or reload it")
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(height, width, 4)[::-1, :, :3]
    if image.is_float:
        return np.ascontiguousarray(rows)
    return np.ascontiguousarray(np.rint(rows * 255.0).astype(np.uint8))


def as_image(name, array):
    """An array of pixels (row 0 at the top) as an image of that name."""
    import numpy as np

    height, width = array.shape[:2]
    is_float = array.dtype != np.uint8
    image = bpy.data.images.get(name)
    if image is None or tuple(image.size) != (width, height) or image.is_float != is_float:
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=is_float)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = array[..., :3] if is_float else array[..., :3] / np.float32(255.0)
    image.pixels.foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    image.update()
    image.pack()
    return image


def judge(root, found, made):
    """The set-up in words: what midair finds of it."""
    own = root.midair
    own.formed, findings = solver.judged(found)
    own.findings.clear()
    for severity, sentence, remedy in findings:
        line = own.findings.add()
        line.severity, line.sentence, line.remedy = severity, sentence, remedy
    folded, pixels = solver.folded(made)
    if folded:
        line = own.findings.add()
        line.severity = "note"
        line.sentence = (
            f"{folded / pixels:.1%} of the display's pixels are folded: several image points ask for each of them"
        )
        line.remedy = "the one nearest to the image's centre is shown"


class MIDAIR_OT_compensate(properties.OfSetUp, bpy.types.Operator):
    """Compute the map for the active camera, and make the display show the compensated picture"""

    bl_idname = "midair.compensate"
    bl_label = "Compensate"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        with told(self) as outcome:
            root = properties.root_of(context)
            root.midair.said = ""
            compensate(context, root)
            if root.midair.formed >= 0.0:
                self.report({"INFO"}, f"{root.midair.formed:.1%} of the image is formed")
        return outcome()


class MIDAIR_OT_uncompensated(properties.OfSetUp, bpy.types.Operator):
    """Make the display show the picture as it is, to compare"""

    bl_idname = "midair.uncompensated"
    bl_label = "Show Uncompensated"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        root = properties.root_of(context)
        if root.midair.picture is None:
            root.midair.picture = lattice()
        surfaces.show(properties.part(root, "DISPLAY").data.materials[0], root.midair.picture)
        return {"FINISHED"}


class MIDAIR_OT_picture(properties.OfSetUp, bpy.types.Operator):
    """Choose the picture or movie that the mid-air image is to show"""

    bl_idname = "midair.picture"
    bl_label = "Picture or Movie"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH")
    filter_image: bpy.props.BoolProperty(default=True, options={"HIDDEN"})
    filter_movie: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, _):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        with told(self) as outcome:
            try:
                picture = bpy.data.images.load(self.filepath, check_existing=True)
            except RuntimeError as error:
                raise Trouble(f"{self.filepath}: {error}") from error
            if picture.size[0] == 0:
                bpy.data.images.remove(picture)
                raise Trouble(
                    f"{self.filepath}: Blender reads no picture from this: give it a PNG, JPEG, TIFF, OpenEXR or a movie"
                )
            properties.root_of(context).midair.picture = picture
        return outcome()


CLASSES = (MIDAIR_OT_compensate, MIDAIR_OT_uncompensated, MIDAIR_OT_picture)


register, unregister = bpy.utils.register_classes_factory(CLASSES)
