# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera by which Cycles shows exactly the image."""

import unittest

import bench
import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

EYES = [(0.0, 0.0, 800.0), (120.0, -60.0, 500.0), (-90.0, 200.0, 650.0)]


class Camera(unittest.TestCase):
    def corners(self):
        """Where the image's corners are in the camera's picture, from its lower left: shares of width and height."""
        bpy.context.view_layer.update()
        scene, image = bpy.context.scene, bpy.data.objects["Image"]
        places = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
        return [
            world_to_camera_view(scene, scene.camera, image.matrix_world @ Vector((x, y, 0.0)))[:2] for x, y in places
        ]

    def test_the_picture_is_the_image_whatever_the_eye_the_image_and_the_unit(self):
        compared = 0
        for metres in (1.0, 0.001):
            for eye in EYES:
                bench.empty()
                bpy.context.scene.unit_settings.scale_length = metres
                self.assertEqual(bpy.ops.midair.add(element="BALL"), {"FINISHED"})
                bpy.data.objects["Viewpoint"].location = eye
                image = bpy.data.objects["Image"]
                image.scale = (28.0, 20.0, 1.0)
                image.location, image.rotation_euler = (3.0, -2.0, 4.0), (0.1, -0.15, 0.05)
                root = image.parent
                root.location, root.rotation_euler = (0.4, 0.2, 0.1), (1.2, 0.3, -0.4)
                self.assertEqual(bpy.ops.midair.sync(), {"FINISHED"})
                self.assertEqual(bpy.ops.midair.set_up_render(width=700), {"FINISHED"})
                self.assertEqual(bpy.context.scene.render.resolution_y, 500)
                for found, known in zip(self.corners(), [(0, 0), (1, 0), (1, 1), (0, 1)]):
                    for a, b in zip(found, known):
                        # Single precision: 1e-7 of eye distances of thirty image widths, a few operations.
                        self.assertAlmostEqual(a, b, delta=5e-5)
                        compared += 1
        self.assertEqual(compared, 2 * len(EYES) * 8)

    def test_solids_within_solids_are_named(self):
        render = bench.module("render")
        self.assertEqual(render.nested(bench.imported(bench.SCENES / "ball-on-mirror.toml")), [])
        root = bench.imported(bench.SCENES / "glass-of-water.toml")
        self.assertEqual(render.nested(root), ["air above the water", "glass", "water"])

    def test_an_eye_too_far_aside_is_told_in_words(self):
        bench.empty()
        bpy.ops.midair.add(element="NONE")
        bpy.data.objects["Viewpoint"].location = (400.0, 0.0, 300.0)
        bpy.ops.midair.sync()
        with self.assertRaisesRegex(RuntimeError, "more than ten image widths aside"):
            bpy.ops.midair.set_up_render()
        bpy.data.objects["Viewpoint"].location = (0.0, 0.0, -300.0)
        with self.assertRaisesRegex(RuntimeError, "behind"):
            bpy.ops.midair.set_up_render()


if __name__ == "__main__":
    unittest.main()
