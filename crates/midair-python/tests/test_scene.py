"""Scenes: where they come from, their values, and how they travel."""

import json
import pickle
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import BALL, BARE, SCENES

import midair


def test_a_scene_comes_from_a_path_a_text_or_a_dict(tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(BALL)
    data = tomllib.loads(BALL)
    scenes = [
        midair.Scene(path),
        midair.Scene(str(path)),
        midair.Scene(BALL),
        midair.Scene(data),
        midair.Scene(json.dumps(data)),
    ]
    assert all(scene == scenes[0] for scene in scenes)
    assert scenes[0] != midair.Scene(BARE)
    # What a scene says of itself reads back as the same scene; a file's text stays as it is.
    assert all(midair.Scene(scene.toml) == scene for scene in scenes)
    assert scenes[0].toml == BALL == str(scenes[2])
    assert scenes[0].elements == ["ball"]
    # A dict may hold what numpy computes.
    data["viewpoint"]["position"] = np.array([0.0, np.float32(0.0), 800])
    data["display"]["resolution"] = (np.int64(64), 64)
    assert midair.Scene(data) == scenes[0]


def test_all_example_scenes_are_read_and_round_trip():
    paths = sorted(SCENES.glob("*.toml")) + sorted((SCENES / "paper").glob("*.toml"))
    read = 0
    for path in paths:
        if "bunny" in path.name:
            continue  # Its mesh is not part of the repository.
        scene = midair.Scene(path)
        again = pickle.loads(pickle.dumps(scene))
        assert again == scene and again.toml == scene.toml, path
        read += 1
    assert read >= 12, read


def test_values_are_read_and_set_by_path(ball):
    assert ball["viewpoint.position"] == [0.0, 0.0, 800.0]
    assert ball["element.ball.material.ior"] == 1.49
    assert ball["element.0.shape.radius"] == 25.0
    assert ball["max_interactions"] == 32
    assert ball["display.position"] is None
    ball["element.ball.rotation"] = [0, 15.8, 0]
    ball["viewpoint.position.x"] = np.float64(12.5)
    ball["display.resolution"] = np.array([32, 16])
    ball["name"] = "turned"
    said = tomllib.loads(ball.toml)
    assert said["element"][0]["rotation"] == [0, 15.8, 0]
    assert said["viewpoint"]["position"] == [12.5, 0.0, 800.0]
    assert said["display"]["resolution"] == [32, 16] and ball.name == "turned"
    assert ball.map().uv.shape == (16, 32, 2)
    assert ball.unit("element.ball.rotation.y") == "degrees" and ball.unit("name") is None


def test_changes_are_whole_or_none(ball):
    before = ball.toml
    with pytest.raises(midair.SceneError):
        ball.update({"viewpoint.position.x": 5.0, "viewpoint.positon": 3.0})
    # The eye in the ball: each value by itself may be, both together not.
    with pytest.raises(midair.SceneError) as caught:
        ball.update({"viewpoint.position": [0.0, 0.0, 10.0]})
    assert caught.value.remedy and ball.toml == before
    other = ball.changed({"viewpoint.position.y": 100.0})
    assert ball["viewpoint.position.y"] == 0.0 and other["viewpoint.position.y"] == 100.0
    assert ball.toml == before


def test_comments_survive_changes_and_saving(tmp_path):
    text = BALL.replace("800.0]", "800.0]  # measured twice")
    scene = midair.Scene(text)
    scene["viewpoint.position.z"] = 750.0
    path = tmp_path / "scene.toml"
    scene.save(path)
    assert path.read_text() == text.replace("800.0]", "750.0]")
    with pytest.raises(midair.RequestError):
        scene.save(tmp_path / "scene.json")
    assert not (tmp_path / "scene.json").exists()


TETRAHEDRON = b"v 9 9 9\nv 9 -9 -9\nv -9 9 -9\nv -9 -9 9\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"
GEM = BARE + '[[element]]\nshape = { kind = "mesh", file = "gem.obj", normals = "flat" }\nmaterial = { ior = 1.5 }\n'


def test_files_come_from_the_scene_s_folder_a_folder_or_memory(tmp_path):
    (tmp_path / "gem.obj").write_bytes(TETRAHEDRON)
    (tmp_path / "gem.toml").write_text(GEM)
    scenes = [
        midair.Scene(tmp_path / "gem.toml"),
        midair.Scene(GEM, files=tmp_path),
        midair.Scene(GEM, files={"gem.obj": TETRAHEDRON}),
    ]
    maps = [scene.map().uv for scene in scenes]
    assert np.isfinite(maps[0]).any()
    assert all(np.array_equal(found, maps[0], equal_nan=True) for found in maps)
    with pytest.raises(midair.SceneError, match="gem.obj"):
        midair.Scene(GEM)
    # A pickled scene takes its files with it: the folder may be gone.
    kept = pickle.dumps(scenes[0])
    (tmp_path / "gem.obj").unlink()
    assert np.array_equal(pickle.loads(kept).map().uv, maps[0], equal_nan=True)
    # Another scale needs the file again, which the scene still holds.
    scenes[0]["element.0.shape.scale"] = 1.5
    assert np.isfinite(scenes[0].map().uv).sum() > np.isfinite(maps[0]).sum()


def test_a_repr_is_short_and_says_what_it_is(ball):
    for thing in (ball, ball.map(), ball.check(), ball.trace([[0.5, 0.5]]), *ball.check().findings):
        assert "midair" in repr(thing) and len(repr(thing)) < 300 and "\n" not in repr(thing)
    assert ball._repr_svg_().startswith("<svg") and "<table" in ball.check()._repr_html_()
    assert "</svg>" in ball.drawing()
