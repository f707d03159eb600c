# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files: File > Import and File > Export."""

import os
import shutil
import tempfile
import tomllib

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import building, properties, sync
from .solver import Trouble, told


def read(context, path):
    """A set-up from a scene file: its frame."""
    if not path.lower().endswith(".toml"):
        raise Trouble(f"{path}: scene files that Blender edits are TOML: write this one as TOML, or name a .toml file")
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise Trouble(f"{path}: the scene file cannot be read: {error}") from error
    name = os.path.basename(path)
    root = building.build(context, text, os.path.dirname(os.path.abspath(path)), name)
    context.view_layer.objects.active = root
    return root


def write(context, root, path):
    """The set-up's scene file as it stands now, and the files that it names beside it."""
    sync.bring_up_to_date(context, root)
    text = root.midair.text.as_string()
    folder = os.path.dirname(os.path.abspath(path))
    try:
        for name in named_files(tomllib.loads(text)):
            source, target = os.path.join(root.midair.folder, name), os.path.join(folder, name)
            if os.path.isfile(source) and os.path.realpath(source) != os.path.realpath(target):
                os.makedirs(os.path.dirname(target), exist_ok=True)
                shutil.copyfile(source, target)
        _whole(path, text)
    except OSError as error:
        raise Trouble(f"{path}: the scene cannot be written: {error}") from error


def named_files(values):
    """Files that a scene names by relative paths."""
    found = [values.get("plate", {}).get("luminance")]
    found += [values.get("display", {}).get(key) for key in ("emission", "response")]
    for element in values.get("element", []):
        found += [element.get(key, {}).get("file") for key in ("shape", "material")]
    return [name for name in found if name and not os.path.isabs(name)]


def _whole(path, text):
    """Writes a file whole or not at all."""
    handle, beside = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(path)), prefix=".midair-")
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
        # A temporary file is its maker's alone; a scene is as readable as other files.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(beside, 0o666 & ~mask)
        os.replace(beside, path)
    except BaseException:
        os.unlink(beside)
        raise


class MIDAIR_OT_import(bpy.types.Operator, ImportHelper):
    """Build a mid-air set-up from a scene file"""

    bl_idname = "import_scene.midair"
    bl_label = "Import Mid-air Scene"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".toml"
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    def execute(self, context):
        with told(self) as outcome:
            read(context, self.filepath)
        return outcome()


class MIDAIR_OT_export(properties.OfSetUp, bpy.types.Operator, ExportHelper):
    """Write the mid-air set-up as a scene file"""

    bl_idname = "export_scene.midair"
    bl_label = "Export Mid-air Scene"

    filename_ext = ".toml"
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    def execute(self, context):
        with told(self) as outcome:
            write(context, properties.root_of(context), self.filepath)
            self.report({"INFO"}, f"written: {self.filepath}")
        return outcome()


def _in_import(menu, _):
    menu.layout.operator(MIDAIR_OT_import.bl_idname, text="Mid-air scene (.toml)")


def _in_export(menu, _):
    menu.layout.operator(MIDAIR_OT_export.bl_idname, text="Mid-air scene (.toml)")


def register():
    bpy.utils.register_class(MIDAIR_OT_import)
    bpy.utils.register_class(MIDAIR_OT_export)
    bpy.types.TOPBAR_MT_file_import.append(_in_import)
    bpy.types.TOPBAR_MT_file_export.append(_in_export)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(_in_export)
    bpy.types.TOPBAR_MT_file_import.remove(_in_import)
    bpy.utils.unregister_class(MIDAIR_OT_export)
    bpy.utils.unregister_class(MIDAIR_OT_import)
