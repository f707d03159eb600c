"""The types that are told are those that are there."""

import importlib.resources
import subprocess
import sys
from pathlib import Path

import midair

PROJECT = Path(__file__).parents[1] / "pyproject.toml"


def run(*command):
    done = subprocess.run(
        [sys.executable, "-m", *command], capture_output=True, text=True, check=False, cwd=PROJECT.parent
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_stubs_are_the_module_s():
    assert "Success" in run("mypy.stubtest", "midair", "--mypy-config-file", str(PROJECT))


def test_the_package_and_its_use_are_typed(tmp_path):
    use = tmp_path / "use.py"
    use.write_text(
        "import numpy as np\nimport midair\n"
        "scene = midair.Scene('cube.toml')\n"
        "found = scene.map(resolution=(64, 64))\n"
        "uv: np.ndarray = found.uv\n"
        "bound: float = found.error_bound\n"
        "display = found.apply(np.zeros((4, 4, 3), np.uint8), optimal=True)\n"
        "view = scene.view(display, eye=(60, 0, 800), size=(512, 512))\n"
        "st: bytes = scene.forward(b'')\n"
        "scene['viewpoint.position.x'] = 3\n"
        "remedies: list[str | None] = [finding.remedy for finding in scene.check().findings]\n"
    )
    package = importlib.resources.files(midair)
    run("mypy", "--config-file", str(PROJECT), "--strict", str(package), str(use))
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import midair\nmidair.Scene('a').map(method='guess')\nmidair.Scene('a').view(1, 2)\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", str(PROJECT), str(wrong)],
        capture_output=True, text=True, check=False, cwd=PROJECT.parent,
    )
    assert "guess" in done.stdout and "Found 2 errors" in done.stdout, done.stdout


def test_the_package_says_that_it_is_typed():
    assert importlib.resources.files(midair).joinpath("py.typed").is_file()
