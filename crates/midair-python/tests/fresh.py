"""A try of the installed wheel, as its user has it: nothing but the wheel and what it brings. Takes the folder of example scenes."""

import pickle
import sys
from pathlib import Path

import numpy as np

import midair

scene = midair.Scene(Path(sys.argv[1]) / "paper" / "cube.toml")
found = scene.map(resolution=(256, 256))
assert found.error_bound <= 1e-6 and found.counts["ok"] > 10_000, found
picture = np.full((64, 64, 3), 128, np.uint8)
display = found.apply(picture)
view = scene.view(display, eye=(60, 0, 800), size=(64, 64))
# Grey is seen as grey, where anything is.
assert (view[32, 32] == 128).all(), view[32, 32]
assert pickle.loads(pickle.dumps(scene)) == scene
assert np.isfinite(scene.forward([[0.5, 0.5]])).all() and scene.check().findings
assert Path(midair.__file__).with_name("py.typed").exists()
print(f"midair {midair.__version__} works: {found}")
