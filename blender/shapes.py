# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene file's shapes as meshes, in their own frames and in millimetres.

Corners lie on the surface and normals are the surface's own, so that Cycles refracts as the closed form does, up to the facets' sagitta: a
ball of 192 sectors lies within r * (pi / 192)^2 / 2 = 0.00013 r of its mesh.
"""

from math import cos, hypot, pi, sin

# Facets around a body and along a bent sheet.
AROUND = 192


class Faces:
    """Corners, faces, and a normal for each corner of each face."""

    def __init__(self):
        self.corners = []
        self.faces = []
        self.normals = []

    def grid(self, at, columns, rows):
        """A smooth sheet: `at(i, j)` is a corner and its normal there, for i in 0..=columns and j in 0..=rows."""
        first = len(self.corners)
        normals = []
        for j in range(rows + 1):
            for i in range(columns + 1):
                corner, normal = at(i, j)
                self.corners.append(corner)
                normals.append(_unit(normal))
        for j in range(rows):
            for i in range(columns):
                a = j * (columns + 1) + i
                quad = [a, a + 1, a + columns + 2, a + columns + 1]
                # At a pole two corners are one.
                places = [self.corners[first + k] for k in quad]
                kept = [k for n, k in enumerate(quad) if _apart(places[n], places[n - 1])]
                if len(kept) > 2:
                    self.faces.append([first + k for k in kept])
                    self.normals.extend(normals[k] for k in kept)

    def flat(self, corners, normal):
        """A flat face."""
        first = len(self.corners)
        self.corners.extend(corners)
        self.faces.append(list(range(first, first + len(corners))))
        self.normals.extend([_unit(normal)] * len(corners))

    def into(self, mesh):
        """Fills a mesh of Blender's."""
        mesh.clear_geometry()
        mesh.from_pydata(self.corners, [], self.faces)
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.normals_split_custom_set(self.normals)
        mesh.update()


def _unit(v):
    length = hypot(*v)
    return tuple(c / length for c in v)


def _apart(a, b):
    return any(abs(x - y) > 1e-9 for x, y in zip(a, b))


def build(shape):
    """The faces of a shape as the scene file describes it; None for one that lies in a file."""
    maker = MAKERS.get(shape["kind"])
    return maker(shape) if maker else None


def obstacle(shape):
    """Why a shape cannot be built in Blender, and what helps; None if it can."""
    kind = shape["kind"]
    if kind not in MAKERS and kind not in ("mesh", "height-field"):
        return f"a {kind} is not built in Blender: give it another shape, or make it a mesh"
    if shape.get("smooth"):
        return f"a smooth {kind} is not built in Blender: give it straight lines through more points, or make it a mesh"
    return None


def rectangle(mesh):
    """One by one, about the origin, with uv from 0 to 1: +z is its front."""
    mesh.clear_geometry()
    mesh.from_pydata([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [], [(0, 1, 2, 3)])
    uv = mesh.uv_layers.new(name="UVMap")
    for loop, place in zip(uv.data, [(0, 0), (1, 0), (1, 1), (0, 1)]):
        loop.uv = place
    mesh.update()


def _ellipsoid(radii):
    faces = Faces()
    a, b, c = radii
    rows = AROUND // 2

    def at(i, j):
        around, down = 2 * pi * (i % AROUND) / AROUND, pi * j / rows
        # The poles exactly: their corners are to coincide.
        ring = 0.0 if j in (0, rows) else sin(down)
        x, y, z = ring * sin(around), -cos(down), ring * cos(around)
        return (a * x, b * y, c * z), (x / a, y / b, z / c)

    faces.grid(at, AROUND, rows)
    return faces


def _box(shape):
    faces = Faces()
    half = [length / 2 for length in shape["size"]]
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            corners = []
            for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))[::side]:
                corner = [0.0] * 3
                corner[axis], corner[u], corner[v] = side * half[axis], p * half[u], q * half[v]
                corners.append(tuple(corner))
            normal = [0.0] * 3
            normal[axis] = side
            faces.flat(corners, normal)
    return faces


def _frustum(bottom, top, height):
    faces = Faces()

    def at(i, j):
        turn = 2 * pi * (i % AROUND) / AROUND
        radius, y = (top, height / 2) if j else (bottom, -height / 2)
        normal = (sin(turn) * height, bottom - top, cos(turn) * height)
        return (radius * sin(turn), y, radius * cos(turn)), normal

    faces.grid(at, AROUND, 1)
    if bottom > 0:
        faces.flat(_circle(bottom, -height / 2)[::-1], (0, -1, 0))
    if top > 0:
        faces.flat(_circle(top, height / 2), (0, 1, 0))
    return faces


def _plane(shape):
    faces = Faces()
    x, y = (length / 2 for length in shape["size"])
    faces.flat([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], (0, 0, 1))
    return faces


def _side(shape):
    """1 for a convex sheet, -1 for a concave one."""
    return 1 if shape["facing"] == "convex" else -1


def _cylinder_mirror(shape):
    faces = Faces()
    radius, (arc, length), side = shape["radius"], shape["size"], _side(shape)

    def at(i, j):
        turn = (i / AROUND - 0.5) * arc / radius
        corner = (radius * sin(turn), (j - 0.5) * length, side * radius * (cos(turn) - 1))
        return corner, (side * sin(turn), 0, cos(turn))

    faces.grid(at, AROUND, 1)
    return faces


def _sphere_mirror(shape):
    from math import asin

    faces = Faces()
    radius, side = shape["radius"], _side(shape)
    rim = asin(shape["diameter"] / 2 / radius)
    rows = AROUND // 4

    def at(i, j):
        around, out = 2 * pi * (i % AROUND) / AROUND, rim * j / rows
        x, y = sin(out) * cos(around), sin(out) * sin(around)
        return (radius * x, radius * y, side * radius * (cos(out) - 1)), (side * x, side * y, cos(out))

    def outwards(i, j):
        return at(AROUND - i, j)

    faces.grid(outwards, AROUND, rows)
    return faces


def _hemisphere(shape):
    faces = Faces()
    radius, rows = shape["radius"], AROUND // 4

    def at(i, j):
        around, up = 2 * pi * (i % AROUND) / AROUND, pi / 2 * j / rows
        ring = 0.0 if j == rows else cos(up)
        normal = (ring * sin(around), sin(up), ring * cos(around))
        return tuple(radius * c for c in normal), normal

    faces.grid(at, AROUND, rows)
    faces.flat(_circle(radius, 0.0)[::-1], (0, -1, 0))
    return faces


def _torus(shape):
    faces = Faces()

    def at(i, j):
        around, over = 2 * pi * (i % AROUND) / AROUND, 2 * pi * (j % AROUND) / AROUND
        normal = (cos(over) * sin(around), sin(over), cos(over) * cos(around))
        ring = shape["radius"] + shape["tube"] * cos(over)
        return (ring * sin(around), shape["tube"] * sin(over), ring * cos(around)), normal

    faces.grid(at, AROUND, AROUND)
    return faces


def _lens(shape):
    faces = Faces()
    rim, rows = shape["diameter"] / 2, AROUND // 2
    conics = shape.get("conic", (0.0, 0.0))
    edges = []
    for side, name in ((1, "aspheric_front"), (-1, "aspheric_back")):
        which = 0 if side > 0 else 1
        surface = (shape["radii"][which], conics[which], shape.get(name, ()))

        def at(i, j, side=side, surface=surface):
            # Seen from outside, corners go round against the clock.
            around = side * 2 * pi * ((AROUND - i) % AROUND) / AROUND
            r = rim * j / rows
            fall, slope = _sagitta(r, *surface)
            x, y = cos(around), sin(around)
            corner = (r * x, r * y, side * (shape["thickness"] / 2 - fall))
            return corner, (slope * x, slope * y, side)

        faces.grid(at, AROUND, rows)
        edges.append(at(0, rows)[0][2])

    def wall(i, j):
        around = 2 * pi * (i % AROUND) / AROUND
        x, y = cos(around), sin(around)
        return (rim * x, rim * y, edges[1 - j]), (x, y, 0)

    faces.grid(wall, AROUND, 1)
    return faces


def _sagitta(r, radius, conic, terms):
    """How far a surface of revolution has fallen from its vertex at a distance from the axis, and its slope there."""
    fall = slope = 0.0
    if radius:
        root = (1 - (1 + conic) * (r / radius) ** 2) ** 0.5
        fall, slope = r * r / radius / (1 + root), r / radius / root
    for k, term in enumerate(terms):
        power = 4 + 2 * k
        fall, slope = fall + term * r**power, slope + term * power * r ** (power - 1)
    return fall, slope


def _lathe(shape):
    profile = [tuple(point) for point in shape["profile"]]
    if profile[0] != profile[-1]:
        # Ends off the axis are closed by flat faces.
        profile = [(0.0, profile[0][1]), *profile, (0.0, profile[-1][1])]
    pairs = list(zip(profile, profile[1:]))
    if sum((b[1] - a[1]) * (a[0] ** 2 + a[0] * b[0] + b[0] ** 2) for a, b in pairs) < 0:
        pairs = [(b, a) for a, b in reversed(pairs)]
    faces = Faces()
    for a, b in pairs:
        if hypot(b[0] - a[0], b[1] - a[1]) < 1e-9 or (a[0] == 0.0 and b[0] == 0.0):
            continue

        def at(i, j, a=a, b=b):
            turn = 2 * pi * (i % AROUND) / AROUND
            radius, y = b if j else a
            out = b[1] - a[1]
            return (radius * sin(turn), y, radius * cos(turn)), (out * sin(turn), a[0] - b[0], out * cos(turn))

        faces.grid(at, AROUND, 1)
    return faces


def _prism(shape):
    outline, half = [tuple(point) for point in shape["outline"]], shape["depth"] / 2
    if outline[0] == outline[-1]:
        outline.pop()
    pairs = list(zip(outline, outline[1:] + outline[:1]))
    if sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs) < 0:
        outline.reverse()
        pairs = list(zip(outline, outline[1:] + outline[:1]))
    faces = Faces()
    for a, b in pairs:
        if hypot(b[0] - a[0], b[1] - a[1]) > 1e-9:
            corners = [(*a, -half), (*b, -half), (*b, half), (*a, half)]
            faces.flat(corners, (b[1] - a[1], a[0] - b[0], 0))
    faces.flat([(*point, half) for point in outline], (0, 0, 1))
    faces.flat([(*point, -half) for point in reversed(outline)], (0, 0, -1))
    return faces


def _circle(radius, y):
    turns = [2 * pi * i / AROUND for i in range(AROUND)]
    return [(radius * sin(turn), y, radius * cos(turn)) for turn in turns]


MAKERS = {
    "sphere": lambda shape: _ellipsoid([shape["radius"]] * 3),
    "ellipsoid": lambda shape: _ellipsoid(shape["radii"]),
    "box": _box,
    "cylinder": lambda shape: _frustum(shape["radius"], shape["radius"], shape["height"]),
    "cone": lambda shape: _frustum(shape["radius"], shape.get("top_radius", 0.0), shape["height"]),
    "hemisphere": _hemisphere,
    "torus": _torus,
    "lens": _lens,
    "lathe": _lathe,
    "prism": _prism,
    "plane": _plane,
    "cylinder-mirror": _cylinder_mirror,
    "sphere-mirror": _sphere_mirror,
}


def height_field(rows, size, bottom):
    """A surface over a rectangle through rows of heights in mm, the first at the +y edge; a solid down to `bottom` if that is given."""
    faces = Faces()
    columns, lines = len(rows[0]) - 1, len(rows) - 1
    width, height = size
    step_x, step_y = width / columns, height / lines

    def z(i, j):
        return rows[lines - min(max(j, 0), lines)][min(max(i, 0), columns)]

    def place(i, j):
        return (i * step_x - width / 2, j * step_y - height / 2, z(i, j))

    def slope(behind, ahead, index, last, step):
        return (ahead - behind) / (step * (2 if 0 < index < last else 1))

    def at(i, j):
        across = slope(z(i - 1, j), z(i + 1, j), i, columns, step_x)
        up = slope(z(i, j - 1), z(i, j + 1), j, lines, step_y)
        return place(i, j), (-across, -up, 1)

    faces.grid(at, columns, lines)
    if bottom is not None:
        x, y = width / 2, height / 2
        faces.flat([(-x, -y, bottom), (-x, y, bottom), (x, y, bottom), (x, -y, bottom)], (0, 0, -1))
        for j, normal in ((0, (0, -1, 0)), (lines, (0, 1, 0))):
            edge = [place(i, j) for i in range(columns + 1)]
            wall = [(x, y, bottom) for x, y, _ in (edge[-1], edge[0])] + edge
            faces.flat(wall if j else wall[::-1], normal)
        for i, normal in ((0, (-1, 0, 0)), (columns, (1, 0, 0))):
            edge = [place(i, j) for j in range(lines + 1)]
            wall = [(x, y, bottom) for x, y, _ in (edge[-1], edge[0])] + edge
            faces.flat(wall[::-1] if i else wall, normal)
    return faces


def scaled(shape, factors):
    """A shape's lengths after scaling in the viewport: values by the scene file's keys. A ValueError says what no scaling can do."""
    x, y, z = factors
    alike = abs(x - y) < 1e-5 * abs(x) and abs(x - z) < 1e-5 * abs(x)
    kind = shape["kind"]
    if kind in ("lathe", "prism") or "aspheric_front" in shape or "aspheric_back" in shape:
        raise ValueError(f"a {kind} is not scaled: change its numbers in the scene's text and press Rebuild")
    if kind == "box":
        return {"size": [a * b for a, b in zip(shape["size"], factors)]}
    if kind == "ellipsoid":
        return {"radii": [a * b for a, b in zip(shape["radii"], factors)]}
    if kind == "plane":
        return {"size": [shape["size"][0] * x, shape["size"][1] * y]}
    if kind in ("cylinder", "cone") and abs(x - z) < 1e-5 * abs(x):
        lengths = {"radius": shape["radius"] * x, "height": shape["height"] * y}
        if "top_radius" in shape:
            lengths["top_radius"] = shape["top_radius"] * x
        return lengths
    if not alike:
        raise ValueError(REMEDIES.get(kind, f"a {kind} can only be scaled alike in all directions"))
    if kind in ("sphere", "hemisphere"):
        return {"radius": shape["radius"] * x}
    if kind == "torus":
        return {key: shape[key] * x for key in ("radius", "tube")}
    if kind == "lens":
        lengths = {key: shape[key] * x for key in ("thickness", "diameter")}
        return {"radii": [radius * x for radius in shape["radii"]], **lengths}
    if kind == "cylinder-mirror":
        return {"radius": shape["radius"] * x, "size": [length * x for length in shape["size"]]}
    if kind == "sphere-mirror":
        return {"radius": shape["radius"] * x, "diameter": shape["diameter"] * x}
    if kind == "height-field":
        lengths = {"size": [length * x for length in shape["size"]], "amplitude": shape["amplitude"] * x}
        if "depth" in shape:
            lengths["depth"] = shape["depth"] * x
        return lengths
    return {"scale": shape.get("scale", 1.0) * x}


REMEDIES = {
    "mesh": "a mesh is scaled alike in all directions; Object > Apply > Scale makes other factors its own",
    "sphere": "a ball scaled by different factors is an ellipsoid; scale it alike along x, y and z, or give it "
    "shape.kind = ellipsoid and shape.radii",
    "cylinder": "a cylinder stays round; scale it alike along x and z",
    "cone": "a cone stays round; scale it alike along x and z",
}
