# SPDX-License-Identifier: GPL-3.0-or-later
"""From edited objects back to the scene file's text.

Each object remembers the values that the text was last brought up to date with. What differs now has been edited, and only that is written,
by its path in the scene file: all else of the text, comments among it, stays as people wrote it.
"""

import json
import os
import tomllib

import bpy

from . import blocks, building, frames, meshes, properties, render, shapes, solver
from .solver import Trouble

# Positions and angles closer than this are the same: twice what is kept of them (frames.DIGITS).
SAME = 2e-4


def values(thing, root):
    """An object's values, by the scene file's keys within its block."""
    role = thing.midair.role
    position, rotation = frames.pose(thing, root)
    if role == "VIEWPOINT":
        return {"position": position}
    found = {"position": position, "rotation": rotation}
    for key in properties.own_keys(thing):
        found[key] = building.own_value(thing[key])
    factors = frames.scale(thing, root)
    if role != "ELEMENT":
        found["size"] = [frames.rounded(factor) for factor in factors[:2]]
        return found
    found["name"] = thing.name
    if any(abs(factor - 1.0) > 1e-5 for factor in factors):
        shape = building.block(thing).get("shape", {})
        try:
            lengths = shapes.scaled(shape, factors)
        except ValueError as error:
            raise Trouble(f"{thing.name}: {error}") from None
        for key, value in lengths.items():
            found["shape." + key] = (
                [frames.rounded(x) for x in value] if isinstance(value, list) else frames.rounded(value)
            )
    return found


def written(found):
    """Values as they are remembered."""
    return json.dumps(found, sort_keys=True)


def _same(key, a, b):
    if key in ("position", "rotation") or (key == "size" and a is not None):
        return isinstance(b, list) and all(abs(x - y) <= SAME for x, y in zip(a, b))
    return a == b


def edited(thing, root):
    """What has been edited of an object since its values were remembered."""
    before = json.loads(thing.midair.seen or "{}")
    now = values(thing, root)
    return {key: value for key, value in now.items() if not _same(key, value, before.get(key))}


def bring_up_to_date(context, root):
    """Writes what has been edited into the scene file's text; the keys that changed, by their paths.

    Raises the errors of `solver`, and then has changed nothing.
    """
    context.view_layer.update()
    _need_all(root)
    before = [(thing, thing.midair.index, thing.midair.seen) for thing in properties.parts(root)]
    try:
        return _bring_up_to_date(context, root)
    except Exception:
        for thing, index, seen in before:
            thing.midair.index, thing.midair.seen = index, seen
        raise


def _bring_up_to_date(context, root):
    text = root.midair.text.as_string()
    text, gone = _without_removed(text, properties.elements(root))
    changed = [f"element.{index}" for index in gone]
    text, added = _with_copies(text, root)
    changed += added
    changes, reshaped = {}, []
    given = tomllib.loads(text).get("display", {})
    for thing in properties.parts(root):
        own = edited(thing, root)
        if thing.midair.role == "DISPLAY" and {"position", "rotation"} & own.keys():
            # A display that the file leaves out is placed by both or by none.
            if "position" not in given or "rotation" not in given:
                own["position"], own["rotation"] = frames.pose(thing, root)
        if meshes.is_edited(thing):
            own["shape.file"] = meshes.file_name(thing)
            reshaped.append(thing)
        for key, value in own.items():
            changes[f"{properties.prefix(thing)}.{key}"] = value
    if not changes and not changed:
        return []
    for thing in reshaped:
        meshes.write(thing, os.path.join(root.midair.folder, meshes.file_name(thing)))
        thing["shape.file"], thing["shape.scale"], thing["shape.unit"] = meshes.file_name(thing), 1.0, "mm"
        building.take_mesh(thing)
        now = values(thing, root)
        for key in ("shape.scale", "shape.unit"):
            changes[f"{properties.prefix(thing)}.{key}"] = now[key]
    text = solver.changed(text, root.midair.folder, changes)
    found = solver.load(text, root.midair.folder)
    _replace(root.midair.text, text)
    changed += list(changes)
    _follow(context, root, found, changed)
    building.remember(root)
    return changed


def _need_all(root):
    for role in ("VIEWPOINT", "IMAGE", "PLATE", "DISPLAY"):
        if properties.part(root, role) is None:
            raise Trouble(f"{root.name}: the {role.lower()} has been removed: undo that, or read the scene file again")


def _replace(kept, text):
    kept.from_string(text)
    kept.cursor_set(0)


def _without_removed(text, elements):
    """The text without the elements that are no longer there; the others are numbered anew."""
    count = len(tomllib.loads(text).get("element", []))
    there = {thing.midair.index for thing in elements}
    gone = [index for index in range(count) if index not in there]
    for index in reversed(gone):
        text = blocks.without(text, index)
    for thing in elements:
        thing.midair.index -= sum(index < thing.midair.index for index in gone)
    return text, gone


def _with_copies(text, root):
    """The text with the elements that were made by duplicating others."""
    count = len(tomllib.loads(text).get("element", []))
    seen, added = set(), []
    for thing in properties.elements(root):
        index = thing.midair.index
        if index in seen or index >= count:
            own = building.block(thing)
            position, rotation = frames.pose(thing, root)
            text = blocks.appended(text, {"name": thing.name, **own, "position": position, "rotation": rotation})
            thing.midair.index = count
            if thing.data.users > 1:
                thing.data = thing.data.copy()
            thing.midair.seen = written(values(thing, root))
            added.append(f"element.{count}")
            count += 1
        seen.add(thing.midair.index)
    return text, added


def _follow(context, root, found, changed):
    """Brings along what follows from edits: meshes, materials, a display that stands where it belongs, the camera."""
    for thing in properties.elements(root):
        if not meshes.is_edited(thing):
            building.reshape(thing)
    given = tomllib.loads(root.midair.text.as_string()).get("display", {})
    if "position" not in given and "rotation" not in given:
        building.place_display(properties.part(root, "DISPLAY"), found)
    for thing in properties.parts(root):
        if _looks_other(properties.prefix(thing), changed):
            building.clothe(thing, found)
    render.frame(root)
    context.view_layer.update()


def _looks_other(own, changed):
    """Whether a change is to more of a thing than where it stands: materials that change stop a render that is under way."""
    stands = {f"{own}.{key}" for key in ("position", "rotation", "size", "name")}
    return any((key == own or key.startswith(own + ".")) and key not in stands for key in changed)


class MIDAIR_OT_sync(properties.OfSetUp, bpy.types.Operator):
    """Write what has been edited into the scene file's text"""

    bl_idname = "midair.sync"
    bl_label = "Update the Scene"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        with solver.told(self) as outcome:
            changed = bring_up_to_date(context, properties.root_of(context))
            self.report({"INFO"}, "changed: " + ", ".join(changed) if changed else "nothing has been edited")
        return outcome()


class MIDAIR_OT_reload(properties.OfSetUp, bpy.types.Operator):
    """Build the set-up anew from the scene file's text, after it was edited as text"""

    bl_idname = "midair.reload"
    bl_label = "Rebuild from the Text"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        root = properties.root_of(context)
        own = root.midair
        with solver.told(self) as outcome:
            made = building.build(context, own.text.as_string(), own.folder, own.text.name)
            made.matrix_world = root.matrix_world
            for key in ("picture", "way", "optimal", "show_rays", "ray_count"):
                setattr(made.midair, key, getattr(own, key))
            # The old set-up had the names until now.
            names = {thing.midair.role: thing.name for thing in properties.parts(root)}
            name, text = root.name, own.text.name
            building.remove(root)
            made.name, made.midair.text.name = name, text
            values = tomllib.loads(made.midair.text.as_string())
            for thing in properties.parts(made):
                if thing.midair.role == "ELEMENT":
                    thing.name = building.element_name(values["element"][thing.midair.index])
                else:
                    thing.name = names.get(thing.midair.role, thing.name)
            building.remember(made)
            context.view_layer.objects.active = made
        return outcome()


CLASSES = (MIDAIR_OT_sync, MIDAIR_OT_reload)


register, unregister = bpy.utils.register_classes_factory(CLASSES)
