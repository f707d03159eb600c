# SPDX-License-Identifier: GPL-3.0-or-later
"""The micro-mirror array plate in Cycles: node groups around a Ray Portal BSDF.

A ray that arrives at the portal goes on from another place in another direction. The ideal plate keeps the place and
takes reflect(Incoming, Normal) for the direction: Incoming points back along the ray, so the component along the normal is
kept and the two along the plate are reversed.

The slit-mirror plate draws at random where between two mirrors the ray enters each layer, and follows it through the
layer unfolded: a straight line over equal cells, as many mirrors as cells are crossed (midair's `optics::plate::slit_mirror` has
the derivation). So each number of mirrors comes up as often as in the plate, and mid-air image, stray images and the view
through have its shares. With Slits at 1 nothing is drawn: the mirrors stand where they stand, and show.
"""

import bpy

from . import nodes
from .nodes import Wire

IDEAL = "Mid-air ideal plate"
SLIT_MIRROR = "Mid-air slit-mirror plate"
LAYER = "Mid-air layer of slit mirrors"

# Inputs of the slit-mirror plate's group: name, kind, default, least, most, and the scene file's key.
PARAMETERS = [
    ("Pitch", "Float", 0.5, 1e-4, 1e3, "pitch"),
    ("Layer Depth", "Float", 1.25, 1e-4, 1e3, "layer_depth"),
    ("Azimuth", "Float", 45.0, -360.0, 360.0, "azimuth"),
    ("Reflectance", "Color", (0.87, 0.87, 0.87, 1.0), 0.0, 1.0, "reflectance"),
    ("IOR", "Float", 1.52, 1.0, 5.0, "ior"),
    ("Absorption", "Color", (0.0, 0.0, 0.0, 1.0), 0.0, 1e3, "glass_absorption"),
    ("Cover Glass", "Float", 0.75, 0.0, 1e3, "cover_glass"),
    ("Mirror Thickness", "Float", 0.0, 0.0, 1e3, "mirror_thickness"),
]


def ideal_group():
    """The ideal plate: plane symmetry, without loss."""
    if IDEAL in bpy.data.node_groups:
        return bpy.data.node_groups[IDEAL]
    tree, _, result = nodes.group(IDEAL, [], [("BSDF", "Shader")])
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    portal = tree.nodes.new("ShaderNodeBsdfRayPortal")
    turned = nodes.vector(tree, "REFLECT", geometry.outputs["Incoming"], geometry.outputs["Normal"])
    tree.links.new(turned, portal.inputs["Direction"])
    tree.links.new(geometry.outputs["Position"], portal.inputs["Position"])
    tree.links.new(portal.outputs[0], result.inputs["BSDF"])
    nodes.arrange(tree)
    return tree


def layer_group():
    """One layer of slit mirrors, in the plane across them; lengths in mm."""
    if LAYER in bpy.data.node_groups:
        return bpy.data.node_groups[LAYER]
    far = 1e9
    inputs = [
        (name, "Float", 0.0, -far, far)
        for name in ("At", "Slope", "Before", "After", "Pitch", "Depth", "Thickness", "Random", "Slits")
    ]
    # Even: 1 or -1, what becomes of the slope. Mirrors: how many are met. Open: 0 where the ray meets a mirror's end.
    outputs = [(name, "Float") for name in ("Exit", "Even", "Mirrors", "Open")]
    tree, given, result = nodes.group(LAYER, inputs, outputs)
    slope, pitch, thickness = given["Slope"], given["Pitch"], given["Thickness"]
    clear = pitch - thickness
    entry = given["At"] + slope * given["Before"]
    # Where in its cell the ray enters, as a share of the pitch: where it does, or anywhere.
    cells = entry / pitch
    own = cells - cells.floor()
    share = given["Random"] + (own - given["Random"]) * given["Slits"]
    offset = share * pitch - thickness * 0.5
    space = entry - offset
    # Half of the clear width, with room for rounding: mirrors without thickness have no end to be hit.
    opened = abs(offset - clear * 0.5).below(clear * 0.5 + pitch * 1e-5)
    unfolded = offset + slope * given["Depth"]
    cell = (unfolded / clear).floor()
    mirrors = abs(cell)
    odd = mirrors - (mirrors * 0.5).floor() * 2.0
    rest = unfolded - cell * clear
    folded = rest + (clear - rest * 2.0) * odd
    even = 1.0 - odd * 2.0
    leaves = space + folded + slope * even * given["After"]
    for name, value in (("Exit", leaves), ("Even", even), ("Mirrors", mirrors), ("Open", opened)):
        nodes.put(tree, value, result.inputs[name])
    nodes.arrange(tree)
    return tree


def _axes(tree):
    """The object's x, y and z in the world: as unit vectors, and their lengths."""
    units, lengths = [], []
    for unit in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        turn = tree.nodes.new("ShaderNodeVectorTransform")
        turn.vector_type, turn.convert_from, turn.convert_to = "VECTOR", "OBJECT", "WORLD"
        turn.inputs["Vector"].default_value = unit
        axis = turn.outputs[0]
        units.append(nodes.vector(tree, "NORMALIZE", axis))
        lengths.append(Wire(tree, nodes.vector(tree, "LENGTH", axis, output="Value")))
    return units, lengths


def slit_mirror_group():
    """The slit-mirror plate. It belongs on a rectangle of one by one, scaled along x and y to its size; along z, one unit of the object
    is a millimetre."""
    if SLIT_MIRROR in bpy.data.node_groups:
        return bpy.data.node_groups[SLIT_MIRROR]
    inputs = [parameter[:5] for parameter in PARAMETERS]
    inputs.append(("Slits", "Float", 0.0, 0.0, 1.0))
    tree, given, result = nodes.group(SLIT_MIRROR, inputs, [("BSDF", "Shader")])
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    place = tree.nodes.new("ShaderNodeTexCoord")
    position = geometry.outputs["Position"]
    axes, lengths = _axes(tree)
    millimetre = lengths[2]

    # The ray in the plate's frame, mm: where it meets the mid-plane, and where it travels.
    objectx, objecty, _ = nodes.separate(tree, place.outputs["Object"])
    x, y = objectx * (lengths[0] / millimetre), objecty * (lengths[1] / millimetre)
    dx, dy, dz = (-nodes.dot(tree, geometry.outputs["Incoming"], axis) for axis in axes)
    side = dz.sign()
    upwards = dz.above(0.0)
    cos_i = abs(dz)
    ior = given["IOR"]
    cos_t = (1.0 - (1.0 - cos_i * cos_i) / (ior * ior)).sqrt()
    depth, cover = given["Layer Depth"], given["Cover Glass"]
    half = depth + cover
    to_face = -half / cos_i
    deflection = 1.0 / (ior * cos_t)

    # Components across the mirrors of layer 0, which lies on the +z side, and of layer 1.
    turn = given["Azimuth"] * (3.141592653589793 / 180.0)
    sin, cos = nodes.math(tree, "SINE", turn), nodes.math(tree, "COSINE", turn)
    at_x, at_y = x + dx * to_face, y + dy * to_face
    at = (at_y * cos - at_x * sin, at_x * cos + at_y * sin)
    along = (dy * cos - dx * sin, dx * cos + dy * sin)
    # Glass before layer 0 and behind it; for layer 1 the other way round.
    before = cover + depth * upwards
    after = cover + depth * (1.0 - upwards)

    noise = tree.nodes.new("ShaderNodeTexWhiteNoise")
    noise.noise_dimensions = "3D"
    tree.links.new(position, noise.inputs["Vector"])
    drawn = nodes.separate(tree, noise.outputs["Color"])

    layers = []
    for number, (first, last) in enumerate(((before, after), (after, before))):
        layer = tree.nodes.new("ShaderNodeGroup")
        layer.node_tree = layer_group()
        wanted = {
            "At": at[number],
            "Slope": along[number] * deflection,
            "Before": first,
            "After": last,
            "Pitch": given["Pitch"],
            "Depth": depth,
            "Thickness": given["Mirror Thickness"],
            "Random": drawn[number],
            "Slits": given["Slits"],
        }
        for name, value in wanted.items():
            nodes.put(tree, value, layer.inputs[name])
        layers.append({socket.name: Wire(tree, socket) for socket in layer.outputs})

    def back(a, b):
        """Local x and y of components across the mirrors."""
        return b * cos - a * sin, a * cos + b * sin

    exit_x, exit_y = back(layers[0]["Exit"], layers[1]["Exit"])
    out_x, out_y = back(along[0] * layers[0]["Even"], along[1] * layers[1]["Even"])

    def to_world(components):
        parts = [nodes.scaled(tree, axis, c) for axis, c in zip(axes, components)]
        return nodes.vector(tree, "ADD", nodes.vector(tree, "ADD", parts[0], parts[1]), parts[2])

    # From the mid-plane to where light leaves the far face.
    moved = to_world([c * millimetre for c in (exit_x - x, exit_y - y, side * half)])
    portal = tree.nodes.new("ShaderNodeBsdfRayPortal")
    tree.links.new(nodes.vector(tree, "ADD", position, moved), portal.inputs["Position"])
    tree.links.new(to_world([out_x, out_y, dz]), portal.inputs["Direction"])

    # What is left of the light: both faces (Fresnel, unpolarised), the mirrors met, the glass, the mirrors' ends.
    across = (cos_i - ior * cos_t) / (cos_i + ior * cos_t)
    within = (ior * cos_i - cos_t) / (ior * cos_i + cos_t)
    face = 1.0 - (across * across + within * within) * 0.5
    passed = face * face * layers[0]["Open"] * layers[1]["Open"]
    met = layers[0]["Mirrors"] + layers[1]["Mirrors"]
    length = half * 2.0 / cos_t
    colours = []
    reflectance = nodes.separate(tree, given["Reflectance"])
    absorption = nodes.separate(tree, given["Absorption"])
    for mirror, glass in zip(reflectance, absorption):
        colours.append(passed * mirror**met * (-glass * length).exp())
    tree.links.new(nodes.combine(tree, *colours), portal.inputs["Color"])
    tree.links.new(portal.outputs[0], result.inputs["BSDF"])
    nodes.arrange(tree)
    return tree


def material(name, values):
    """A plate's material, by the values of the scene file's `[plate]`."""
    made = bpy.data.materials.new(name)
    fill(made, values)
    return made


def fill(made, values):
    """Makes a material the plate's: its group of nodes, and the group's inputs."""
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    slit = values.get("model", "ideal") == "slit-mirror"
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = slit_mirror_group() if slit else ideal_group()
    out = tree.nodes.new("ShaderNodeOutputMaterial")
    out.location = (260.0, 0.0)
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    made.diffuse_color = (0.55, 0.75, 0.95, 0.25)
    if slit:
        for name, kind, _, _, _, key in PARAMETERS:
            if key in values:
                node.inputs[name].default_value = _colour(values[key]) if kind == "Color" else values[key]


def _colour(value):
    """One number or three, as a colour."""
    three = [value] * 3 if isinstance(value, (int, float)) else list(value)
    return (*three, 1.0)
