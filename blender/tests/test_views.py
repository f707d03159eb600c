# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles shows, held to midair's own views: ball, cube and bent mirror at 256 x 256."""

import os
import tempfile
import unittest
from pathlib import Path

import bench
import bpy

# The cube's display is a little larger than the paper's, so that all of the image is formed.
CUBE = ("size = [30.0, 30.0]\n\n[[element]]", "size = [32.0, 32.0]\n\n[[element]]")


class Views(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.picture = bench.picture(self.folder.name)

    def at(self, name):
        return Path(self.folder.name) / name

    def compare(self, name, scene, lines=49):
        """The compensated display, seen by Cycles and by midair."""
        text = (bench.SCENES / scene).read_text()
        if name == "cube":
            self.assertIn(CUBE[0], text)
            text = text.replace(*CUBE)
        path = self.at(f"{name}.toml")
        path.write_text(text)
        root = bench.imported(path)
        root.midair.picture = bpy.data.images.load(self.picture)
        root.midair.way = "BAKED"
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        shown = bpy.data.images[f"{root.name} display"]
        display = bench.save(shown, self.at("display.png"))
        seen, known = self.at("seen.png"), self.at("known.png")
        bench.render(seen)
        bench.program("view", path, "--display", display, "--out", known, "--size", "256x256")
        moved = bench.displacement(seen, known)
        similar = bench.similarity(seen, known)
        print(f"{name}: lattice {moved}, SSIM {similar:.4f}")
        self.assertEqual(moved["compared"], lines)
        self.assertLessEqual(moved["mean"], 0.3)
        self.assertGreaterEqual(similar, 0.97)
        return root, display, seen, known

    def test_ball(self):
        root, display, seen, known = self.compare("ball", "ball.toml")
        if os.environ.get("MIDAIR_PICTURES"):
            bpy.ops.midair.uncompensated()
            plain = bench.render(self.at("plain.png"))
            bpy.ops.midair.compensate()
            bench.keep([plain, seen, known], "blender-ball.png")
            plate = bpy.data.objects["Plate"]
            plate["model"] = "slit-mirror"
            bpy.ops.midair.sync()
            real = bench.render(self.at("real.png"), samples=256)
            bench.keep([seen, real], "blender-plates.png")
        # Through the map instead: the undistorted picture again.
        root.midair.way = "MAP"
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        bench.render(self.at("through.png"))
        moved = bench.displacement(self.at("through.png"), self.picture_at(256))
        self.assertEqual(moved["compared"], 49)
        self.assertLessEqual(moved["mean"], 0.3)

    def picture_at(self, size):
        image = bpy.data.images.load(self.picture, check_existing=False)
        image.scale(size, size)
        return bench.save(image, self.at("picture.png"))

    def test_cube(self):
        self.compare("cube", "paper/cube.toml")

    def test_bent_mirror(self):
        self.compare("bent-mirror", "paper/bent-mirror-convex.toml")


if __name__ == "__main__":
    unittest.main()
