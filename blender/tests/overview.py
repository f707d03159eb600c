# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a set-up from aside, with light's ways: for the book."""

import bench
import bpy
from mathutils import Vector


def render(root, path):
    """Renders the set-up as it lies in Blender; its plate becomes a pane, and a world is lit around it."""
    scene = bpy.context.scene
    root.midair.ray_count = 3
    points, _ = bench.module("rays").segments(bpy.context, root)
    curve = bpy.data.curves.new("rays", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.0007
    for a, b in zip(points[::2], points[1::2]):
        line = curve.splines.new("POLY")
        line.points.add(1)
        line.points[0].co, line.points[1].co = (*a, 1.0), (*b, 1.0)
    curve.materials.append(shining("rays", (0.05, 0.5, 0.12)))
    scene.collection.objects.link(bpy.data.objects.new("rays", curve))
    bpy.data.objects["Plate"].data.materials[0] = pane(0.3, (0.25, 0.45, 0.75))
    # The ball as a body: glass by itself is hardly seen before an even ground.
    bpy.data.objects["ball"].data.materials[0] = pane(0.4, (0.75, 0.55, 0.2))
    eye = bpy.data.objects["Viewpoint"].matrix_world.translation
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.012, location=eye)
    bpy.context.active_object.data.materials.append(shining("eye", (0.8, 0.25, 0.1)))
    camera = bpy.data.objects.new("aside", bpy.data.cameras.new("aside"))
    scene.collection.objects.link(camera)
    place, aim = Vector((0.95, -0.85, 0.45)), Vector((0.0, -0.29, 0.02))
    camera.location = place
    camera.rotation_euler = (aim - place).to_track_quat("-Z", "Y").to_euler()
    camera.data.lens = 34.0
    scene.camera = camera
    world = scene.world = bpy.data.worlds.new("bright")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.82, 0.84, 0.88, 1.0)
    world.cycles.sampling_method = "NONE"
    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    scene.cycles.samples = 64
    scene.render.filepath = str(path)
    with bench.quiet():
        bpy.ops.render.render(write_still=True)


def shining(name, colour):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    light, out = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    light.inputs["Color"].default_value = (*colour, 1.0)
    tree.links.new(light.outputs[0], out.inputs["Surface"])
    return made


def pane(share, colour):
    made = bpy.data.materials.new("pane")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    through, tint = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    tint.inputs["Color"].default_value = (*colour, 1.0)
    mix, out = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeOutputMaterial")
    mix.inputs[0].default_value = share
    tree.links.new(through.outputs[0], mix.inputs[1])
    tree.links.new(tint.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], out.inputs["Surface"])
    return made
