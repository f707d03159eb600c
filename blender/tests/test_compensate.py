# SPDX-License-Identifier: GPL-3.0-or-later
"""Compensate, live, rays: what the display shows, and what is told of it."""

import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import bench
import bpy
import gpu
import numpy as np
from mathutils import Euler, Matrix, Vector


class Compensate(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = bench.imported(bench.SCENES / "ball.toml")
        self.root.midair.picture = bpy.data.images.load(bench.picture(self.folder.name))

    def material(self):
        return bpy.data.objects["Display"].data.materials[0].node_tree.nodes

    def map_pixels(self):
        """The map that the display's nodes look pictures up in, row 0 at the top."""
        image = self.material()["Mid-air map"].image
        width, height = image.size
        return np.array(image.pixels[:]).reshape(height, width, 4)[::-1]

    def test_the_map_that_the_display_has_is_midair_s(self):
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        folder = Path(self.folder.name) / "map"
        bench.program("compensate", bench.SCENES / "ball.toml", "--out", folder, "--format", "npy")
        own, known = self.map_pixels(), np.load(folder / "map.npy")
        answered = np.isfinite(known[..., 0])
        np.testing.assert_array_equal(own[..., 3] > 0.5, answered)
        # Single precision of numbers up to 1.
        np.testing.assert_allclose(own[answered][:, :2], known[answered][:, :2], atol=1e-6)
        # Beside the answers the map goes on smoothly: no step of more than a few pixels' worth.
        beside = ~answered & np.roll(answered, 1, axis=1)
        self.assertTrue(np.all(np.abs(own[beside][:, :2] - 0.5) < 0.6))

    def test_a_baked_picture_is_what_the_program_makes(self):
        self.root.midair.way = "BAKED"
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        node = self.material()["Mid-air picture"]
        baked = bench.codes(bench.save(node.image, Path(self.folder.name) / "baked.png"))
        folder = Path(self.folder.name) / "program"
        picture = Path(self.folder.name) / "lattice.png"
        bench.program("compensate", bench.SCENES / "ball.toml", "--image", picture, "--out", folder)
        known = bench.codes(folder / "display.png")
        self.assertEqual(baked.shape, known.shape)
        # Half a code of rounding on either side.
        self.assertLessEqual(int(np.abs(baked.astype(int) - known).max()), 1)

    def test_a_movie_plays_through_the_map(self):
        scene = bpy.context.scene
        movie = str(Path(self.folder.name) / "movie.mp4")
        self.film(movie)
        self.assertEqual(bpy.ops.midair.picture(filepath=movie), {"FINISHED"})
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        node = self.material()["Mid-air picture"]
        self.assertEqual(node.image.source, "MOVIE")
        self.assertTrue(node.image_user.use_auto_refresh)
        self.assertEqual(node.image_user.frame_duration, 3)
        means = []
        for frame in (1, 3):
            scene.frame_set(frame)
            means.append(bench.codes(bench.render(Path(self.folder.name) / "f.png", 16, 4)).mean())
        # A fifth of 255, and three fifths. The codec keeps even grey to a code or two.
        self.assertLess(abs(means[0] - 51), 4)
        self.assertLess(abs(means[1] - 153), 4)
        self.root.midair.way = "BAKED"
        with self.assertRaisesRegex(RuntimeError, "a movie is not baked here: show it through the map"):
            bpy.ops.midair.compensate()

    def film(self, path):
        """Three frames of even grey: codes of a fifth, two fifths and three fifths."""
        frames = b"".join(bytes([51 * number]) * 64 * 64 for number in (1, 2, 3))
        read = ["-f", "rawvideo", "-pixel_format", "gray", "-video_size", "64x64", "-framerate", "24", "-i", "-"]
        write = ["-pix_fmt", "yuv420p", "-c:v", "libx264", path]
        subprocess.run(["ffmpeg", "-v", "error", *read, *write], input=frames, check=True)

    def test_the_map_is_for_the_active_camera(self):
        other = bpy.data.objects.new("other", bpy.data.cameras.new("other"))
        bpy.context.collection.objects.link(other)
        # 60 mm to the right, 20 mm up, 750 mm in front, in Blender's axes and metres.
        other.location = (0.060, -0.750, 0.020)
        bpy.context.scene.camera = other
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        own = self.map_pixels()
        text = (bench.SCENES / "ball.toml").read_text().replace("[0.0, 0.0, 800.0]", "[60.0, 20.0, 750.0]")
        scene, folder = Path(self.folder.name) / "moved.toml", Path(self.folder.name) / "map"
        scene.write_text(text)
        bench.program("compensate", scene, "--out", folder, "--format", "npy")
        known = np.load(folder / "map.npy")
        both = np.isfinite(known[..., 0]) & (own[..., 3] > 0.5)
        self.assertGreater(both.mean(), 0.4)
        # The camera's place in single precision: 1e-7 of 0.75 m, as seen at the image of 28 mm.
        np.testing.assert_allclose(own[both][:, :2], known[both][:, :2], atol=1e-4)
        # The scene itself keeps its viewpoint.
        self.assertIn("position = [0.0, 0.0, 800.0]", self.root.midair.text.as_string())

    def test_live_is_coarse_while_things_move_and_full_when_they_rest(self):
        live = bench.module("live")
        self.root.midair.live = True
        watch = live.Watch()
        look = lambda now: watch.look(bpy.context, now).get(self.root.name)  # noqa: E731
        size = lambda: tuple(self.material()["Mid-air map"].image.size)  # noqa: E731
        self.assertEqual(look(0.0), "coarse")
        self.assertEqual(size(), (256, 256))
        self.assertIsNone(look(0.1))
        bpy.data.objects["ball"].location.x = 1.0
        self.assertEqual(look(0.2), "coarse")
        self.assertIn("[1.0, 0.0, 0.0]", self.root.midair.text.as_string())
        bpy.data.objects["ball"].location.x = 2.0
        self.assertEqual(look(0.4), "coarse")
        self.assertIsNone(look(0.6))
        self.assertEqual(look(0.8), "full")
        self.assertEqual(size(), (1024, 1024))
        self.assertIsNone(look(5.0))
        before = self.map_pixels()
        bpy.data.objects["Viewpoint"].location.x = 30.0
        self.assertEqual(look(6.0), "coarse")
        self.assertEqual(look(7.0), "full")
        self.assertGreater(np.abs(self.map_pixels() - before).max(), 1e-3)
        # What cannot be is told, and the display keeps what it shows.
        bpy.data.objects["Viewpoint"].location = (0.0, 0.0, 3.0)
        self.assertEqual(look(8.0), "failed")
        self.assertRegex(self.root.midair.said, "(?i)inside")
        self.assertIsNone(look(9.0))
        bpy.data.objects["Viewpoint"].location = (0.0, 0.0, 800.0)
        self.assertEqual(look(10.0), "coarse")
        self.assertEqual(self.root.midair.said, "")

    def test_the_status_is_in_words(self):
        self.assertEqual(bpy.ops.midair.compensate(), {"FINISHED"})
        self.assertEqual(self.root.midair.formed, 1.0)
        self.assertTrue(any("display's 1024 x 1024 pixels" in f.sentence for f in self.root.midair.findings))
        # Too small a display: a part of the image is not formed, and what helps is said.
        bpy.data.objects["Display"].scale = (20.0, 20.0, 1.0)
        bpy.ops.midair.compensate()
        told = bench.program("check", self.saved(), "--out", Path(self.folder.name) / "check.png")
        self.assertAlmostEqual(self.root.midair.formed, told["image"]["formed"], places=6)
        self.assertLess(self.root.midair.formed, 0.6)
        own = [(f.severity, f.sentence, f.remedy) for f in self.root.midair.findings]
        for finding in told["findings"]:
            self.assertIn((finding["severity"], finding["sentence"], finding["remedy"] or ""), own)
        self.assertTrue(any(remedy for _, _, remedy in own))

    def saved(self):
        path = str(Path(self.folder.name) / "now.toml")
        bpy.ops.export_scene.midair(filepath=path)
        return path

    def test_rays_go_from_the_viewpoint_to_the_display_by_way_of_ball_and_plate(self):
        rays = bench.module("rays")
        self.root.midair.ray_count = 3
        points, colours = rays.segments(bpy.context, self.root)
        self.assertEqual(len(points), len(colours))
        # Viewpoint, into the ball, out of it, plate, display: four pieces for each of nine rays, all formed.
        self.assertEqual(len(points), 9 * 4 * 2)
        self.assertEqual(set(colours), {rays.COLOURS["ok"]})
        eye, display = bpy.data.objects["Viewpoint"], bpy.data.objects["Display"]
        back = display.matrix_world.inverted()
        for ray in range(9):
            piece = points[8 * ray : 8 * ray + 8]
            self.assertLess((eye.matrix_world.translation - vector(piece[0])).length, 1e-6)
            # 25 mm from the ball's centre, twice; metres in single precision.
            for place in (piece[1], piece[3]):
                self.assertAlmostEqual(vector(place).length, 0.025, delta=1e-6)
            end = back @ vector(piece[7])
            self.assertTrue(abs(end.x) <= 0.5 and abs(end.y) <= 0.5)
            # The display's z is in millimetres.
            self.assertLess(abs(end.z), 1e-3)

    @unittest.skipUnless(hasattr(gpu, "init"), "this Blender draws nothing without a window; 5.x does")
    def test_rays_are_drawn(self):
        gpu.init()
        rays = bench.module("rays")
        self.root.midair.show_rays, self.root.midair.ray_count = True, 3
        camera = bpy.data.objects.new("aside", bpy.data.cameras.new("aside"))
        bpy.context.collection.objects.link(camera)
        # From the right, all of it in the picture; the viewpoint's camera stays the active one.
        camera.matrix_world = (
            Matrix.Translation((2.0, -0.3, 0.0)) @ Euler((math.pi / 2, 0.0, math.pi / 2)).to_matrix().to_4x4()
        )
        bpy.context.view_layer.update()
        size = (400, 200)
        view = camera.matrix_world.inverted()
        projection = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=size[0], y=size[1])
        target = gpu.types.GPUOffScreen(*size)
        with target.bind():
            buffer = gpu.state.active_framebuffer_get()
            buffer.clear(color=(0.0, 0.0, 0.0, 1.0), depth=1.0)
            with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
                gpu.matrix.load_matrix(view)
                gpu.matrix.load_projection_matrix(projection)
                rays.draw()
            seen = np.array(buffer.read_color(0, 0, *size, 4, 0, "UBYTE").to_list()).reshape(size[1], size[0], 4)
        target.free()
        points, _ = rays.segments(bpy.context, self.root)
        drawn = 0
        for a, b in zip(points[::2], points[1::2]):
            middle = projection @ view @ ((vector(a) + vector(b)) / 2).to_4d()
            x, y = ((middle[k] / middle.w + 1) / 2 * size[k] for k in (0, 1))
            if 2 <= x < size[0] - 2 and 2 <= y < size[1] - 2:
                near = seen[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2]
                # A line one and a half pixels wide goes through, green on black.
                self.assertGreater(near[..., 1].max(), 120)
                self.assertLess(near[..., 2].max(), 120)
                drawn += 1
        self.assertGreater(drawn, len(points) // 2 * 2 // 3)
        # And most of the picture is empty.
        self.assertLess((seen[..., 1] > 60).mean(), 0.2)
        if os.environ.get("MIDAIR_PICTURES"):
            bench.keep([seen[::-1, :, :3].astype(np.uint8)], "blender-rays.png")


def vector(place):
    return Vector(place)


if __name__ == "__main__":
    unittest.main()
