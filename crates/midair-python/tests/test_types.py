"""The types that are told are those that are there."""

import importlib.resources
import os
import subprocess
import sys
from pathlib import Path

import midair

PROJECT = Path(__file__).parents[1] / "pyproject.toml"


def run(cache, *command):
    done = subprocess.run(
        [sys.executable, "-m", *command],
        capture_output=True,
        text=True,
        check=False,
        cwd=PROJECT.parent,
        env={**os.environ, "MYPY_CACHE_DIR": str(cache)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_stubs_are_the_module_s(tmp_path):
    assert "Success" in run(tmp_path, "mypy.stubtest", "midair._core", "--mypy-config-file", str(PROJECT))


#: What mypy must not let through is marked; a mark where there is nothing wrong is an error as well.
USE = """
import numpy as np
import midair

scene = midair.Scene("cube.toml")
found = scene.map(resolution=(64, 64))
uv: np.ndarray = found.uv
bound: float = found.error_bound
display = found.apply(np.zeros((4, 4, 3), np.uint8), optimal=True)
view = scene.view(display, eye=(60, 0, 800), size=(512, 512))
st: bytes = scene.forward(b"")
scene["viewpoint.position.x"] = 3
remedies: list[str | None] = [finding.remedy for finding in scene.check().findings]
scene.map(method="guess")  # type: ignore[arg-type]
scene.view(display, 3)  # type: ignore[call-arg, arg-type]
found.uv = uv  # type: ignore[misc]
"""


def test_the_package_and_its_use_are_typed(tmp_path):
    use = tmp_path / "use.py"
    use.write_text(USE)
    package = importlib.resources.files(midair)
    run(tmp_path, "mypy", "--config-file", str(PROJECT), "--strict", str(package), str(use))


def test_the_package_says_that_it_is_typed():
    assert importlib.resources.files(midair).joinpath("py.typed").is_file()
