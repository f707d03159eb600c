# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files and Blender's objects: in, edited, out again."""

import math
import shutil
import tempfile
import tomllib
import unittest
from pathlib import Path

import bench
import bpy

SCENE = """\
# A ball and a mirror, to be edited.
name = "Ball on a mirror"

[viewpoint]
position = [0.0, 420.0, 692.8]          # 30 degrees above the ball's centre

[image]
position = [0.0, 20.0, 0.0]
size = [12.0, 12.0]

[plate]
position = [0.0, 244.0, -200.0]
size = [488.0, 488.0]
model = "slit-mirror"
pitch = 0.4                             # finer than usual

[display]
resolution = [640, 480]                 # it stands where it belongs
gamma = 2.2

# The ball stands on the table.
[[element]]
name = "ball"
shape = { kind = "sphere", radius = 20.0 }
position = [0.0, 20.0, 0.0]
material = { glass = "N-BK7" }          # with dispersion

# The table, turned up.
[[element]]
name = "table"
shape = { kind = "plane", size = [300.0, 400.0] }
rotation = [-90.0, 0.0, 0.0]
material = { mirror = true, reflectance = 0.95 }
"""


def comments(text):
    return [line.split("#", 1)[1] for line in text.splitlines() if "#" in line]


class Scenes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "scene.toml"

    def write(self, text):
        self.path.write_text(text, encoding="utf-8")
        return self.path

    def exported(self):
        target = Path(self.folder.name) / "out.toml"
        self.assertEqual(bpy.ops.export_scene.midair(filepath=str(target)), {"FINISHED"})
        return target.read_text(encoding="utf-8")

    def thing(self, name):
        return bpy.data.objects[name]

    def test_what_was_not_edited_comes_back_byte_by_byte(self):
        compared = 0
        for path in sorted(bench.SCENES.rglob("*.toml")):
            text = path.read_text(encoding="utf-8")
            if "bunny" in path.name:
                # Its mesh is not part of the repository.
                with self.assertRaisesRegex(RuntimeError, "bunny.ply"):
                    bench.imported(path)
                continue
            bench.imported(path)
            self.assertEqual(self.exported(), text, path)
            compared += 1
        self.assertGreater(compared, 10)

    def test_edits_are_written_by_their_paths_and_comments_stay(self):
        bench.imported(self.write(SCENE))
        self.thing("ball").location.x += 3.5
        self.thing("ball")["shape.radius"] = 21.0
        self.thing("table").rotation_euler.y = math.radians(4.0)
        self.thing("table")["material.reflectance"] = 0.9
        self.thing("Plate").scale.x = 300.0
        self.thing("Plate")["pitch"] = 0.3
        self.thing("Viewpoint").location = (10.0, 430.0, 650.0)
        self.thing("Image").scale = (14.0, 10.0, 1.0)
        text = self.exported()
        values = tomllib.loads(text)
        expected = tomllib.loads(SCENE)
        ball, table = expected["element"]
        ball["position"], ball["shape"]["radius"] = [3.5, 20.0, 0.0], 21.0
        table["rotation"], table["material"]["reflectance"] = [-90.0, 4.0, 0.0], 0.9
        expected["plate"]["size"], expected["plate"]["pitch"] = [300.0, 488.0], 0.3
        expected["viewpoint"]["position"] = [10.0, 430.0, 650.0]
        expected["image"]["size"] = [14.0, 10.0]
        self.assertEqual(values, expected)
        self.assertEqual(comments(text), comments(SCENE))
        # And what was written is read as it stands now.
        bench.imported(self.write(text))
        self.assertEqual(self.exported(), text)

    def test_things_have_their_size_in_millimetres_whatever_the_scene_s_unit(self):
        self.write(SCENE)
        compared = 0
        for metres in (1.0, 0.001, 0.0254):
            bench.empty()
            bpy.context.scene.unit_settings.scale_length = metres
            bpy.ops.import_scene.midair(filepath=str(self.path))
            ball = self.thing("ball")
            at = [ball.matrix_world @ vertex.co for vertex in ball.data.vertices]
            for axis, (low, high) in enumerate([(-20, 20), (-20, 20), (0, 40)]):
                # Blender's z is up: the ball stands on the table.
                found = [place[axis] * metres * 1000.0 for place in at]
                # Corners lie on the ball; those farthest along an axis within (pi / 192)^2 / 2 of it.
                self.assertAlmostEqual(min(found), low, delta=0.01)
                self.assertAlmostEqual(max(found), high, delta=0.01)
                compared += 1
            self.assertEqual(self.exported(), SCENE)
        self.assertEqual(compared, 9)

    def test_a_display_that_is_left_out_follows_and_one_that_is_moved_is_written(self):
        bench.imported(bench.SCENES / "paper" / "sphere.toml")
        display = self.thing("Display")
        # The image at the origin, mirrored in the plate at 45 degrees, 150 mm behind: (x, y, z) goes to (x, -150 - z, -150 - y).
        for got, expected in zip(display.location, (0.0, -150.0, -150.0)):
            self.assertAlmostEqual(got, expected, delta=1e-4)
        self.thing("Image").location.y += 5.0
        bpy.ops.midair.sync()
        for got, expected in zip(display.location, (0.0, -150.0, -155.0)):
            self.assertAlmostEqual(got, expected, delta=1e-4)
        self.assertNotIn("position", tomllib.loads(self.exported())["display"])
        display.location.x = 7.0
        values = tomllib.loads(self.exported())["display"]
        self.assertEqual(values["position"], [7.0, -150.0, -155.0])
        self.assertEqual(len(values["rotation"]), 3)

    def test_scaled_things_are_written_with_their_lengths(self):
        bench.imported(self.write(SCENE))
        ball, table = self.thing("ball"), self.thing("table")
        ball.scale = (1.1, 1.1, 1.1)
        table.scale.x = 0.5
        elements = tomllib.loads(self.exported())["element"]
        self.assertEqual(elements[0]["shape"]["radius"], 22.0)
        self.assertEqual(elements[1]["shape"]["size"], [150.0, 400.0])
        ball.scale.x = 2.0
        with self.assertRaisesRegex(RuntimeError, "a ball scaled by different factors is an ellipsoid"):
            self.exported()

    def test_elements_come_and_go(self):
        bench.imported(self.write(SCENE))
        ball = self.thing("ball")
        copy = ball.copy()
        copy.data = ball.data.copy()
        copy.name, copy.location = "second ball", (60.0, 20.0, 0.0)
        bpy.context.collection.objects.link(copy)
        self.assertEqual(bpy.ops.midair.add_element(kind="CUBE"), {"FINISHED"})
        self.thing("cube").location.z = -40.0
        names = [element["name"] for element in tomllib.loads(self.exported())["element"]]
        self.assertEqual(names, ["ball", "table", "second ball", "cube"])
        bpy.data.objects.remove(self.thing("table"))
        text = self.exported()
        elements = tomllib.loads(text)["element"]
        self.assertEqual([element["name"] for element in elements], ["ball", "second ball", "cube"])
        self.assertEqual(elements[2]["position"], [0.0, 0.0, -40.0])
        self.assertEqual(elements[1]["shape"], elements[0]["shape"])
        self.assertIn("# The ball stands on the table.", text)
        self.assertNotIn("# The table, turned up.", text)
        # What is left still follows edits, under its new number.
        self.thing("cube").location.z = -30.0
        self.assertEqual(tomllib.loads(self.exported())["element"][2]["position"], [0.0, 0.0, -30.0])

    def test_a_text_that_was_edited_is_built_anew(self):
        root = bench.imported(self.write(SCENE))
        root.location.x, root.midair.ray_count = 0.3, 5
        count = len(bpy.data.objects)
        text = root.midair.text
        text.from_string(SCENE.replace("radius = 20.0", "radius = 18.0").replace('"ball"', '"marble"'))
        self.assertEqual(bpy.ops.midair.reload(), {"FINISHED"})
        self.assertEqual(len(bpy.data.objects), count)
        marble = self.thing("marble")
        self.assertAlmostEqual(max(vertex.co.x for vertex in marble.data.vertices), 18.0, delta=0.01)
        root = marble.parent
        self.assertEqual(root.midair.ray_count, 5)
        self.assertEqual((root.name, round(root.location.x, 6)), ("Ball on a mirror", 0.3))
        self.assertEqual(self.exported(), SCENE.replace("radius = 20.0", "radius = 18.0").replace('"ball"', '"marble"'))
        # What is wrong is told, and the set-up stays.
        root.midair.text.from_string(SCENE.replace("sphere", "spere"))
        with self.assertRaisesRegex(RuntimeError, "sphere"):
            bpy.ops.midair.reload()
        self.assertEqual(len(bpy.data.objects), count)

    def test_a_set_up_from_scratch_is_a_scene(self):
        bench.empty()
        for kind in ("NONE", "BALL", "CUBE", "CYLINDER", "CONE"):
            bench.empty()
            self.assertEqual(bpy.ops.midair.add(element=kind), {"FINISHED"})
            path = self.write(self.exported())
            # The program reads it, and forms an image.
            shares = bench.program("check", path, "--out", self.path.with_suffix(".png"))
            self.assertGreater(shares["image"]["formed"], 0.9, kind)

    def test_meshes_go_in_and_out(self):
        (self.path.parent / "meshes").mkdir()
        shutil.copy(bench.SCENES / "meshes" / "spot.obj", self.path.parent / "meshes")
        bench.imported(self.write((bench.SCENES / "spot.toml").read_text()))
        spot = self.thing("spot")
        count = len(spot.data.vertices)
        self.assertGreater(count, 1000)
        shape = tomllib.loads(self.exported())["element"][0]["shape"]
        factor = shape.get("scale", 1.0)
        lines = (bench.SCENES / shape["file"]).read_text().splitlines()
        corners = [[float(x) * factor for x in line.split()[1:4]] for line in lines if line.startswith("v ")]
        self.assertEqual(count, len(corners))
        for vertex, corner in zip(spot.data.vertices, corners):
            # Single precision of some tens of millimetres.
            self.assertLess((vertex.co - vector(corner)).length, 1e-4)
        # Pushed somewhere, it is another mesh, in a file of its own.
        for vertex in spot.data.vertices:
            vertex.co.x += 2.0
        spot.data.update()
        shape = tomllib.loads(self.exported())["element"][0]["shape"]
        self.assertEqual((shape["file"], shape["scale"]), ("spot-blender.obj", 1.0))
        written = (Path(self.folder.name) / "spot-blender.obj").read_text().splitlines()
        written = [[float(x) for x in line.split()[1:4]] for line in written if line.startswith("v ")]
        self.assertEqual(len(written), count)
        for a, b in zip(written, corners):
            # Blender writes six decimals.
            self.assertLess(max(abs(a[0] - b[0] - 2.0), abs(a[1] - b[1]), abs(a[2] - b[2])), 1e-4)
        # It stands beside the scene; the file that it came from is as it was.
        original = (bench.SCENES / "meshes" / "spot.obj").read_bytes()
        self.assertEqual((self.path.parent / "meshes" / "spot.obj").read_bytes(), original)

    def test_a_mesh_of_blender_s_becomes_an_element(self):
        bench.imported(self.write(SCENE))
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.010, location=(0.05, 0.0, 0.02))
        thing = bpy.context.active_object
        thing.name = "drop"
        self.assertEqual(bpy.ops.midair.element_from_mesh(ior=1.33), {"FINISHED"})
        element = tomllib.loads(self.exported())["element"][2]
        self.assertEqual(element["shape"], {"kind": "mesh", "file": "drop-blender.obj"})
        # 50 mm to the right, 20 mm up: the scene file's y.
        for got, expected in zip(element["position"], (50.0, 20.0, 0.0)):
            self.assertAlmostEqual(got, expected, delta=1e-3)
        lines = (Path(self.folder.name) / "drop-blender.obj").read_text().splitlines()
        radii = [math.hypot(*map(float, line.split()[1:4])) for line in lines if line.startswith("v ")]
        self.assertTrue(radii and all(abs(radius - 10.0) < 1e-3 for radius in radii))

    def test_modifiers_and_scale_are_part_of_a_mesh(self):
        bench.imported(self.write(SCENE))
        bpy.ops.mesh.primitive_cube_add(size=0.020, location=(0.08, 0.0, 0.02))
        thing = bpy.context.active_object
        thing.name = "block"
        thing.modifiers.new("finer", "SUBSURF").levels = 1
        thing.modifiers["finer"].subdivision_type = "SIMPLE"
        bpy.ops.midair.element_from_mesh(ior=1.5)
        path = Path(self.folder.name) / "block-blender.obj"
        corners = lambda: [line for line in path.read_text().splitlines() if line.startswith("v ")]  # noqa: E731
        # A cube whose faces are quartered: 8 corners, 12 edges' middles, 6 faces' middles.
        self.assertEqual(len(corners()), 26)
        self.assertEqual(len(thing.data.vertices), 8)
        thing.scale = (2.0, 2.0, 2.0)
        self.assertEqual(tomllib.loads(self.exported())["element"][2]["shape"]["scale"], 2.0)
        for vertex in thing.data.vertices:
            vertex.co.z *= 0.5
        thing.data.update()
        shape = tomllib.loads(self.exported())["element"][2]["shape"]
        self.assertEqual((shape["file"], shape["scale"]), ("block-blender.obj", 2.0))
        tall = max(float(line.split()[3]) for line in corners())
        self.assertAlmostEqual(tall, 5.0, places=4)
        # Nothing was read back over it, and nothing is left to be written.
        self.assertEqual((len(thing.data.vertices), len(corners())), (8, 26))
        self.assertFalse(bench.module("meshes").is_edited(thing))
        thing.scale.x = 1.0
        with self.assertRaisesRegex(RuntimeError, "Apply > Scale"):
            self.exported()

    def test_errors_are_told_in_words(self):
        wrong = [
            (SCENE.replace("radius", "radios"), "radius"),
            (SCENE.replace("12.0, 12.0]", "12.0, 12.0"), r"\["),
            (SCENE.replace("[0.0, 420.0, 692.8]", "[0.0, 20.0, 5.0]"), "(?i)inside"),
        ]
        for text, words in wrong:
            bench.empty()
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.import_scene.midair(filepath=str(self.write(text)))
            # And nothing is left behind.
            self.assertEqual(len(bpy.data.objects), 0)
        with self.assertRaisesRegex(RuntimeError, "no.toml"):
            bpy.ops.import_scene.midair(filepath=str(self.path.with_name("no.toml")))
        with self.assertRaisesRegex(RuntimeError, "scene files that Blender edits are TOML"):
            bpy.ops.import_scene.midair(filepath=str(self.path.with_suffix(".json")))
        bench.imported(self.write(SCENE))
        self.thing("Viewpoint").location = (0.0, 20.0, 3.0)
        with self.assertRaisesRegex(RuntimeError, "(?i)inside"):
            self.exported()
        bpy.data.objects.remove(self.thing("Plate"))
        with self.assertRaisesRegex(RuntimeError, "the plate has been removed"):
            self.exported()


def vector(corner):
    from mathutils import Vector

    return Vector(corner)


if __name__ == "__main__":
    unittest.main()
