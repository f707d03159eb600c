"""The Python package's times, for the benchmark table: reads what to do, a line each, and answers with the seconds that it took."""

import sys
import time
from pathlib import Path

import numpy as np

import midair

scenes = Path(sys.argv[1])
sphere = midair.Scene(scenes / "sphere.toml")
cylinder = midair.Scene(scenes / "cylinder.toml")
# As the table's own row: 1000 x 1000 image points at pixel centres.
centres = (np.arange(1000) + 0.5) / 1000
uv = np.stack(np.meshgrid(centres, centres[::-1]), axis=-1)
WORK = {"map": lambda: sphere.map().uv, "forward": lambda: cylinder.forward(uv)}

for line in sys.stdin:
    work = WORK[line.strip()]
    start = time.perf_counter()
    work()
    print(time.perf_counter() - start, flush=True)
