# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles shows, held to midair's own views: ball, cube and bent mirror at 256 x 256."""

import os
import tempfile
import unittest
from pathlib import Path

import bench
import bpy
import numpy as np
import overview

# The cube's display is a little larger than the paper's, so that all of the image is formed.
CUBE = ("size = [30.0, 30.0]\n\n[[element]]", "size = [32.0, 32.0]\n\n[[element]]")


def light(codes):
    """sRGB codes as linear light (IEC 61966-2-1)."""
    value = codes / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


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
        print(f"{name}: lattice {moved['mean']:.4f} px in the mean, {moved['max']:.4f} at most; SSIM {similar:.4f}")
        self.assertEqual(moved["compared"], lines)
        self.assertLessEqual(moved["mean"], 0.3)
        self.assertGreaterEqual(similar, 0.97)
        return root, display, seen, known

    def test_ball(self):
        root, _, seen, known = self.compare("ball", "ball.toml")
        if os.environ.get("MIDAIR_PICTURES"):
            bpy.ops.midair.uncompensated()
            bench.keep([bench.render(self.at("plain.png")), seen, known], "blender-ball.png")
            bpy.ops.midair.compensate()
            overview.render(root, self.at("overview.png"))
            bench.keep([self.at("overview.png")], "blender-set-up.png")
            root = bench.imported(self.at("ball.toml"))
            root.midair.picture = bpy.data.images.load(self.picture)
        # Through the map instead: the undistorted picture again.
        root.midair.way = "MAP"
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        bench.render(self.at("through.png"))
        moved = bench.displacement(self.at("through.png"), self.picture_at(256))
        self.assertEqual(moved["compared"], 49)
        self.assertLessEqual(moved["mean"], 0.3)

    def test_slit_mirror_plate(self):
        """A bare plate as the scene has it: what is drawn at random by Cycles, and mirror by mirror by midair."""
        root = bench.imported(bench.SCENES / "plate.toml")
        root.midair.picture = bpy.data.images.load(self.picture)
        root.midair.way = "BAKED"
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        display = bench.save(bpy.data.images[f"{root.name} display"], self.at("display.png"))
        seen, known = self.at("seen.png"), self.at("known.png")
        bench.render(seen, 128, 64)
        # A pupil of 4 mm averages over the slits, as the draws do.
        options = ["--display", display, "--size", "128x128", "--spp", "64", "--aperture", "4", "--exposure", "1"]
        bench.program("view", bench.SCENES / "plate.toml", *options, "--out", known)
        # As luminance: at edges Cycles takes the mean of codes and midair that of light, which shows in the dark blue between lines.
        a, b = (light(bench.codes(path)) @ (0.2126, 0.7152, 0.0722) for path in (seen, known))
        # Noise: 128 x 128 pixels of 64 paths each, of which some tens of per cent arrive, leave 0.2 % of the mean.
        np.testing.assert_allclose(a.mean(), b.mean(), rtol=0.02)
        # And place by place, over squares of 16 x 16 pixels: there noise is 3 %.
        a, b = (part.reshape(8, 16, 8, 16).mean(axis=(1, 3)) for part in (a, b))
        np.testing.assert_allclose(a, b, atol=0.05 * b.max())
        if os.environ.get("MIDAIR_PICTURES"):
            ideal = self.ideal(root)
            bench.keep([ideal, bench.render(self.at("real.png"), 256, 128)], "blender-plates.png")

    def ideal(self, root):
        """The same, but for the plate's model."""
        bpy.data.objects["Plate"]["model"] = "ideal"
        bpy.ops.midair.sync()
        path = bench.render(self.at("ideal.png"))
        bpy.data.objects["Plate"]["model"] = "slit-mirror"
        bpy.ops.midair.sync()
        return path

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
