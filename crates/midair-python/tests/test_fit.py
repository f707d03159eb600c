"""midair.fit against a bench whose truth is known."""

import midair
import numpy as np
import pytest

SCENE = """
[viewpoint]
position = [0.0, 0.0, 800.0]
[image]
size = [28.0, 28.0]
[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]
[display]
resolution = [1024, 1024]
position = [0.0, -150.0, -150.0]
rotation = [-90.0, 0.0, 0.0]
size = [36.5, 36.5]
"""
CUBE = """
[[element]]
name = "cube"
shape = {{ kind = "box", size = [50.0, 50.0, 50.0] }}
rotation = [0.0, {turn}, 0.0]
material = {{ ior = {ior} }}
"""
FOCAL, CENTRE = (60_000.0, 60_000.0), (3000.0, 2000.0)


def camera(eye):
    """Right, down and ahead of a camera that looks at the origin."""
    ahead = -np.asarray(eye) / np.linalg.norm(eye)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def seen(text, eye):
    """Rows x, y, s, t of image points as a camera at a place sees them: by F itself, and a pinhole of this file's own."""
    scene = midair.Scene(text)
    scene["viewpoint.position"] = list(eye)
    uv = np.stack(np.meshgrid(*[np.linspace(0.05, 0.95, 20)] * 2), axis=-1).reshape(-1, 2)
    st = scene.forward(uv)
    points = np.concatenate([(uv - 0.5) * 28.0, np.zeros((len(uv), 1))], axis=1)
    local = (points - np.asarray(eye)) @ camera(eye).T
    pixel = local[:, :2] / local[:, 2:] * FOCAL + CENTRE
    rows = np.concatenate([pixel, st, np.full((len(uv), 1), 0.05)], axis=1)
    return rows[np.isfinite(rows).all(axis=1)]


def bench():
    eyes = {"front": (0.0, 0.0, 800.0), "right": (180.0, 30.0, 770.0), "above": (-90.0, 150.0, 770.0)}
    empty, real = SCENE, SCENE + CUBE.format(turn=17.2, ior=1.492)
    return {name: (seen(empty, eye), seen(real, eye)) for name, eye in eyes.items()}


def test_the_scene_is_found():
    assumed = midair.Scene(SCENE + CUBE.format(turn=15.8, ior=1.48))
    found = midair.fit(assumed, bench(), focal=FOCAL, centre=CENTRE, starts=3)
    # Points without noise, said to be within a twentieth of a pixel.
    assert found.scene["element.cube.rotation.y"] == pytest.approx(17.2, abs=0.01)
    # Light that enters and leaves by the same two faces does not tell where along them the cube stands.
    aside = next(p for p in found.parameters if p["name"] == "element.cube.position.y")
    assert not aside["determined"] and aside["sigma"] == pytest.approx(3.0, rel=0.01)
    assert found.scene["element.cube.material.ior"] == pytest.approx(1.492, abs=0.002)
    assert found.covariance.shape == (len(found.names),) * 2
    assert np.all(np.linalg.eigvalsh(found.covariance) > 0)
    turn = next(p for p in found.parameters if p["name"] == "element.cube.rotation.y")
    assert turn["determined"] and turn["sigma"] < 0.05 and turn["start"] == pytest.approx(15.8)
    assert found.data["residual_px"]["rms"] < 0.05
    assert "numbers determined" in repr(found)


def test_what_cannot_be_is_refused():
    assumed = midair.Scene(SCENE + CUBE.format(turn=15.8, ior=1.48))
    views = bench()
    with pytest.raises(midair.RequestError, match="belong together"):
        midair.fit(assumed, views, focal=FOCAL)
    with pytest.raises(midair.RequestError, match="cuber"):
        midair.fit(assumed, views, focal=FOCAL, centre=CENTRE, fix=["cuber.ior"])
    with pytest.raises(midair.RequestError, match="not a pair"):
        midair.fit(assumed, {"front": views["front"][0]}, focal=FOCAL, centre=CENTRE)
    with pytest.raises(midair.RequestError, match="shape"):
        midair.fit(assumed, {"front": (np.zeros((3, 3)), np.zeros((3, 3)))}, focal=FOCAL, centre=CENTRE)
