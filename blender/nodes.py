# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader nodes from arithmetic: `a * b + 1` makes the nodes that compute it."""


class Wire:
    """What comes out of a node: a number of the shader."""

    def __init__(self, tree, socket):
        self.tree = tree
        self.socket = socket

    def __add__(self, other):
        return math(self.tree, "ADD", self, other)

    __radd__ = __add__

    def __sub__(self, other):
        return math(self.tree, "SUBTRACT", self, other)

    def __rsub__(self, other):
        return math(self.tree, "SUBTRACT", other, self)

    def __mul__(self, other):
        return math(self.tree, "MULTIPLY", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other):
        return math(self.tree, "DIVIDE", self, other)

    def __rtruediv__(self, other):
        return math(self.tree, "DIVIDE", other, self)

    def __pow__(self, other):
        return math(self.tree, "POWER", self, other)

    def __neg__(self):
        return self * -1.0

    def __abs__(self):
        return math(self.tree, "ABSOLUTE", self)

    def floor(self):
        return math(self.tree, "FLOOR", self)

    def sqrt(self):
        return math(self.tree, "SQRT", self)

    def exp(self):
        return math(self.tree, "EXPONENT", self)

    def sign(self):
        return math(self.tree, "SIGN", self)

    def above(self, other):
        """1 where it is above the other, else 0."""
        return math(self.tree, "GREATER_THAN", self, other)

    def below(self, other):
        """1 where it is below the other, else 0."""
        return math(self.tree, "LESS_THAN", self, other)


def put(tree, value, socket):
    """Leads a wire, a socket or a constant to a node's input."""
    if isinstance(value, Wire):
        value = value.socket
    if hasattr(value, "is_output"):
        tree.links.new(value, socket)
    else:
        socket.default_value = value


def math(tree, operation, *values):
    """A node of scalar arithmetic."""
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for value, socket in zip(values, node.inputs):
        put(tree, value, socket)
    return Wire(tree, node.outputs[0])


def vector(tree, operation, *values, output="Vector"):
    """A node of vector arithmetic; the socket of its result."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    inputs = [socket for socket in node.inputs if socket.enabled]
    for value, socket in zip(values, inputs):
        put(tree, value, socket)
    return node.outputs[output]


def dot(tree, a, b):
    """The scalar product of two vectors."""
    return Wire(tree, vector(tree, "DOT_PRODUCT", a, b, output="Value"))


def scaled(tree, a, factor):
    """A vector times a number."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "SCALE"
    put(tree, a, node.inputs["Vector"])
    put(tree, factor, node.inputs["Scale"])
    return node.outputs["Vector"]


def separate(tree, a):
    """A vector's three components."""
    node = tree.nodes.new("ShaderNodeSeparateXYZ")
    put(tree, a, node.inputs[0])
    return [Wire(tree, socket) for socket in node.outputs]


def combine(tree, *components):
    """A vector of three components."""
    node = tree.nodes.new("ShaderNodeCombineXYZ")
    for component, socket in zip(components, node.inputs):
        put(tree, component, socket)
    return node.outputs[0]


def group(name, inputs, outputs):
    """A new group of shader nodes: the tree, its inputs by name, and the node that its outputs lead to.

    Inputs are (name, kind, default, least, most), outputs (name, kind); kinds are Float, Color, Vector and Shader.
    """
    import bpy

    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for label, kind, default, least, most in inputs:
        socket = tree.interface.new_socket(label, in_out="INPUT", socket_type=f"NodeSocket{kind}")
        if kind == "Float":
            socket.min_value, socket.max_value = least, most
        socket.default_value = default
    for label, kind in outputs:
        tree.interface.new_socket(label, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    given = tree.nodes.new("NodeGroupInput")
    result = tree.nodes.new("NodeGroupOutput")
    wires = {label: Wire(tree, given.outputs[label]) for label, *_ in inputs}
    return tree, wires, result


def arrange(tree):
    """Sets the nodes in columns by how far they are from the inputs, so that a reader can follow them."""
    depth = {}

    def depth_of(node):
        if node not in depth:
            depth[node] = 0
            before = [link.from_node for socket in node.inputs for link in socket.links]
            depth[node] = 1 + max(map(depth_of, before), default=-1)
        return depth[node]

    rows = {}
    for node in tree.nodes:
        column = depth_of(node)
        row = rows[column] = rows.get(column, -1) + 1
        node.location = (220.0 * column, -180.0 * row)
        node.hide = node.bl_idname in ("ShaderNodeMath", "ShaderNodeVectorMath")
