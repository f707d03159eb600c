# SPDX-License-Identifier: GPL-3.0-or-later
"""Mid-air displays in Blender: the set-up as objects, what the display must show, and what the viewer sees.

midair's Python package does the computing; it comes inside the extension. Which module holds what:

    frames      millimetres and Blender's units
    shapes      the scene file's shapes as meshes
    nodes       shader nodes from arithmetic
    plate       the plate's node groups
    surfaces    materials of glass, mirrors and the display
    properties  what Blender's objects know of the set-up
    solver      what is asked of midair, and its errors as words
    building    from a scene file to objects
    blocks      elements' blocks in a scene file's text
    sync        from edited objects back to the scene file's text
    meshes      elements that are meshes, read and written
    compensate  the map, and what the display shows
    live        all that again while things move
    rays        the light's ways, drawn in the viewport
    render      a camera and settings by which Cycles shows what the viewer sees
    files       import and export
    adding      Add > Light > Mid-air
    panel       the side panel
"""

from . import adding, compensate, files, live, meshes, panel, properties, rays, render, sync

# In the order in which they are registered.
_MODULES = (properties, files, adding, sync, meshes, compensate, live, rays, render, panel)


def register():
    try:
        import midair  # noqa: F401
    except ImportError as error:
        raise RuntimeError(
            f"midair's Python package cannot be loaded ({error}): install the extension from its .zip, which holds it"
        ) from error
    for module in _MODULES:
        module.register()


def unregister():
    for module in reversed(_MODULES):
        module.unregister()
