# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes as meshes, held to the closed forms of their volumes, areas and normals."""

import math
import unittest

import bench
import numpy as np

SOLIDS = [
    ({"kind": "sphere", "radius": 25.0}, 4 / 3 * math.pi * 25**3),
    ({"kind": "ellipsoid", "radii": [30.0, 20.0, 8.0]}, 4 / 3 * math.pi * 30 * 20 * 8),
    ({"kind": "box", "size": [50.0, 40.0, 30.0]}, 50 * 40 * 30),
    ({"kind": "cylinder", "radius": 36.0, "height": 100.0}, math.pi * 36**2 * 100),
    (
        {"kind": "cone", "radius": 25.0, "top_radius": 15.0, "height": 50.0},
        math.pi * 50 / 3 * (25**2 + 25 * 15 + 15**2),
    ),
    ({"kind": "cone", "radius": 25.0, "height": 50.0}, math.pi * 50 / 3 * 25**2),
    ({"kind": "hemisphere", "radius": 25.0}, 2 / 3 * math.pi * 25**3),
    ({"kind": "torus", "radius": 30.0, "tube": 8.0}, 2 * math.pi**2 * 30 * 8**2),
    # Two caps of 10 mm of a ball of 34 with a rim of 24 are 20 mm thick.
    (
        {"kind": "lens", "radii": [34.0, 34.0], "thickness": 20.0, "diameter": 2 * math.sqrt(34**2 - 24**2)},
        2 * math.pi * 10**2 * (34 - 10 / 3),
    ),
    # A paraboloid of radius 50 falls by r^2 / 100: 4 mm at 20; its flat back is a disc.
    (
        {"kind": "lens", "radii": [50.0, 0.0], "conic": [-1.0, 0.0], "thickness": 6.0, "diameter": 40.0},
        math.pi * 20**2 * (2 + 4 / 2),
    ),
    # As much again falls by a4 alone: 4 mm at the rim of a flat surface, a third of the disc's volume below it.
    (
        {"kind": "lens", "radii": [0.0, 0.0], "aspheric_front": [4 / 20**4], "thickness": 6.0, "diameter": 40.0},
        math.pi * 20**2 * (6 - 4 / 3),
    ),
    ({"kind": "lathe", "profile": [[20.0, -10.0], [20.0, 10.0], [10.0, 30.0]]}, math.pi * (400 * 20 + 20 / 3 * 700)),
    # From top to bottom, with a hollow: a cylinder of 20 with a bore of 10.
    (
        {"kind": "lathe", "profile": [[10.0, 15.0], [20.0, 15.0], [20.0, -15.0], [10.0, -15.0], [10.0, 15.0]]},
        math.pi * 300 * 30,
    ),
    ({"kind": "prism", "outline": [[0, 0], [30, 0], [30, 10], [10, 10], [10, 40], [0, 40]], "depth": 7.0}, 600 * 7),
    ({"kind": "prism", "outline": [[0, 0], [0, 30], [40, 0]], "depth": 5.0}, 600 * 5),
]

SHEETS = [
    ({"kind": "plane", "size": [200.0, 100.0]}, 200 * 100),
    ({"kind": "cylinder-mirror", "radius": 250.0, "size": [200.0, 300.0], "facing": "convex"}, 200 * 300),
    ({"kind": "cylinder-mirror", "radius": 250.0, "size": [200.0, 300.0], "facing": "concave"}, 200 * 300),
    (
        {"kind": "sphere-mirror", "radius": 100.0, "diameter": 120.0, "facing": "convex"},
        2 * math.pi * 100 * (100 - 80),
    ),
    (
        {"kind": "sphere-mirror", "radius": 100.0, "diameter": 120.0, "facing": "concave"},
        2 * math.pi * 100 * (100 - 80),
    ),
]

# Corners lie on the surface, and no point of a facet is deeper below it than its diagonal's sagitta, (sqrt(2) 2 pi / 192)^2 / 8 of a ball's
# radius; three times that of its volume.
INSCRIBED = 3 * (2 * math.pi / 192) ** 2 / 4


def triangles(faces):
    """Corners and normals of the faces cut into triangles, (triangles, 3, 3) each, and which face each is of."""
    corners, normals, owners, at = [], [], [], 0
    for number, face in enumerate(faces.faces):
        own = faces.normals[at : at + len(face)]
        at += len(face)
        for k in range(1, len(face) - 1):
            corners.append([faces.corners[face[i]] for i in (0, k, k + 1)])
            normals.append([own[i] for i in (0, k, k + 1)])
            owners.append(number)
    return np.array(corners), np.array(normals), np.array(owners)


def areas(corners):
    """Each triangle's area as a vector along its front normal."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


class Shapes(unittest.TestCase):
    def build(self, shape):
        return triangles(bench.module("shapes").build(shape))

    def fits(self, corners, normals, owners, within):
        """Normals are of length 1, and each corner's is its face's within an angle."""
        # A face's own: triangles of a hollow outline may lie the other way round by themselves.
        area = np.zeros((owners.max() + 1, 3))
        np.add.at(area, owners, areas(corners))
        unit = (area / np.linalg.norm(area, axis=1, keepdims=True))[owners]
        np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-12)
        cosines = np.einsum("tkc,tc->tk", normals, unit)
        self.assertGreater(cosines.min(), math.cos(within))

    def test_solids_are_closed_and_have_their_volume(self):
        for shape, volume in SOLIDS:
            corners, normals, owners = self.build(shape)
            area = areas(corners)
            # Nothing is missing of a closed surface: its vector areas add up to none.
            np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-9 * volume)
            found = np.einsum("tc,tc->", corners[:, 0], area) / 3
            self.assertLessEqual(found, volume * (1 + 1e-12), shape)
            self.assertGreater(found, volume * (1 - INSCRIBED), shape)
            # Half a facet, 0.94 degrees around; stretched four to one it is four times that at most.
            self.fits(corners, normals, owners, math.radians(0.94 * 2 * 4))

    def test_sheets_have_their_area_and_face_up_in_the_middle(self):
        for shape, area in SHEETS:
            corners, normals, owners = self.build(shape)
            found = np.linalg.norm(areas(corners), axis=1).sum()
            self.assertLessEqual(found, area * (1 + 1e-12), shape)
            self.assertGreater(found, area * (1 - INSCRIBED), shape)
            self.fits(corners, normals, owners, math.radians(2.0))
            middle = np.linalg.norm(corners.reshape(-1, 3), axis=1).argmin()
            if shape["kind"] != "plane":
                self.assertLess(np.abs(normals.reshape(-1, 3)[middle][0]), 0.01)
            self.assertGreater(normals.reshape(-1, 3)[middle][2], 0.99)
            # Convex falls away from the middle, concave rises.
            heights = corners[..., 2]
            if shape.get("facing") == "convex":
                self.assertLess(heights.min(), -10.0)
                self.assertLessEqual(heights.max(), 0.0)
            elif shape.get("facing") == "concave":
                self.assertGreater(heights.max(), 10.0)
                self.assertGreaterEqual(heights.min(), 0.0)

    def test_a_height_field_is_a_solid_with_its_volume(self):
        columns, rows, size = 40, 30, (20.0, 12.0)
        # An inclined plane: between any two samples it is itself.
        heights = [
            [1.0 + 0.3 * i / columns + 0.5 * (rows - j) / rows for i in range(columns + 1)] for j in range(rows + 1)
        ]
        field = bench.module("shapes").height_field(heights, size, -2.0)
        corners, normals, owners = triangles(field)
        area = areas(corners)
        np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-9)
        found = np.einsum("tc,tc->", corners[:, 0], area) / 3
        self.assertAlmostEqual(found, 20 * 12 * (1.0 + 0.15 + 0.25 + 2.0), places=6)
        # The first row is the +y edge, where it is highest; all normals are the faces'.
        self.assertEqual(corners[..., 2].max(), 1.8)
        self.fits(corners, normals, owners, 1e-5)
        highest = corners.reshape(-1, 3)[corners[..., 2].argmax()]
        np.testing.assert_allclose(highest, (10, 6, 1.8))


if __name__ == "__main__":
    unittest.main()
