# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays in the viewport: from the viewpoint by way of elements and plate to the display, coloured by what becomes of them."""

import bpy

from . import compensate, properties, solver

# As in midair's own pictures of statuses.
COLOURS = {
    "ok": (0.20, 0.75, 0.35, 0.9),
    "outside": (0.45, 0.55, 0.95, 0.9),
    "blocked": (0.90, 0.25, 0.20, 0.9),
}

_handle = None
_kept = {}


def segments(context, root):
    """Ends of the rays' pieces in the world and a colour for each end: what is drawn."""
    found = solver.load(root.midair.text.as_string(), root.midair.folder)
    if context.scene.camera not in (None, properties.part(root, "VIEWPOINT")):
        found = solver.at_eye(found, compensate.eye(context, root))
    side = root.midair.ray_count
    uv = [((i + 0.5) / side, (j + 0.5) / side) for j in range(side) for i in range(side)]
    points, colours = [], []
    for line, status in solver.rays(found, uv):
        world = [root.matrix_world @ _vector(point) for point in line]
        for a, b in zip(world, world[1:]):
            points += [tuple(a), tuple(b)]
            colours += [COLOURS[status]] * 2
    return points, colours


def _vector(point):
    from mathutils import Vector

    return Vector(point)


def draw():
    """Draws the rays of all set-ups that are to show them, by the matrices of the view that is drawn."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    for root in properties.roots_in(context.scene):
        if not root.midair.show_rays:
            continue
        state = (root.midair.text.as_string(), tuple(compensate.eye(context, root)), root.midair.ray_count)
        state += tuple(map(tuple, root.matrix_world))
        if _kept.get(root.name, (None,))[0] != state:
            try:
                _kept[root.name] = (state, segments(context, root))
            except solver.errors() as error:
                root.midair.said = solver.words(error)
                _kept[root.name] = (state, ([], []))
        points, colours = _kept[root.name][1]
        if not points:
            continue
        shader = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
        batch = batch_for_shader(shader, "LINES", {"pos": points, "color": colours})
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("LESS_EQUAL")
        shader.bind()
        shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        shader.uniform_float("lineWidth", 1.5)
        batch.draw(shader)
        gpu.state.depth_test_set("NONE")
        gpu.state.blend_set("NONE")


def register():
    global _handle
    _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister():
    bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    _kept.clear()
