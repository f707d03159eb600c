"""midair: what a display behind a micro-mirror array plate must show.

    import midair

    scene = midair.Scene("cube.toml")               # or TOML text, or a dict
    map = scene.map(resolution=(1024, 1024))        # map.uv, map.status, map.gain, map.error_bound
    display = map.apply(picture)                    # uint8 sRGB or float32 linear, by the array's dtype
    view = scene.view(display, eye=(60, 0, 800))

Lengths are millimetres, angles degrees; frames are right-handed with +y up. Image points are uv, u to the right and v up, display points st, both
from 0 to 1. Arrays have row 0 at the top, and NaN where there is no answer.

midair.fit finds the scene as it really is from photographs' points. midair.plot draws figures (matplotlib), midair.sweep varies a scene (xarray, Dask, zarr).
"""

from ._codes import Action, End, Met, Status
from ._core import (
    Calibration,
    Check,
    ContentError,
    Error,
    FileError,
    Finding,
    Map,
    Rays,
    RequestError,
    Scene,
    SceneError,
    __version__,
    fit,
    load_map,
    thread_count,
    use_threads,
)
from . import plot
from ._sweep import sweep

__all__ = [
    "Action",
    "Calibration",
    "Check",
    "ContentError",
    "End",
    "Error",
    "FileError",
    "Finding",
    "Map",
    "Met",
    "Rays",
    "RequestError",
    "Scene",
    "SceneError",
    "Status",
    "__version__",
    "fit",
    "load_map",
    "plot",
    "sweep",
    "thread_count",
    "use_threads",
]
