"""What programs that have no numpy need: scenes, maps, F and findings, as bytes."""

import subprocess
import sys

from conftest import BALL

import midair

WITHOUT = f"""
import sys
sys.modules["numpy"] = None     # As if it were not installed.
import array, midair

scene = midair.Scene({BALL!r})
scene["viewpoint.position.y"] = 20.0
found = scene.map(resolution=(40, 30))
assert (found.resolution, found.counts["ok"] > 500) == ((40, 30), True)
uv = array.array("d", found.uv_bytes())
status = found.status_bytes()
assert len(uv) == 2 * 40 * 30 and len(status) == 40 * 30
st = array.array("d", scene.forward(array.array("d", [0.5, 0.5, 0.25, 0.75]).tobytes()))
assert len(st) == 4 and all(0 < x < 1 for x in st)
pixel = 15 * 40 + 20
assert status[pixel] == midair.Status.OK
back = array.array("d", scene.forward(uv[2 * pixel : 2 * pixel + 2].tobytes()))
# The pixel right of and below the middle.
assert abs(back[0] - 20.5 / 40) < 1e-5 and abs(back[1] - 14.5 / 30) < 1e-5
assert scene.check().findings
try:
    found.uv
except midair.RequestError as error:
    assert "numpy" in str(error)
else:
    raise AssertionError("an array without numpy")
try:
    scene.trace([[0.5, 0.5]])
except midair.RequestError as error:
    assert "pip install" in error.remedy
else:
    raise AssertionError("an array without numpy")
print("done")
"""


def test_bytes_serve_where_there_is_no_numpy():
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=False)
    assert done.stdout == "done\n", done.stderr


def test_numpy_is_only_loaded_when_it_is_needed():
    code = "import sys, midair; assert 'numpy' not in sys.modules and 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert midair.__version__
