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
    """Corners and normals of the faces cut into triangles: (triangles, 3, 3) each."""
    corners, normals, at = [], [], 0
    for face in faces.faces:
        own = faces.normals[at : at + len(face)]
        at += len(face)
        for k in range(1, len(face) - 1):
            corners.append([faces.corners[face[i]] for i in (0, k, k + 1)])
            normals.append([own[i] for i in (0, k, k + 1)])
    return np.array(corners), np.array(normals)


def areas(corners):
    """Each triangle's area as a vector along its front normal."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


class Shapes(unittest.TestCase):
    def build(self, shape):
        return triangles(bench.module("shapes").build(shape))

    def fits(self, corners, normals, within):
        """Normals are of length 1, and each corner's is its face's within an angle."""
        area = areas(corners)
        # A wall under a row of samples is one face: corners on a line make triangles of no area.
        seen = np.linalg.norm(area, axis=1) > 1e-9
        area, normals = area[seen], normals[seen]
        unit = area / np.linalg.norm(area, axis=1, keepdims=True)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-12)
        cosines = np.einsum("tkc,tc->tk", normals, unit)
        self.assertGreater(cosines.min(), math.cos(within))

    def test_solids_are_closed_and_have_their_volume(self):
        for shape, volume in SOLIDS:
            corners, normals = self.build(shape)
            area = areas(corners)
            # Nothing is missing of a closed surface: its vector areas add up to none.
            np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-9 * volume)
            found = np.einsum("tc,tc->", corners[:, 0], area) / 3
            self.assertLessEqual(found, volume * (1 + 1e-12), shape)
            self.assertGreater(found, volume * (1 - INSCRIBED), shape)
            # Half a facet, 0.94 degrees around; stretched four to one it is four times that at most.
            self.fits(corners, normals, math.radians(0.94 * 2 * 4))

    def test_sheets_have_their_area_and_face_up_in_the_middle(self):
        for shape, area in SHEETS:
            corners, normals = self.build(shape)
            found = np.linalg.norm(areas(corners), axis=1).sum()
            self.assertLessEqual(found, area * (1 + 1e-12), shape)
            self.assertGreater(found, area * (1 - INSCRIBED), shape)
            self.fits(corners, normals, math.radians(2.0))
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
        corners, normals = triangles(field)
        area = areas(corners)
        np.testing.assert_allclose(area.sum(axis=0), 0, atol=1e-9)
        found = np.einsum("tc,tc->", corners[:, 0], area) / 3
        self.assertAlmostEqual(found, 20 * 12 * (1.0 + 0.15 + 0.25 + 2.0), places=6)
        # The first row is the +y edge, where it is highest; all normals are the faces'.
        self.assertEqual(corners[..., 2].max(), 1.8)
        self.fits(corners, normals, 1e-5)
        highest = corners.reshape(-1, 3)[corners[..., 2].argmax()]
        np.testing.assert_allclose(highest, (10, 6, 1.8))


if __name__ == "__main__":
    unittest.main()
