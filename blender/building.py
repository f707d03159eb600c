# SPDX-License-Identifier: GPL-3.0-or-later
"""From a scene file's text to Blender's objects."""

import json

import bpy

from . import frames, meshes, plate, properties, render, shapes, solver, surfaces


def build(context, text, folder, name):
    """A set-up in the scene, from a scene file's text: its frame. Raises the errors of `solver` before anything is made."""
    found = solver.load(text, folder)
    values = solver.values(text, folder)
    for element in values.get("element", []):
        meshes.check(element, folder)
    root = bpy.data.objects.new(values.get("name", name), None)
    kept = bpy.data.texts.new(name if name.endswith(".toml") else name + ".toml")
    try:
        _fill(context, root, kept, text, folder, values, found)
    except Exception:
        remove(root)
        raise
    return root


def _fill(context, root, kept, text, folder, values, found):
    """Hangs everything on the frame."""
    own = root.midair
    own.role, own.text, own.folder = "SETUP", kept, folder
    context.collection.objects.link(root)
    frames.set_root(root, context.scene)
    root.empty_display_size = 50.0
    kept.from_string(text)
    kept.cursor_set(0)
    context.view_layer.update()
    for role in ("IMAGE", "PLATE", "DISPLAY"):
        mesh = bpy.data.meshes.new(role.title())
        shapes.rectangle(mesh)
        thing = _part(context, root, role, role.title(), mesh)
        if role != "IMAGE":
            mesh.materials.append(bpy.data.materials.new(f"Mid-air {role.lower()}"))
        _custom(thing, values.get(role.lower(), {}))
    surfaces.display(properties.part(root, "DISPLAY").data.materials[0])
    eye = _part(context, root, "VIEWPOINT", "Viewpoint", bpy.data.cameras.new("Viewpoint"))
    image = properties.part(root, "IMAGE")
    image.display_type, image.hide_render = "WIRE", True
    for index, element in enumerate(values.get("element", [])):
        add_element(context, root, index, element)
    place_all(root, found, values)
    if context.scene.camera is None or context.scene.camera.midair.role == "VIEWPOINT":
        context.scene.camera = eye
    context.view_layer.update()
    remember(root)


def remove(root):
    """Takes a set-up out of the file."""
    kept = root.midair.text
    for thing in [*properties.parts(root), root]:
        bpy.data.objects.remove(thing)
    if kept is not None:
        bpy.data.texts.remove(kept)


def _part(context, root, role, name, data):
    """A new child of the frame."""
    thing = bpy.data.objects.new(name, data)
    context.collection.objects.link(thing)
    thing.parent = root
    thing.rotation_mode = frames.ORDER
    thing.midair.role, thing.midair.setup = role, root
    return thing


def element_name(element):
    """What people call an element: its name, or its shape."""
    return element.get("name") or element["shape"]["kind"]


def add_element(context, root, index, element):
    """An element as an object, by its block of the scene file."""
    name = element_name(element)
    mesh = bpy.data.meshes.new(name)
    thing = _part(context, root, "ELEMENT", name, mesh)
    thing.midair.index = index
    _custom(thing, element)
    mesh.materials.append(bpy.data.materials.new(name))
    reshape(thing)
    return thing


def _custom(thing, values, before=""):
    """The scene file's values that Blender has no place for, as custom properties."""
    for key, value in values.items():
        if not before and key in ("position", "rotation", "size", "name"):
            continue
        if isinstance(value, dict):
            _custom(thing, value, f"{before}{key}.")
        elif not (isinstance(value, list) and (not value or isinstance(value[0], list))):
            # Rows of numbers have no place among custom properties: the text has them.
            thing[before + key] = value


def block(thing):
    """An element's block, or a part's, from its custom properties."""
    values = {}
    for key in properties.own_keys(thing):
        inner = values
        *outer, last = key.split(".")
        for step in outer:
            inner = inner.setdefault(step, {})
        inner[last] = own_value(thing[key])
    return values


def own_value(value):
    """A custom property as Python has it."""
    return value.to_list() if hasattr(value, "to_list") else value


def take_mesh(thing):
    """Takes an element's mesh for what its shape says."""
    thing.midair.built = _described(block(thing)["shape"])


def _described(shape):
    return json.dumps(shape, sort_keys=True)


def reshape(thing):
    """Makes an element's mesh what its shape says, unless it is that already."""
    values = block(thing)
    shape = values["shape"]
    if thing.midair.built == _described(shape):
        return
    if shape["kind"] in ("lathe", "prism", "height-field"):
        own = thing.midair.setup.midair
        rows = solver.values(own.text.as_string(), own.folder)["element"][thing.midair.index]["shape"]
        shape = {key: value for key, value in rows.items() if isinstance(value, list)} | shape
    faces = shapes.build(shape)
    if faces is not None:
        faces.into(thing.data)
    elif shape["kind"] == "mesh":
        meshes.read(thing, shape)
    else:
        meshes.heights(thing, shape, refractive="mirror" not in values.get("material", {}))
    take_mesh(thing)


def place_all(root, found, values=None):
    """Stands everything where the scene says, and gives it its material."""
    values = values or solver.values(root.midair.text.as_string(), root.midair.folder)
    for thing in properties.parts(root):
        role = thing.midair.role
        if role == "ELEMENT":
            one = values["element"][thing.midair.index]
            frames.put(thing, one.get("position", (0, 0, 0)), one.get("rotation", (0, 0, 0)))
        elif role == "DISPLAY":
            place_display(thing, found)
        elif role != "VIEWPOINT":
            one = values[properties.BLOCKS[role]]
            frames.put(thing, one.get("position", (0, 0, 0)), one.get("rotation", (0, 0, 0)))
            thing.scale = (*one["size"], 1.0)
        else:
            thing.location = values["viewpoint"]["position"]
    for thing in properties.parts(root):
        clothe(thing, found)
    render.frame(root)


def place_display(thing, found):
    """Stands the display where midair has it, also where the scene file leaves that out."""
    position, rotation, size = solver.display(found)
    frames.put(thing, position, rotation)
    thing.scale = (*size, 1.0)


def clothe(thing, found):
    """The material of a plate or an element, from its custom properties."""
    if thing.midair.role == "PLATE":
        plate.fill(thing.data.materials[0], block(thing))
    elif thing.midair.role == "ELEMENT":
        stuff = block(thing)["material"]
        made = thing.data.materials[0]
        if stuff.get("mirror"):
            surfaces.mirror(made, stuff.get("reflectance", 1.0))
        elif stuff.get("opaque"):
            surfaces.opaque(made)
        else:
            surfaces.glass(made, solver.index(found, thing.midair.index))


def remember(root):
    """Takes all values as they are now for what the scene file has."""
    from . import sync

    for thing in properties.parts(root):
        thing.midair.seen = sync.written(sync.values(thing, root))
