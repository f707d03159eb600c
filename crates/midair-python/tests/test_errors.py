"""Errors say what is wrong, where, and what helps."""

import pickle

import numpy as np
import pytest
from conftest import BALL, BARE

import midair


def test_a_scene_s_error_names_file_line_and_remedy(tmp_path):
    path = tmp_path / "odd.toml"
    path.write_text(BARE.replace("[plate]", "[plate]\nsise = [1.0, 1.0]"))
    with pytest.raises(midair.SceneError) as caught:
        midair.Scene(path)
    error = caught.value
    assert (error.file, error.line) == (str(path), 6)
    assert error.remedy and "size" in error.remedy and error.remedy in str(error)
    assert "sise" in error.message and str(error).startswith(f"{path}:6")
    assert isinstance(error, midair.Error) and isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert (again.file, again.line, again.remedy, str(again)) == (
        error.file, error.line, error.remedy, str(error),
    )


def test_a_text_s_error_names_no_file():
    with pytest.raises(midair.SceneError) as caught:
        midair.Scene(BARE.replace("[image]", "[image]\nsizes = 3"))
    assert caught.value.file is None and caught.value.line == 5


@pytest.mark.parametrize(
    ("wrong", "kind", "part"),
    [
        (lambda s: midair.Scene("nowhere.toml"), midair.SceneError, "nowhere.toml"),
        (lambda s: midair.Scene(3), midair.RequestError, "path"),
        (lambda s: midair.Scene({"image": {1: 2}}), midair.RequestError, "key"),
        (lambda s: midair.Scene({"image": object()}), midair.RequestError, "object"),
        (lambda s: midair.load_map("nowhere.exr"), midair.FileError, "nowhere.exr"),
        (lambda s: midair.load_map("nowhere.xyz"), midair.ContentError, "nowhere.xyz"),
        (lambda s: midair.load_map("a.exr", format="tif"), midair.RequestError, "opencv"),
        (lambda s: s["viewpoint"], midair.SceneError, "block"),
        (lambda s: s["element.cube.rotation"], midair.SceneError, "ball"),
        (lambda s: s.changed({"name": None}), midair.RequestError, "None"),
        (lambda s: s.changed({"viewpoint.position.x": "left"}), midair.SceneError, "number"),
        (lambda s: s.changed({"viewpoint.position.x": float("nan")}), midair.RequestError, "nan"),
        (lambda s: s.changed({"viewpoint.position.x": 1e9}), midair.SceneError, "1000000"),
        (lambda s: s.map(method="guess"), midair.RequestError, "splat"),
        (lambda s: s.map(spp=3), midair.RequestError, "splat"),
        (lambda s: s.map(gain="much"), midair.RequestError, "fit"),
        (lambda s: s.map(resolution=(0, 5)), midair.RequestError, "32768"),
        (lambda s: s.map(resolution=(32768, 32768)), midair.RequestError, "at most"),
        (lambda s: s.map(tolerance=float("nan")), midair.RequestError, "tolerance"),
        (lambda s: s.map().apply(np.zeros((4, 4, 2), np.uint8)), midair.RequestError, "R, G, B"),
        (lambda s: s.map().apply(np.zeros((0, 4, 3), np.uint8)), midair.RequestError, "shape"),
        (lambda s: s.map().apply(np.zeros((4, 4, 3), np.int32)), midair.RequestError, "uint8"),
        (lambda s: s.map().apply("picture.png"), midair.RequestError, "shape"),
        (lambda s: s.map().save("map.txt"), midair.RequestError, "map.txt"),
        (lambda s: s.map().save("none/map.exr"), midair.FileError, "none"),
        (lambda s: s.uncompensated_map().apply(np.zeros((4, 4)), optimal=True), midair.RequestError, "Scene.map"),
        (lambda s: s.forward([1.0, 2.0, 3.0]), midair.RequestError, "pairs"),
        (lambda s: s.forward(b"12345"), midair.RequestError, "16"),
        (lambda s: s.forward([["a", "b"]]), midair.RequestError, "numbers"),
        (lambda s: s.view(np.zeros((4, 4, 3)), window=0.0), midair.RequestError, "window"),
        (lambda s: s.view(np.zeros((4, 4, 3)), eye=(1e9, 0, 0)), midair.RequestError, "eye"),
        (lambda s: s.view(np.zeros((4, 4, 3)), plate="glass"), midair.RequestError, "slit-mirror"),
        (lambda s: s.view(np.zeros((4, 4, 3)), light="much"), midair.RequestError, "stray"),
        (lambda s: s.view(np.zeros((4, 4, 3)), spp=0), midair.RequestError, "8"),
        (lambda s: s.view(np.zeros((4, 4, 3)), size=(9000, 9000)), midair.RequestError, "at most"),
        (lambda s: s.view(np.zeros((4, 4, 3)), aperture=-1.0), midair.RequestError, "aperture"),
        (lambda s: s.plate(aperture=float("inf")), midair.RequestError, "wide"),
    ],
)
def test_what_cannot_be_done_is_told(ball, tmp_path, monkeypatch, wrong, kind, part):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as caught:
        wrong(ball)
    error = caught.value
    assert part in f"{error} {error.remedy}", f"{error} {error.remedy}"
    assert error.message and isinstance(error, midair.Error)
    assert not list(tmp_path.iterdir())


def test_several_faults_are_told_together():
    with pytest.raises(midair.SceneError) as caught:
        midair.Scene(BALL.replace("radius", "radios").replace("[image]\nsize", "[image]\nsice"))
    assert "radios" in str(caught.value) and "sice" in str(caught.value)
