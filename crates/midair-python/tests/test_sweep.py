"""Sweeps: held to closed forms; whole whatever happens to workers, set-ups and the program."""

import os
import signal
import time

import numpy as np
import pytest
from conftest import BARE, SLAB

import midair

PLACED = BARE.replace("[display]", "[display]\nposition = [0.0, -150.0, -150.0]\nrotation = [-90.0, 0.0, 0.0]")


def test_dimensions_are_paths_with_their_units():
    scene = midair.Scene(PLACED)
    xs, ys = [0.0, 0.5, 2.0], [-1.0, 1.0]
    found = midair.sweep(
        scene, {"display.position.x": xs, "display.position.z": ys}, ["displacement", "displacement_max", "formed"]
    )
    assert found.displacement.dims == ("display.position.x", "display.position.z")
    assert found["display.position.x"].attrs["units"] == "mm" == found.displacement.attrs["units"]
    assert found.attrs == {"scene": scene.toml, "midair": midair.__version__}
    # The display's mirror image is the image; sideways by x, and its z is the image's y.
    expected = np.hypot(*np.meshgrid(xs, ys, indexing="ij"))
    assert np.abs(found.displacement - expected).max() < 1e-9
    assert np.abs(found.displacement_max - expected).max() < 1e-9
    # So much of 65 columns and rows goes past the edges.
    columns = [np.mean(((np.arange(65) + 0.5) / 65 - x / 20 >= 0)) for x in xs]
    rows = [np.mean(((np.arange(65) + 0.5) / 65 - abs(y) / 20 >= 0)) for y in ys]
    assert np.abs(found.formed - np.outer(columns, rows)).max() < 1e-9
    assert (found.message == "").all()


def test_an_index_that_was_mistaken_shifts_by_snell_s_law():
    scene = midair.Scene(SLAB)
    indices = [1.45, 1.49, 1.55]
    found = midair.sweep(scene, {"element.slab.material.ior": indices}, "displacement")
    sine, cosine = np.sin(np.radians(15.8)), np.cos(np.radians(15.8))
    shift = 50.0 * sine * (1 - cosine / np.sqrt(np.square(indices) - sine**2))
    # From 1e6 mm off, lines of sight differ by 1e-5.
    assert np.abs(found.displacement - np.abs(shift - shift[1])).max() < 1e-4
    assert found["element.slab.material.ior"].attrs["units"] == "1"


def eye(scene):
    return scene["viewpoint.position.x"]


def two(scene):
    return {"x": scene["viewpoint.position.x"], "square": scene["viewpoint.position.x"] ** 2}


def test_functions_measure_the_varied_scene_and_texts_are_values(bare):
    found = midair.sweep(bare, {"viewpoint.position.x": [1.0, 2.0, 3.0], "name": ["a", "b"]}, [eye, two])
    assert np.array_equal(found.eye[:, 0], [1, 2, 3]) and np.array_equal(found.square[:, 1], [1, 4, 9])
    assert list(found["name"].values) == ["a", "b"]


def test_a_set_up_that_fails_is_nan_and_a_message(bare):
    # At z = 0 the eye lies in the image.
    found = midair.sweep(bare, {"viewpoint.position.z": [800.0, 0.0, 700.0]}, ["formed"])
    assert list(np.isnan(found.formed)) == [False, True, False]
    assert found.message[0] == "" and "viewpoint" in str(found.message[1].item())
    with pytest.warns(UserWarning, match="all 1 set-ups failed"):
        found = midair.sweep(bare, {"viewpoint.position.z": [0.0]}, ["formed", "gain"])
    assert np.isnan(found.formed).all() and np.isnan(found.gain).all()


@pytest.mark.parametrize(
    ("over", "measure", "part"),
    [
        ({"viewpoint.positon.x": [1]}, "formed", "no such key"),
        ({"viewpoint.position.x": []}, "formed", "at least one"),
        ({"viewpoint.position": [[0, 0, 1]]}, "formed", "list of numbers"),
        ({"viewpoint.position.x": [1]}, "shape", "displacement"),
        ({"viewpoint.position.x": [1]}, ["formed", "formed"], "other names"),
    ],
)
def test_what_cannot_be_swept_is_told_before_the_work(bare, over, measure, part):
    with pytest.raises(ValueError, match=part):
        midair.sweep(bare, over, measure)


class Stop(BaseException):
    pass


def test_a_store_goes_on_where_it_was_left(bare, tmp_path):
    calls = []

    def counted(scene):
        calls.append(scene["viewpoint.position.x"])
        time.sleep(0.03)
        if stop and len(calls) == 9:
            raise Stop
        return calls[-1]

    over = {"viewpoint.position.x": np.arange(12.0), "viewpoint.position.z": [800.0, 0.0]}
    stop, store = True, tmp_path / "store"
    with pytest.raises(Stop):
        midair.sweep(bare, over, [counted], store=store)
    before = len(calls)
    stop = False
    found = midair.sweep(bare, over, [counted], store=store)
    # Of 12 set-ups that can be measured, those before the interruption are kept but for the last tenth of a second's.
    assert len(calls) - before <= 12 - before + 5 and len(calls) > 12 - 1
    assert np.array_equal(found.counted[:, 0], np.arange(12.0)) and np.isnan(found.counted[:, 1]).all()
    assert (found.message[:, 1] != "").all() and (found.message[:, 0] == "").all()
    # All is there: nothing is measured again.
    calls.clear()
    again = midair.sweep(bare, over, [counted], store=store)
    assert not calls and again.identical(found)
    with pytest.raises(ValueError, match="another sweep .over differ"):
        midair.sweep(bare, {"viewpoint.position.x": [1.0]}, [counted], store=store)
    with pytest.raises(ValueError, match="scene differ"):
        midair.sweep(bare.changed({"name": "other"}), over, [counted], store=store)


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def slow(scene):
    time.sleep(0.05)
    return scene["viewpoint.position.x"] + 0.5


def process(scene):
    return os.getpid()


def test_workers_find_what_is_found_here(client):
    scene = midair.Scene(SLAB)
    over = {"element.slab.material.ior": np.linspace(1.4, 1.6, 30), "element.slab.rotation.y": np.linspace(0, 30, 15)}
    here = midair.sweep(scene, over, ["displacement"])
    there = midair.sweep(scene, over, ["displacement", process], client=client)
    # To the last bit: points are independent of one another.
    assert np.array_equal(here.displacement, there.displacement)
    # Here for the first ones, and on both workers.
    assert len(np.unique(there.process)) == 3


def test_nothing_is_lost_when_a_worker_is_killed(client, bare):
    """One of two workers dies in the middle: all set-ups are measured all the same."""
    import threading

    pids = client.run(os.getpid)
    killer = threading.Timer(1.0, lambda: os.kill(next(iter(pids.values())), signal.SIGKILL))
    killer.start()
    xs = np.arange(80.0)
    found = midair.sweep(bare, {"viewpoint.position.x": xs}, [slow], client=client)
    killer.join()
    assert next(iter(pids.values())) not in client.run(os.getpid).values()
    assert np.array_equal(found.slow, xs + 0.5) and (found.message == "").all()
