# SPDX-License-Identifier: GPL-3.0-or-later
"""The plate's node groups, ray by ray: which way light goes on, how often, and how much of it."""

import math
import tempfile
import unittest
from pathlib import Path

import bench
import bpy
import numpy as np

SIZE, SAMPLES = 32, 32

# Degrees of incidence and of azimuth from local +x.
DIRECTIONS = [(20.0, 0.0), (35.0, 25.0), (48.0, 0.0), (60.0, 70.0), (48.0, 180.0)]

AZIMUTH, IOR, RATIO = 45.0, 1.52, 1.25 / 0.5


def unit(incidence, azimuth):
    """A direction of travel in the plate's frame, towards its -z side."""
    i, a = math.radians(incidence), math.radians(azimuth)
    return np.array([math.sin(i) * math.cos(a), math.sin(i) * math.sin(a), -math.cos(i)])


def across(d):
    """Components across layer 0's mirrors and layer 1's."""
    s, c = math.sin(math.radians(AZIMUTH)), math.cos(math.radians(AZIMUTH))
    return np.array([d[1] * c - d[0] * s, d[0] * c + d[1] * s])


def turned(d, odd):
    """A direction after it was turned back across the layers that are odd."""
    s, c = math.sin(math.radians(AZIMUTH)), math.cos(math.radians(AZIMUTH))
    a, b = across(d) * np.where(odd, -1, 1)
    return np.array([b * c - a * s, a * c + b * s, d[2]])


def odd_shares(d):
    """The closed form (Kiuchi and Koizumi 2021): of a layer's light, what meets an odd number of mirrors is a triangle wave of the mean
    number."""
    cos_t = math.sqrt(1 - (1 - d[2] ** 2) / IOR**2)
    mean = RATIO * np.abs(across(d)) / (IOR * cos_t)
    return np.arccos(np.cos(math.pi * mean)) / math.pi


def faces(d):
    """What two faces of glass transmit, unpolarised: by the reflectances of Fresnel's equations in sines and tangents."""
    i = math.acos(abs(d[2]))
    t = math.asin(math.sin(i) / IOR)
    s = (math.sin(i - t) / math.sin(i + t)) ** 2
    p = (math.tan(i - t) / math.tan(i + t)) ** 2
    return (1 - (s + p) / 2) ** 2


class Bench:
    """A plate alone under a camera with parallel rays; light comes from one direction only, so that a render's mean is the share that goes
    there."""

    def __init__(self, values, size=200.0):
        bench.empty()
        plate, shapes = bench.module("plate"), bench.module("shapes")
        mesh = bpy.data.meshes.new("plate")
        shapes.rectangle(mesh)
        self.plate = bpy.data.objects.new("plate", mesh)
        mesh.materials.append(plate.material("plate", values))
        scene = bpy.context.scene
        scene.collection.objects.link(self.plate)
        # A unit of the scene is a metre; the plate lies aslant somewhere.
        self.plate.scale = (0.001 * size, 0.001 * size, 0.001)
        self.plate.rotation_euler = (0.7, -0.4, 1.1)
        self.plate.location = (0.3, -0.2, 0.5)
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale, camera.clip_start = "ORTHO", 0.02, 1e-4
        self.camera = bpy.data.objects.new("camera", camera)
        scene.collection.objects.link(self.camera)
        scene.camera = self.camera
        scene.render.engine = "CYCLES"
        scene.render.resolution_x = scene.render.resolution_y = SIZE
        scene.cycles.samples = SAMPLES
        scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
        scene.view_settings.view_transform = "Raw"
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        self.light()

    def light(self):
        """A world that is lit in three directions, one for each colour."""
        world = bpy.context.scene.world = bpy.data.worlds.new("World")
        world.use_nodes = True
        # Rays find the light; no map of where it comes from is needed.
        world.cycles.sampling_method = "NONE"
        tree = world.node_tree
        tree.nodes.clear()
        incoming = tree.nodes.new("ShaderNodeNewGeometry").outputs["Incoming"]
        colours = tree.nodes.new("ShaderNodeCombineXYZ")
        self.towards = []
        for channel in range(3):
            dot = tree.nodes.new("ShaderNodeVectorMath")
            dot.operation = "DOT_PRODUCT"
            lit = tree.nodes.new("ShaderNodeMath")
            lit.operation = "LESS_THAN"
            # Incoming points back along the ray. Within a degree.
            lit.inputs[1].default_value = -math.cos(math.radians(1.0))
            tree.links.new(incoming, dot.inputs[0])
            tree.links.new(dot.outputs["Value"], lit.inputs[0])
            tree.links.new(lit.outputs[0], colours.inputs[channel])
            self.towards.append(dot.inputs[1])
        background = tree.nodes.new("ShaderNodeBackground")
        out = tree.nodes.new("ShaderNodeOutputWorld")
        tree.links.new(colours.outputs[0], background.inputs["Color"])
        tree.links.new(background.outputs[0], out.inputs["Surface"])

    def shares(self, d, towards):
        """Of light that travels along d (plate's frame), how much goes on in each of three directions."""
        from mathutils import Vector

        bpy.context.view_layer.update()
        turn = self.plate.matrix_world.to_quaternion()
        travel = turn @ Vector(d)
        self.camera.rotation_euler = travel.to_track_quat("-Z", "Y").to_euler()
        self.camera.location = Vector(self.plate.location) - 0.1 * travel
        for socket, direction in zip(self.towards, towards):
            socket.default_value = turn @ Vector(direction)
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "shares.exr")
            bpy.context.scene.render.filepath = path
            with bench.quiet():
                bpy.ops.render.render(write_still=True)
            image = bpy.data.images.load(path)
            image.colorspace_settings.name = "Non-Color"
            pixels = np.array(image.pixels[:]).reshape(-1, 4)[:, :3]
            bpy.data.images.remove(image)
        return pixels.mean(axis=0)


class Plate(unittest.TestCase):
    def test_an_ideal_plate_keeps_what_is_along_its_normal_and_turns_the_rest_back(self):
        stand = Bench({"model": "ideal"})
        compared = 0
        for incidence, azimuth in DIRECTIONS:
            d = unit(incidence, azimuth)
            for side in (1, -1):
                travel = side * d
                mirrored = travel * (-1, -1, 1)
                shares = stand.shares(travel, [mirrored, travel, -travel])
                # Without loss, and to nowhere else: float arithmetic within a degree.
                np.testing.assert_allclose(shares, [1, 0, 0], atol=1e-5)
                compared += 1
        self.assertEqual(compared, 2 * len(DIRECTIONS))

    def test_slit_mirrors_share_light_out_as_the_closed_form_says(self):
        stand = Bench({"model": "slit-mirror", "reflectance": 1.0})
        compared = 0
        for incidence, azimuth in DIRECTIONS:
            for side in (1, -1):
                d = side * unit(incidence, azimuth)
                first, second = odd_shares(d)
                kinds = [(True, True), (True, False), (False, True)]
                shares = stand.shares(d, [turned(d, odd) for odd in kinds]) / faces(d)
                expected = [(first if a else 1 - first) * (second if b else 1 - second) for a, b in kinds]
                # 32 x 32 x 32 draws: a standard error below sqrt(0.25 / 32768) = 0.003.
                np.testing.assert_allclose(shares, expected, atol=0.02)
                compared += 3
        self.assertEqual(compared, 6 * len(DIRECTIONS))

    def test_each_mirror_and_the_glass_take_their_share(self):
        reflectance, absorption = [0.9, 0.7, 0.5], [0.0, 0.01, 0.05]
        stand = Bench({"model": "slit-mirror", "reflectance": reflectance, "glass_absorption": absorption})
        # One mirror in each layer, for certain: tan t = sqrt(2) / 2.5 in the glass.
        slope = math.sqrt(2) / RATIO
        sine = IOR * slope / math.hypot(slope, 1)
        d = np.array([sine, 0.0, -math.sqrt(1 - sine**2)])
        shares = stand.shares(d, [turned(d, (True, True))] * 3)
        length = 2 * (1.25 + 0.75) * math.hypot(slope, 1)
        expected = faces(d) * np.square(reflectance) * np.exp(-length * np.array(absorption))
        # The corner of the triangle wave is met to rounding: of some draws in ten thousand the number of mirrors is another.
        np.testing.assert_allclose(shares, expected, atol=1e-3)

    def test_thick_mirrors_stop_light_at_their_ends(self):
        values = {"model": "slit-mirror", "reflectance": 1.0, "mirror_thickness": 0.1, "layer_depth": 1.0}
        stand = Bench(values)
        d = unit(35.0, 25.0)
        # Depth over clear width is as before: shares are the thin mirrors', of what the ends leave open.
        open_share = (1 - 0.1 / 0.5) ** 2
        first, second = odd_shares(d)
        shares = stand.shares(d, [turned(d, (True, True)), turned(d, (True, False)), turned(d, (False, False))])
        expected = np.array([first * second, first * (1 - second), (1 - first) * (1 - second)])
        np.testing.assert_allclose(shares, expected * open_share * faces(d), atol=0.02)


if __name__ == "__main__":
    unittest.main()
