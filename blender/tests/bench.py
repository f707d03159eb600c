# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests share: Blender with the extension installed, scenes, pictures, and what they are held against."""

import contextlib
import importlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "scenes"


def install(folder):
    """Installs the .zip into a Blender without any of the user's files, and enables it."""
    os.environ["BLENDER_USER_RESOURCES"] = folder
    import bpy

    zipped = os.environ["MIDAIR_EXTENSION"]
    bpy.ops.preferences.addon_enable(module="bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=zipped, repo="user_default", enable_on_install=True)
    assert hasattr(bpy.types, "MIDAIR_PT_panel"), "the extension was not installed and enabled"


def module(name):
    """A module of the installed extension."""
    return importlib.import_module(f"bl_ext.user_default.midair.{name}")


def empty():
    """An empty file in Blender, the extension enabled."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def imported(path):
    """A scene file in an empty Blender: the set-up's frame."""
    import bpy

    empty()
    outcome = bpy.ops.import_scene.midair(filepath=str(path))
    assert outcome == {"FINISHED"}
    return bpy.context.view_layer.objects.active


def picture(folder, size=384):
    """A lattice of 7 x 7 lines on a ground that goes from dark to less dark, as a PNG: lines to be measured, tones to be compared."""
    import bpy
    import numpy as np

    across = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(across, across)
    pixels = np.ones((size, size, 4), np.float32)
    ground = 0.10 + 0.06 * np.sin(9 * x + 4 * y) + 0.05 * np.cos(13 * y - 3 * x)
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = ground, 0.8 * ground, 1.3 * ground
    for axis in (x, y):
        place = axis * 7
        on_line = np.abs(place - np.floor(place) - 0.5) < 0.07
        pixels[on_line] = (1.0, 1.0, 0.1, 1.0)
    image = bpy.data.images.new("lattice", size, size)
    image.pixels.foreach_set(pixels[::-1].ravel())
    path = str(Path(folder) / "lattice.png")
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


@contextlib.contextmanager
def quiet():
    """Blender tells each step of a render on standard output, past Python."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def render(path, width=256, samples=32):
    """What Cycles shows, by the add-on's settings, as a PNG."""
    import bpy

    assert bpy.ops.midair.set_up_render(width=width, samples=samples) == {"FINISHED"}
    bpy.context.scene.render.filepath = str(path)
    bpy.context.scene.render.image_settings.file_format = "PNG"
    with quiet():
        bpy.ops.render.render(write_still=True)
    return str(path)


def save(image, path):
    """An image of Blender's as a PNG with its own codes."""
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    return str(path)


def codes(path):
    """A picture file's codes: height x width x 3, row 0 at the top."""
    import bpy
    import numpy as np

    image = bpy.data.images.load(str(path), check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.array(image.pixels[:], np.float32).reshape(height, width, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return np.rint(pixels * 255.0).astype(np.uint8)


def program(*arguments):
    """Runs midair; what it tells, as data."""
    command = [os.environ["MIDAIR_PROGRAM"], "--json", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stderr}"
    return json.loads(done.stdout)


def displacement(seen, expected):
    """How far each crossing of the lattice in a picture is from where another has it, px."""
    with tempfile.TemporaryDirectory() as folder:
        return program("measure", "lattice", seen, "--against", expected, "--out", folder)["against"]


SIMILARITY = """
import sys
from skimage import io
from skimage.metrics import structural_similarity
a, b = (io.imread(path)[..., :3] for path in sys.argv[1:])
print(structural_similarity(a, b, channel_axis=2, gaussian_weights=True, sigma=1.5, use_sample_covariance=False))
"""


def similarity(a, b):
    """SSIM of two pictures (Wang et al. 2004), by scikit-image."""
    command = [os.environ["MIDAIR_PEERS_PYTHON"], "-c", SIMILARITY, str(a), str(b)]
    return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def keep(pictures, name):
    """Sets pictures side by side in the folder for pictures, if there is one."""
    folder = os.environ.get("MIDAIR_PICTURES")
    if not folder:
        return
    import bpy
    import numpy as np

    arrays = [codes(path) if isinstance(path, (str, Path)) else path for path in pictures]
    gap = np.full((arrays[0].shape[0], 8, 3), 255, np.uint8)
    row = np.concatenate([part for array in arrays for part in (gap, array)][1:], axis=1)
    height, width = row.shape[:2]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = row / 255.0
    image = bpy.data.images.new("row", width, height)
    image.pixels.foreach_set(np.ascontiguousarray(pixels[::-1]).ravel())
    save(image, Path(folder) / name)
    bpy.data.images.remove(image)
