# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as a package: what is in it, under which licence, and that it can be disabled and enabled."""

import os
import tempfile
import tomllib
import unittest
import zipfile
from pathlib import Path

import bench
import bpy

NAME = "bl_ext.user_default.midair"


class Extension(unittest.TestCase):
    def test_midair_s_wheel_is_the_only_one_in_it(self):
        with zipfile.ZipFile(os.environ["MIDAIR_EXTENSION"]) as zipped:
            names = zipped.namelist()
            manifest = tomllib.loads(zipped.read("blender_manifest.toml").decode())
        wheels = [name for name in names if name.endswith(".whl")]
        self.assertEqual([f"./{name}" for name in wheels], manifest["wheels"])
        self.assertEqual(len(wheels), 1)
        self.assertTrue(wheels[0].startswith("wheels/midair-"))
        # It serves Blender's Pythons from 3.11 on.
        self.assertIn("abi3", wheels[0])
        self.assertFalse([name for name in names if "numpy" in name or "tests" in name])

    def test_its_midair_is_the_one_that_is_used(self):
        import midair

        self.assertIn(os.environ["BLENDER_USER_RESOURCES"], midair.__file__)

    def test_every_file_is_under_the_platform_s_licence(self):
        with zipfile.ZipFile(os.environ["MIDAIR_EXTENSION"]) as zipped:
            sources = [name for name in zipped.namelist() if name.endswith(".py")]
            for name in sources:
                head = zipped.read(name).decode().splitlines()[0]
                self.assertEqual(head, "# SPDX-License-Identifier: GPL-3.0-or-later", name)
            self.assertIn("GNU GENERAL PUBLIC LICENSE", zipped.read("LICENSE").decode())
        self.assertGreater(len(sources), 10)

    def test_it_is_disabled_without_a_trace_and_enabled_again(self):
        names = ("MIDAIR_PT_panel", "MIDAIR_OT_compensate", "MIDAIR_MT_add", "IMPORT_SCENE_OT_midair")
        known = lambda name: hasattr(bpy.types, name)  # noqa: E731
        self.assertTrue(all(map(known, names)))
        bpy.ops.preferences.addon_disable(module=NAME)
        self.assertFalse(any(map(known, names)))
        self.assertFalse(hasattr(bpy.types.Object, "midair"))
        bpy.ops.preferences.addon_enable(module=NAME)
        self.assertTrue(all(map(known, names)))

    def test_a_blend_file_has_the_whole_set_up(self):
        text = (bench.SCENES / "ball.toml").read_text()
        root = bench.imported(bench.SCENES / "ball.toml")
        bpy.ops.midair.compensate()
        bpy.data.objects["ball"].location.x = 1.5
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "set-up.blend")
            bpy.ops.wm.save_as_mainfile(filepath=path)
            bench.empty()
            bpy.ops.wm.open_mainfile(filepath=path)
            root = bpy.data.objects["Acrylic ball"]
            # The map is made again as the file is opened, of what stands there; the edit is written.
            image = bpy.data.objects["Display"].data.materials[0].node_tree.nodes["Mid-air map"].image
            self.assertEqual(tuple(image.size), (1024, 1024))
            self.assertGreater(sum(list(image.pixels)[3::4]), 100_000)
            now = root.midair.text.as_string()
            self.assertIn("position = [1.5, 0.0, 0.0]", now)
            self.assertEqual(now.splitlines()[0], text.splitlines()[0])


if __name__ == "__main__":
    unittest.main()
