"""F, its derivatives, rays, where things are seen if built otherwise, and findings."""

import numpy as np
import pytest
from conftest import BALL, BARE, SLAB, grid

import midair
from midair import Action, End, Met


def mirrored(points, at=(0.0, 0.0, -150.0), normal=(0.0, 1.0, 1.0)):
    """Points mirrored in a plane."""
    normal = np.asarray(normal) / np.linalg.norm(normal)
    return points - 2 * ((points - np.asarray(at)) @ normal)[..., None] * normal


def test_f_is_vectorised_over_any_shape(ball):
    uv = grid(12).reshape(3, 4, 12, 2)
    whole = ball.forward(uv)
    assert whole.shape == uv.shape and ball.jacobian(uv).shape == (3, 4, 12, 2, 2)
    one_by_one = np.array([ball.forward(point) for point in uv.reshape(-1, 2)]).reshape(uv.shape)
    assert np.array_equal(whole, one_by_one, equal_nan=True)
    assert ball.forward(np.empty((0, 2))).shape == (0, 2)
    assert ball.forward([0.5, 0.5]).shape == (2,)
    # Bytes in, bytes out: without numpy.
    assert ball.forward(uv.tobytes()) == whole.tobytes()
    assert ball.jacobian(memoryview(uv.tobytes())) == ball.jacobian(uv).tobytes()


def test_what_is_not_formed_is_nan(bare):
    bare["display.size"] = [10.0, 20.0]
    uv = grid(10)
    st = bare.forward(uv)
    beyond = bare.forward(uv, beyond=True)
    # Half as wide about the same middle.
    expected = np.stack([2 * uv[..., 0] - 0.5, uv[..., 1]], axis=-1)
    assert np.abs(beyond - expected).max() < 1e-9
    on = (expected[..., 0] >= 0) & (expected[..., 0] <= 1)
    assert on.sum() == 50 and np.array_equal(np.isfinite(st[..., 0]), on)
    assert np.array_equal(np.isfinite(bare.jacobian(uv)).all(axis=(-2, -1)), on)


def test_derivatives_are_those_of_differences(ball):
    uv, h = np.array([[0.3, 0.6], [0.5, 0.5], [0.71, 0.22]]), 1e-5
    slopes = ball.jacobian(uv)
    for axis in range(2):
        step = np.eye(2)[axis] * h
        differences = (ball.forward(uv + step) - ball.forward(uv - step)) / (2 * h)
        # Third derivatives of at most a hundred, times h^2, and rounding over h.
        assert np.abs(slopes[..., axis] - differences).max() < 1e-7


def test_rays_refract_by_snell_s_law_and_end_where_f_says(slab):
    uv = grid(5).reshape(-1, 2)
    rays = slab.trace(uv)
    assert rays.points.shape == (25, 5, 3) and rays.elements == ["slab"]
    assert (rays.met == [Met.EYE, 0, 0, Met.PLATE, Met.DISPLAY]).all()
    assert (rays.action == [Action.NONE, Action.REFRACT, Action.REFRACT, Action.PLATE, Action.NONE]).all()
    assert (rays.end == End.FORMED).all()
    normal = np.array([np.sin(np.radians(15.8)), 0.0, np.cos(np.radians(15.8))])
    before, inside, behind = rays.directions[:, 0], rays.directions[:, 1], rays.directions[:, 2]
    sines = [np.linalg.norm(np.cross(direction, normal), axis=-1) for direction in (before, inside, behind)]
    assert np.abs(sines[0] - 1.49 * sines[1]).max() < 1e-12 and np.abs(sines[0] - sines[2]).max() < 1e-12
    # Entry and exit lie on the slab's faces, 25 mm from its middle.
    assert np.abs(rays.points[:, 1] @ normal - 25).max() < 1e-6
    assert np.abs(rays.points[:, 2] @ normal + 25).max() < 1e-6
    # Beyond the plate: the mirror image of the way without it.
    ahead = rays.points[:, 2] + 150.0 * behind
    to_display = rays.points[:, 4] - rays.points[:, 3]
    along = np.cross(mirrored(ahead) - rays.points[:, 3], to_display)
    assert np.abs(along).max() < 1e-6 * np.linalg.norm(to_display, axis=-1).max() ** 2
    assert np.abs(rays.st - slab.forward(uv)).max() == 0
    assert np.isnan(rays.directions[:, 4]).all()


def test_rays_that_end_early_say_why(bare):
    bare.update({"plate.size": [20.0, 20.0]})
    rays = bare.trace([[0.5, 0.5], [0.0, 0.5]], eye=(0, 0, 500))
    assert list(rays.end) == [End.FORMED, End.MISSED_PLATE]
    assert np.allclose(rays.points[0, 0], [0, 0, 500])
    prism = midair.Scene(
        BARE + '[[element]]\nname = "prism"\nshape = { kind = "box", size = [40.0, 40.0, 40.0] }\n'
        "rotation = [0.0, 45.0, 0.0]\nmaterial = { ior = 1.9 }\n"
    )
    # At 45 degrees, and 21.8 within: the face at a right angle is met at 68.2, beyond the critical 31.8.
    found = prism.trace([[0.5, 0.5], [0.2, 0.5]])
    assert (found.end == End.TOTAL_REFLECTION).all() and (found.met[:, 2] == Met.NOTHING).all()
    assert np.isnan(found.points[:, 2]).all() and np.isnan(found.st).all()


def test_a_display_that_moves_is_seen_to_move(bare):
    """Its mirror image is the image: a millimetre sideways is a millimetre, a twentieth of the image."""
    bare["display.position"] = [0.0, -150.0, -150.0]
    bare["display.rotation"] = [-90.0, 0.0, 0.0]
    uv = grid(5)
    # Where it belongs: the image's mirror image in the plate.
    assert np.abs(bare.forward(uv, beyond=True) - uv).max() < 1e-9
    built = bare.changed({"display.position.x": 1.0})
    assert np.abs(bare.seen(uv, built) - uv - [0.05, 0.0]).max() < 1e-9
    assert np.abs(bare.seen(uv, bare) - uv).max() < 1e-9
    # A plate that moves within its own plane changes nothing.
    moved = bare.changed({"plate.position": [3.0, 2.0, -152.0]})
    assert np.abs(bare.seen(uv, moved) - uv).max() < 1e-9


def test_a_display_that_is_left_out_stands_where_it_belongs(bare, slab):
    display = bare.display
    corners = np.array([[-10, -10, 0], [10, -10, 0], [-10, 10, 0]])
    # The image's mirror image in the plate.
    turned = np.radians(display["rotation"])
    (sx, sy, sz), (cx, cy, cz) = np.sin(turned), np.cos(turned)
    rx = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    ry = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    rz = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    placed = corners @ (rx @ ry @ rz).T + display["position"]
    assert np.abs(placed - mirrored(corners)).max() < 1e-9
    assert display["size"] == [20.0, 20.0] and display["resolution"] == [64, 64]
    # Said outright, it stands there all the same.
    said = bare.changed({f"display.{key}": display[key] for key in ("position", "rotation", "size")})
    assert np.abs(said.forward(grid(5)) - bare.forward(grid(5))).max() < 1e-9
    assert slab.index("slab") == slab.index(0) == 1.49
    # Schott's data sheet of N-BK7 at 587.6 nm.
    glass = midair.Scene(BALL.replace("ior = 1.49", 'glass = "N-BK7"'))
    assert glass.index("ball") == pytest.approx(1.5168, abs=5e-6)
    with pytest.raises(midair.RequestError, match="cube") as caught:
        slab.index("cube")
    assert "slab" in caught.value.remedy


def test_findings_tell_what_helps_and_following_them_helps():
    scene = midair.Scene(BALL.replace("[display]", "[display]\nposition = [0.0, -140.0, -150.0]\nrotation = [-90.0, 0.0, 0.0]"))
    check = scene.check()
    off = [finding for finding in check.findings if finding.kind == "off-place"]
    assert off and off[0].values and off[0].remedy and off[0].severity in ("fault", "warning")
    scene.update(off[0].values)
    again = scene.check()
    assert not [finding for finding in again.findings if finding.kind == "off-place"]
    # By geometry: mirrored in the plate, the display lies in the image's plane; to a hundredth, as it is written.
    assert np.abs(mirrored(np.array(scene["display.position"]))[2]) < 0.01
    assert sum(again.shares.values()) == pytest.approx(1.0)
    assert again.data["image"]["formed"] == again.formed == again.shares["formed"]


def test_the_share_that_is_formed_is_the_plate_s():
    """23.75 mm of the plate are 20 mm of the image (800 to 950 mm from the eye): half of 40."""
    scene = midair.Scene(BARE.replace("20.0, 20.0", "40.0, 20.0").replace("488.0, 488.0", "23.75, 488.0"))
    # The plate is tilted: its upper edge is nearer than its lower one.
    assert scene.check().formed == pytest.approx(0.5, abs=0.01)


def test_the_check_is_the_program_s(program, tmp_path):
    import json

    (tmp_path / "slab.toml").write_text(SLAB)
    told = json.loads(program("check", "slab.toml", "--json", cwd=tmp_path))
    data = midair.Scene(tmp_path / "slab.toml").check().data
    assert data == {key: told[key] for key in data}


def test_a_plate_s_character_is_the_program_s(program, tmp_path):
    import json

    (tmp_path / "ball.toml").write_text(BALL)
    program("plate", "ball.toml", "--out", "plate", "--aperture", "6", cwd=tmp_path)
    told = json.loads((tmp_path / "plate/plate.json").read_text())
    assert midair.Scene(tmp_path / "ball.toml").plate(aperture=6.0) == told
