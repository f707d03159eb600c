# SPDX-License-Identifier: GPL-3.0-or-later
"""Millimetres and Blender's units: a set-up's own frame hangs on one empty.

The empty turns midair's +y (up) to Blender's +z and scales millimetres to the scene's unit, whatever that is. All else of the
set-up are its children: their locations are millimetres, their rotations the scene file's degrees, as the file has them.
"""

from math import degrees, pi, radians

# Rx*Ry*Rz: Blender names the order by what is applied first.
ORDER = "ZYX"

# Digits kept of what comes back from Blender, which computes in single precision: a ten-thousandth of a millimetre and of a degree.
DIGITS = 4


def unit(scene):
    """Blender's units in a millimetre."""
    return 0.001 / scene.unit_settings.scale_length


def set_root(root, scene):
    """Makes an object the frame of a set-up."""
    root.rotation_mode = "XYZ"
    root.rotation_euler = (pi / 2.0, 0.0, 0.0)
    root.scale = (unit(scene),) * 3


def put(thing, position, rotation):
    """Places a child of the frame: mm, degrees."""
    thing.rotation_mode = ORDER
    thing.location = position
    thing.rotation_euler = [radians(angle) for angle in rotation]


def adopt(thing, root):
    """Hangs an object on the frame; where it stands in the world stays."""
    world = thing.matrix_world.copy()
    thing.parent = root
    thing.matrix_parent_inverse.identity()
    thing.rotation_mode = ORDER
    thing.matrix_basis = root.matrix_world.inverted() @ world


def _is_plain(thing, root):
    """Whether an object's own values say where it stands: nothing else moves it."""
    plain = thing.parent == root and thing.rotation_mode == ORDER and not thing.constraints
    return plain and thing.delta_location.length == 0.0


def pose(thing, root):
    """Position (mm) and rotation (degrees) of an object in the frame, as the scene file has them."""
    if _is_plain(thing, root):
        location, rotation = thing.location, thing.rotation_euler
    else:
        location, turned, _ = (root.matrix_world.inverted() @ thing.matrix_world).decompose()
        rotation = turned.to_euler(ORDER)
    return [rounded(x) for x in location], [rounded(degrees(angle)) for angle in rotation]


def scale(thing, root):
    """Factors on an object's own lengths along its axes, in the frame."""
    if _is_plain(thing, root):
        return [float(f"{x:.6g}") for x in thing.scale]
    return [float(f"{x:.6g}") for x in (root.matrix_world.inverted() @ thing.matrix_world).to_scale()]


def rounded(number):
    """A number without the noise of single precision; a zero has no sign."""
    return round(number, DIGITS) + 0.0
