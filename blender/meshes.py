# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements that are meshes: read from the scene's files, edited in Blender, written again.

Blender's own readers and writers do the work.
"""

import os
import zlib

import bpy

from . import frames, properties, shapes
from .solver import Trouble, told

# Millimetres in the scene file's units.
UNITS = {"mm": 1.0, "um": 0.001, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

# As the file has them: its x, y and z are the mesh's.
AXES = {"forward_axis": "Y", "up_axis": "Z"}

READERS = {
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path, **AXES),
    ".stl": lambda path: bpy.ops.wm.stl_import(filepath=path, **AXES),
    ".ply": lambda path: bpy.ops.wm.ply_import(filepath=path, **AXES),
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
}


def check(element, folder):
    """Refuses what Blender cannot read, before anything is made of a scene."""
    shape = element["shape"]
    obstacle = shapes.obstacle(shape)
    if obstacle:
        raise Trouble(f"{element.get('name', shape['kind'])}: {obstacle}")
    if shape["kind"] != "mesh":
        return
    path = os.path.join(folder, shape["file"])
    ending = os.path.splitext(path)[1].lower()
    if ending not in READERS:
        raise Trouble(f"{path}: Blender does not read {ending or 'this'}: convert the mesh to OBJ, STL, PLY or glTF")
    if not os.path.isfile(path):
        raise Trouble(f"{path}: there is no such file: put the mesh there, or correct `file` in the scene")


def read(thing, shape):
    """The mesh that a shape names, in mm, as an element's own."""
    path = os.path.join(_folder(thing), shape["file"])
    factor = shape.get("scale", 1.0) * UNITS[shape.get("unit", "mm")]
    mesh = thing.data
    corners, faces, normals = _read(path)
    mesh.clear_geometry()
    mesh.from_pydata([[c * factor for c in corner] for corner in corners], [], faces)
    how = shape.get("normals", "auto")
    smooth = how != "flat"
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.update()
    if how == "auto":
        from math import radians

        mesh.set_sharp_from_angle(angle=radians(shape.get("crease_angle", 30.0)))
        if normals is not None:
            mesh.normals_split_custom_set(normals)
    thing.midair.mesh = signature(mesh)


def _read(path):
    """Corners, faces and normals (by face corner, if the file gives any) of a file."""
    before = set(bpy.data.objects)
    active, chosen = bpy.context.view_layer.objects.active, list(bpy.context.selected_objects)
    reader = READERS[os.path.splitext(path)[1].lower()]
    try:
        reader(path)
    except RuntimeError as error:
        raise Trouble(f"{path}: {error}") from error
    corners, faces, normals = [], [], []
    custom = False
    made = [thing for thing in bpy.data.objects if thing not in before]
    bpy.context.view_layer.update()
    # Blender turns glTF's +y to its +z; an element keeps the file's axes.
    turn = None
    if path.lower().endswith((".glb", ".gltf")):
        from mathutils import Matrix

        turn = Matrix(((1, 0, 0), (0, 0, 1), (0, -1, 0)))
    for thing in made:
        if thing.type != "MESH":
            continue
        first, world = len(corners), thing.matrix_world
        for vertex in thing.data.vertices:
            at = world @ vertex.co
            corners.append(tuple(turn @ at if turn else at))
        rotation = world.to_3x3().inverted_safe().transposed()
        custom = custom or thing.data.has_custom_normals
        for polygon in thing.data.polygons:
            faces.append([first + index for index in polygon.vertices])
            for loop in polygon.loop_indices:
                normal = (rotation @ thing.data.corner_normals[loop].vector).normalized()
                normals.append(tuple(turn @ normal if turn else normal))
    for thing in made:
        data = thing.data
        bpy.data.objects.remove(thing)
        if data is not None and data.users == 0 and isinstance(data, bpy.types.Mesh):
            bpy.data.meshes.remove(data)
    for thing in chosen:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = active
    if not faces:
        raise Trouble(f"{path}: there are no faces in it: export the mesh again with its faces")
    return corners, faces, normals if custom else None


def heights(thing, shape, refractive):
    """A height field as a mesh, in mm."""
    rows = shape.get("samples")
    if rows is None:
        rows = _grey(os.path.join(_folder(thing), shape["file"]))
    amplitude = shape["amplitude"]
    bottom = -shape.get("depth", abs(amplitude)) if refractive else None
    scaled = [[amplitude * sample for sample in row] for row in rows]
    shapes.height_field(scaled, shape["size"], bottom).into(thing.data)


def _grey(path):
    """Rows of a grey picture's samples, the first row at the top."""
    try:
        picture = bpy.data.images.load(path)
        picture.colorspace_settings.name = "Non-Color"
        width, height = picture.size
        red = list(picture.pixels)[0::4]
        bpy.data.images.remove(picture)
    except RuntimeError as error:
        raise Trouble(f"{path}: {error}") from error
    return [red[row * width : (row + 1) * width] for row in reversed(range(height))]


def _folder(thing):
    return thing.midair.setup.midair.folder


def signature(mesh):
    """A number that changes with a mesh's corners and faces."""
    import numpy as np

    corners = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", corners)
    faces = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", faces)
    return f"{zlib.crc32(faces.tobytes(), zlib.crc32(corners.tobytes())):08x}"


def is_edited(thing):
    """Whether an element's mesh is no longer what its file has."""
    mesh = thing.midair.role == "ELEMENT" and thing.get("shape.kind") == "mesh"
    return mesh and _signature_of_shown(thing) != thing.midair.mesh


def _signature_of_shown(thing):
    if not thing.modifiers:
        return signature(thing.data)
    shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return signature(shown.data)


def file_name(thing):
    """Where a mesh that was edited in Blender is written: never over a file that came from elsewhere."""
    plain = "".join(c if c.isalnum() or c in "-_" else "-" for c in thing.name)
    return f"{plain}-blender.obj"


def write(thing, path):
    """Writes an element's mesh as it is shown, in its own frame and in mm."""
    context = bpy.context
    shown = thing.evaluated_get(context.evaluated_depsgraph_get())
    copy = bpy.data.objects.new("Mid-air export", bpy.data.meshes.new_from_object(shown))
    context.collection.objects.link(copy)
    active, chosen = context.view_layer.objects.active, list(context.selected_objects)
    for other in chosen:
        other.select_set(False)
    copy.select_set(True)
    context.view_layer.objects.active = copy
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        bpy.ops.wm.obj_export(
            filepath=path,
            export_selected_objects=True,
            export_materials=False,
            export_uv=False,
            export_normals=True,
            export_triangulated_mesh=True,
            **AXES,
        )
    except (OSError, RuntimeError) as error:
        raise Trouble(f"{path}: the mesh cannot be written: {error}") from error
    finally:
        mesh = copy.data
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
        for other in chosen:
            other.select_set(True)
        context.view_layer.objects.active = active
    thing.midair.mesh = _signature_of_shown(thing)


class MIDAIR_OT_element_from_mesh(bpy.types.Operator):
    """Make the active mesh an element of the set-up; its file is written beside the scene"""

    bl_idname = "midair.element_from_mesh"
    bl_label = "Element from Mesh"
    bl_options = {"REGISTER", "UNDO"}

    mirror: bpy.props.BoolProperty(name="Mirror", description="It reflects; else it is transparent")
    ior: bpy.props.FloatProperty(name="IOR", default=1.49, min=1.0, max=5.0)

    @classmethod
    def poll(cls, context):
        thing = context.active_object
        return thing is not None and thing.type == "MESH" and thing.midair.role == "NONE"

    def execute(self, context):
        with told(self) as outcome:
            roots = properties.roots_in(context.scene)
            if len(roots) != 1:
                raise Trouble("there has to be one mid-air set-up in the scene: Add > Light > Mid-air")
            adopt(context, roots[0], context.active_object, self.mirror, self.ior)
        return outcome()


def adopt(context, root, thing, mirror, ior):
    """Makes a mesh object an element of a set-up."""
    from . import building, sync

    own = thing.midair
    frames.adopt(thing, root)
    # The scale becomes the mesh's own: its lengths are millimetres then.
    if thing.data.users > 1:
        thing.data = thing.data.copy()
    from mathutils import Matrix

    thing.data.transform(Matrix.Diagonal((*thing.scale, 1.0)))
    if Matrix.Diagonal((*thing.scale, 1.0)).determinant() < 0:
        thing.data.flip_normals()
    thing.scale = (1.0, 1.0, 1.0)
    context.view_layer.update()
    own.role, own.setup, own.index = "ELEMENT", root, len(properties.elements(root))
    thing["shape.kind"], thing["shape.file"] = "mesh", file_name(thing)
    if mirror:
        thing["material.mirror"] = True
    else:
        thing["material.ior"] = ior
    thing.data.materials.clear()
    thing.data.materials.append(bpy.data.materials.new(thing.name))
    try:
        write(thing, os.path.join(root.midair.folder, file_name(thing)))
        building.take_mesh(thing)
        sync.bring_up_to_date(context, root)
    except Exception:
        own.role, own.setup = "NONE", None
        raise


def register():
    bpy.utils.register_class(MIDAIR_OT_element_from_mesh)


def unregister():
    bpy.utils.unregister_class(MIDAIR_OT_element_from_mesh)
