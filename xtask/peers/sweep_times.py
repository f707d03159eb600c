"""How much faster a sweep is on two workers than on one, each a process of one thread: run it on a machine that does nothing else.

    PYTHONPATH=target/python/release target/python/environment/bin/python3 xtask/peers/sweep_times.py
"""

import time
from pathlib import Path

import distributed
import numpy as np

import midair

SCENES = Path(__file__).parents[2] / "scenes" / "paper"


def seconds(scene: midair.Scene, workers: int, side: int) -> float:
    """A sweep over side x side set-ups, of which each is mapped."""
    over = {
        "element.cube.rotation.y": np.linspace(13.0, 18.0, side),
        "viewpoint.position.x": np.linspace(-20.0, 20.0, side),
    }
    with (
        distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.wait_for_workers(workers)
        # Workers import midair when they first need it.
        midair.sweep(scene, {path: values[:2] for path, values in over.items()}, ["formed", bound], client=client)
        start = time.perf_counter()
        midair.sweep(scene, over, ["formed", bound], client=client)
        return time.perf_counter() - start


def bound(scene: midair.Scene) -> float:
    return scene.map(resolution=(512, 512)).error_bound


if __name__ == "__main__":
    scene = midair.Scene(SCENES / "cube.toml")
    # In turns, so that what else the machine does hits both alike.
    times = {workers: [] for workers in (1, 2)}
    for _ in range(3):
        for workers, found in times.items():
            found.append(seconds(scene, workers, 28))
    one, two = (float(np.median(found)) for found in times.values())
    print(f"one worker {one:.2f} s, two workers {two:.2f} s: {one / two:.2f} times as fast")
