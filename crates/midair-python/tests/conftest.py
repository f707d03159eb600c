"""What the tests share: scenes, and where the program is."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import midair

SCENES = Path(__file__).parents[3] / "scenes"

#: An eye 800 mm before an image 20 x 20; the plate leans behind it; nothing in the way.
BARE = """\
name = "bare"
[viewpoint]
position = [0.0, 0.0, 800.0]
[image]
size = [20.0, 20.0]
[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]
[display]
resolution = [64, 64]
"""
BALL = (
    BARE.replace("bare", "ball")
    + """
[[element]]
name = "ball"
shape = { kind = "sphere", radius = 25.0 }
material = { ior = 1.49 }
"""
)
#: Seen from so far off that lines of sight are parallel to a part in a million.
SLAB = (
    BARE.replace("bare", "slab").replace("800.0]", "1e6]").replace("[display]", "[display]\nsize = [60.0, 60.0]")
    + """
[[element]]
name = "slab"
shape = { kind = "box", size = [200.0, 200.0, 50.0] }
rotation = [0.0, 15.8, 0.0]
material = { ior = 1.49 }
"""
)


@pytest.fixture
def bare() -> midair.Scene:
    return midair.Scene(BARE)


@pytest.fixture
def ball() -> midair.Scene:
    return midair.Scene(BALL)


@pytest.fixture
def slab() -> midair.Scene:
    return midair.Scene(SLAB)


@pytest.fixture
def picture() -> np.ndarray:
    """Smooth, of three different colours, 48 x 40 pixels, uint8."""
    y, x = np.mgrid[0:40, 0:48] / 48.0
    waves = [np.sin(7 * x), np.cos(5 * y), np.sin(6 * (x + y))]
    return np.round(127.5 + 100.0 * np.stack(waves, axis=-1)).astype(np.uint8)


@pytest.fixture(scope="session")
def program():
    """Runs the program in a folder; what it does not do is an error."""
    path = os.environ.get("MIDAIR_PROGRAM")
    assert path and Path(path).exists(), "MIDAIR_PROGRAM names no program: run `cargo xtask test --only python`"

    def run(*arguments: str, cwd: Path) -> str:
        done = subprocess.run([path, *arguments], cwd=cwd, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def grid(n: int) -> np.ndarray:
    """n x n image points at pixel centres, row 0 at the top."""
    centres = (np.arange(n) + 0.5) / n
    u, v = np.meshgrid(centres, centres[::-1])
    return np.stack([u, v], axis=-1)
