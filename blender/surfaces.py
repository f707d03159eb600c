# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of a set-up: glass, mirrors, and the display with what it shows."""

# The display's nodes are found again by these names.
MAP, COVER, PICTURE = "Mid-air map", "Mid-air coverage", "Mid-air picture"


def _new(made):
    made.use_nodes = True
    made.node_tree.nodes.clear()
    out = made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    out.location = (600.0, 0.0)
    return made.node_tree, out


def _three(value):
    return [value] * 3 if isinstance(value, (int, float)) else list(value)


def glass(made, index):
    """Refraction alone: one way for each ray, as the map has it."""
    tree, out = _new(made)
    node = tree.nodes.new("ShaderNodeBsdfRefraction")
    node.inputs["Roughness"].default_value = 0.0
    node.inputs["IOR"].default_value = index
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    made.diffuse_color = (0.8, 0.95, 1.0, 0.3)


def mirror(made, reflectance):
    """A mirror that reflects so much of red, green and blue."""
    tree, out = _new(made)
    node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    node.inputs["Roughness"].default_value = 0.0
    node.inputs["Color"].default_value = (*_three(reflectance), 1.0)
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    made.diffuse_color = (0.7, 0.7, 0.7, 1.0)


def opaque(made):
    """What stops all light."""
    tree, out = _new(made)
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    made.diffuse_color = (0.05, 0.05, 0.05, 1.0)


def display(made):
    """The display: its front shows the picture at the uv that the map has for each of its points, its back is dark.

    Until there is a map the picture is shown as it is.
    """
    tree, out = _new(made)

    def node(kind, x, y, label=""):
        new = tree.nodes.new(kind)
        new.location = (x, y)
        new.label = new.name = label or new.name
        return new

    place = node("ShaderNodeUVMap", -1000, 0)
    place.uv_map = "UVMap"
    looked_up = node("ShaderNodeTexImage", -760, 150, MAP)
    covered = node("ShaderNodeTexImage", -760, -180, COVER)
    covered.interpolation = "Closest"
    for texture in (looked_up, covered):
        texture.extension = "EXTEND"
        tree.links.new(place.outputs[0], texture.inputs["Vector"])
    picture = node("ShaderNodeTexImage", -420, 100, PICTURE)
    picture.extension = "CLIP"
    tree.links.new(place.outputs[0], picture.inputs["Vector"])
    light = node("ShaderNodeEmission", 60, 100)
    tree.links.new(picture.outputs["Color"], light.inputs["Color"])
    # One where the display's front is seen.
    side = node("ShaderNodeNewGeometry", -420, -200)
    front = node("ShaderNodeMath", -180, -200)
    front.operation = "SUBTRACT"
    front.inputs[0].default_value = 1.0
    tree.links.new(side.outputs["Backfacing"], front.inputs[1])
    strength = node("ShaderNodeMath", -60, -60, "Mid-air strength")
    strength.operation = "MULTIPLY"
    strength.inputs[1].default_value = 1.0
    tree.links.new(front.outputs[0], strength.inputs[0])
    tree.links.new(strength.outputs[0], light.inputs["Strength"])
    tree.links.new(light.outputs[0], out.inputs["Surface"])
    made.diffuse_color = (0.1, 0.1, 0.1, 1.0)


def show(made, picture, mapped=None):
    """What a display's material shows: a picture as it is, or one that is looked up through a map (an image with u, v and, in
    alpha, whether there is an answer)."""
    tree = made.node_tree
    nodes = tree.nodes
    node = nodes[PICTURE]
    node.image = picture
    if picture is not None and picture.source in ("MOVIE", "SEQUENCE"):
        node.image_user.frame_duration = max(picture.frame_duration, 1)
        node.image_user.use_auto_refresh = True
        node.image_user.use_cyclic = True
    place = next(n for n in nodes if n.bl_idname == "ShaderNodeUVMap")
    strength = nodes["Mid-air strength"]
    for link in list(strength.inputs[1].links):
        tree.links.remove(link)
    if mapped is None:
        strength.inputs[1].default_value = 1.0
        tree.links.new(place.outputs[0], node.inputs["Vector"])
        nodes[MAP].image = nodes[COVER].image = None
    else:
        nodes[MAP].image = nodes[COVER].image = mapped
        tree.links.new(nodes[MAP].outputs["Color"], node.inputs["Vector"])
        tree.links.new(nodes[COVER].outputs["Alpha"], strength.inputs[1])
