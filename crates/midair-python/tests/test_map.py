"""Maps: held to closed forms, to OpenCV, to the program's own files, and to what they say of themselves."""

import cv2
import numpy as np
import pytest
from conftest import BALL, BARE, grid

import midair
from midair import Status


def test_with_nothing_in_the_way_the_map_is_the_identity(bare):
    found = bare.map()
    assert found.uv.shape == (64, 64, 2) and found.uv.dtype == np.float64
    assert found.status.shape == (64, 64) and found.status.dtype == np.uint8
    assert (found.status == Status.OK).all() and found.counts["ok"] == 64 * 64
    # A plane-symmetric plate shows the display where the image is: pixel by pixel.
    assert np.abs(found.uv - grid(64)).max() < 1e-6
    assert found.error_bound <= 1e-6 and found.resolution == (64, 64)
    # An ideal plate loses nothing.
    assert found.gain.dtype == np.float32 and np.abs(found.gain - 1.0).max() < 1e-6


def test_a_slab_shifts_the_map_by_snells_law(slab):
    """Hecht, Optics, 4.4: a plane-parallel slab shifts a line of sight by d sin t (1 - cos t / sqrt(n^2 - sin^2 t))."""
    theta = np.radians(15.8)
    shift = 50.0 * np.sin(theta) * (1 - np.cos(theta) / np.sqrt(1.49**2 - np.sin(theta) ** 2))
    # Over the image's plane, which the line of sight crosses at a right angle; the display is 60 mm wide, the image 20.
    found = slab.map(resolution=(90, 90))
    answered = found.status == Status.OK
    assert answered.sum() > 700
    st = np.where(answered[..., None], grid(90), np.nan)
    moved = (found.uv - 0.5) * 20.0 - (st - 0.5) * 60.0
    across = np.nanmean(moved[..., 0])
    # 1e6 mm off, directions differ by 2e-5 over the display.
    assert abs(abs(across) - shift) < 1e-3 and np.nanmax(np.abs(moved[..., 0] - across)) < 1e-3
    assert np.nanmax(np.abs(moved[..., 1])) < 1e-3
    # With that shift taken off, F and the map are inverse to each other.
    back = slab.forward(found.uv[answered])
    assert np.abs(back - st[answered]).max() < 1e-6


def test_samples_look_into_the_map_and_cannot_be_written_to(ball):
    found = ball.map()
    first, second = found.uv, found.uv
    assert first.__array_interface__["data"][0] == second.__array_interface__["data"][0]
    del found
    # The array keeps what it looks into.
    assert np.isfinite(first).any()
    for array in (first, ball.map().status, ball.map().gain):
        with pytest.raises(ValueError):
            array[0, 0] = 0


def test_the_ball_s_map_is_the_inverse_of_f(ball):
    found = ball.map(resolution=(128, 96))
    answered = found.status == Status.OK
    st = np.stack(np.meshgrid((np.arange(128) + 0.5) / 128, 1 - (np.arange(96) + 0.5) / 96), axis=-1)
    assert answered.mean() > 0.5
    # The bound is of uv; F stretches by at most 3 here.
    off = np.abs(ball.forward(found.uv[answered]) - st[answered])
    assert off.max() < 3 * found.error_bound
    assert np.isnan(found.uv[found.status >= Status.OUTSIDE]).all()


def test_bytes_are_the_arrays(ball):
    found = ball.map()
    assert found.uv_bytes() == found.uv.tobytes() and found.status_bytes() == found.status.tobytes()


def test_opencv_draws_what_apply_draws(bare, ball, picture):
    """With the identity exactly; through the ball where neither filters: a picture without detail."""
    source = (picture.shape[1], picture.shape[0])
    smooth = np.full((40, 48, 3), 0.0, np.float32)
    smooth += np.linspace(0.1, 0.9, 48, dtype=np.float32)[None, :, None]
    for scene in (bare, ball):
        found = scene.map(resolution=(96, 96))
        x, y = found.to_opencv(source=source)
        assert x.dtype == y.dtype == np.float32
        answered = found.status == Status.OK
        # By the definition of cv2.remap's coordinates.
        assert np.abs(x - (found.uv[..., 0] * 48 - 0.5))[answered].max() < 1e-5
        assert np.abs(y - ((1 - found.uv[..., 1]) * 40 - 0.5))[answered].max() < 1e-5
        drawn = cv2.remap(smooth, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        ours = found.apply(smooth)
        inner = answered & (found.uv[..., 0] > 0.05) & (found.uv[..., 0] < 0.95)
        assert inner.sum() > 2000
        # A ramp is drawn exactly by any interpolation; OpenCV has 32 steps to a pixel of 0.8 / 47.
        assert np.abs(drawn - ours)[inner].max() < 0.8 / 47 / 32 + 1e-5


def test_an_stmap_holds_what_the_file_holds(ball, tmp_path):
    found = ball.map()
    pixels = found.to_stmap()
    assert pixels.shape == (64, 64, 4) and pixels.dtype == np.float32
    assert np.array_equal(pixels[..., :2], found.uv.astype(np.float32), equal_nan=True)
    assert np.array_equal(pixels[..., 3] == 1.0, found.status == Status.OK)


@pytest.mark.parametrize("name", ["exr", "npy", "png16", "opencv", "opencv-yaml", "blender", "mpcdi"])
def test_saved_maps_are_read_back(ball, tmp_path, name):
    found = ball.map(resolution=(50, 40))
    ending = {"png16": "png", "opencv": "npy", "opencv-yaml": "yml", "blender": "exr"}.get(name, name)
    files = found.save(tmp_path / f"map.{ending}", format=name, source=(50, 40))
    assert all(file.exists() for file in files)
    back = midair.load_map(tmp_path / f"map.{ending}", format=name, source=(50, 40))
    both = (found.status <= Status.FOLDED) & (back.status <= Status.FOLDED)
    assert both.sum() == (found.status <= Status.FOLDED).sum()
    # 16 bits, or single precision.
    step = 1 / 65535 if name == "png16" else 1e-6
    assert np.abs(found.uv - back.uv)[both].max() <= step
    assert np.isinf(back.error_bound) and back.report is None


def test_a_continued_map_covers_as_much_and_draws_the_same(ball, picture):
    ball["image.size"] = [60.0, 60.0]
    found = ball.map()
    bled = found.bled(2)
    known = np.isfinite(found.uv[..., 0])
    assert 0 < known.sum() < 64 * 64
    assert np.array_equal(bled.uv[known], found.uv[known]) and np.array_equal(bled.status, found.status)
    # Two rings: every pixel within two of a known one.
    around = cv2.dilate(known.astype(np.uint8), np.ones((5, 5), np.uint8)).astype(bool)
    assert np.array_equal(np.isfinite(bled.uv[..., 0]), around)
    assert np.array_equal(bled.apply(picture), found.apply(picture))


def test_numpy_reads_the_npy_file(ball, tmp_path):
    found = ball.map()
    found.save(tmp_path / "map.npy")
    assert np.array_equal(np.load(tmp_path / "map.npy"), found.uv, equal_nan=True)
    assert np.array_equal(np.load(tmp_path / "status.npy"), found.status)


def test_the_program_and_python_write_the_same_bytes(program, tmp_path, picture):
    (tmp_path / "ball.toml").write_text(BALL)
    cv2.imwrite(str(tmp_path / "picture.png"), picture[..., ::-1])
    program(
        "compensate", "ball.toml", "--image", "picture.png", "--out", "out", "--size", "72x60",
        "--format", "exr,npy,opencv,png16", "--gain", "fit", cwd=tmp_path,
    )
    found = midair.Scene(tmp_path / "ball.toml").map(resolution=(72, 60), gain="fit")
    compared = 0
    for name, format in (
        ("map.exr", "exr"), ("map.npy", "npy"), ("map-opencv.npy", "opencv"), ("map.png", "png16"),
    ):
        for file in found.save(tmp_path / name, format=format, source=(48, 40)):
            assert file.read_bytes() == (tmp_path / "out" / file.name).read_bytes(), file.name
            compared += 1
    assert compared == 7
    shown = cv2.imread(str(tmp_path / "out/display.png"))[..., ::-1]
    assert np.array_equal(found.apply(picture), shown)


def test_per_channel_maps_are_those_of_the_wavelengths():
    scene = midair.Scene(BALL.replace("ior = 1.49", 'glass = "N-SF11"'))
    found = scene.map(per_channel=True)
    red, green, blue = found.channels
    assert np.array_equal(found.uv, green.uv, equal_nan=True)
    # Flint bends blue more than red: it must be shown further off.
    both = np.isfinite(red.uv).all(axis=-1) & np.isfinite(blue.uv).all(axis=-1)
    assert both.sum() > 500 and np.abs(red.uv - blue.uv)[both].max() > 1e-3
    assert scene.map().channels is None


def test_splat_is_the_paper_s_method(ball):
    exact, splat = ball.map(), ball.map(method="splat", spp=16)
    both = (exact.status == Status.OK) & (splat.status == Status.OK)
    assert both.sum() > 1000 and np.isinf(splat.error_bound)
    # A sample lies within its pixel, which is 1/64 wide; the ball stretches by less than three.
    assert np.abs(exact.uv - splat.uv)[both].max() < 3 / 64
    assert splat.report["method"] == "splat" and splat.report["spp"] == 16


def test_the_gain_is_fresnel_s_and_beer_s():
    """Straight through a slab of 50 mm: what each face lets through, and exp(-a d)."""
    absorption = np.array([0.002, 0.004, 0.008])
    scene = midair.Scene(
        BARE.replace("800.0]", "1e6]")
        + f"""
[[element]]
shape = {{ kind = "box", size = [200.0, 200.0, 50.0] }}
material = {{ ior = 1.49, absorption = {absorption.tolist()} }}
"""
    )
    expected = (1 - (0.49 / 2.49) ** 2) ** 2 * np.exp(-50.0 * absorption)
    # Single precision.
    assert np.abs(scene.map().gain - expected).max() < 1e-6
    # Evened out to fit, the weakest colour is shown at its brightest, and a white image has no colour.
    white = np.ones((8, 8, 3), np.float32)
    shown = scene.map(gain="fit").apply(white)
    assert np.abs(shown * expected - expected.min()).max() < 1e-6
    assert np.abs(scene.map().apply(white) - 1.0).max() < 1e-6
