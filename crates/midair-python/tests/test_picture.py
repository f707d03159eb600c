"""Pictures: numpy in, numpy out, by the array's kind of number."""

import cv2
import numpy as np
import pytest
from conftest import BALL

import midair
from midair import Status


def srgb(light):
    """IEC 61966-2-1."""
    light = np.clip(light, 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def linear(code):
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def identity(bare, size):
    return bare.map(resolution=size)


def test_the_identity_gives_each_kind_of_picture_back(bare, picture):
    same = identity(bare, (48, 40))
    for array in (picture, picture.astype(np.uint16) * 257, linear(picture / 255.0).astype(np.float32)):
        back = same.apply(array)
        assert back.dtype == array.dtype and back.shape == (40, 48, 3)
        # uv are exact to 1e-6 of the image: 5e-5 of a pixel, between neighbours that differ by at most 40 codes.
        off = np.abs(back.astype(float) - array)
        assert off.max() <= {1: 0, 2: 1, 4: 1e-4}[array.itemsize], array.dtype


def test_codes_and_light_agree(ball, picture):
    found = ball.map()
    codes = found.apply(picture)
    light = found.apply(linear(picture / 255.0).astype(np.float32))
    # The nearest code of the same light.
    assert np.abs(srgb(light) * 255 - codes).max() <= 0.5 + 1e-3


def test_alpha_and_grey(bare):
    same = identity(bare, (6, 5))
    grey = np.arange(30, dtype=np.uint8).reshape(5, 6) * 8
    for shape in ((5, 6), (5, 6, 1)):
        assert np.array_equal(same.apply(grey.reshape(shape)), np.repeat(grey[..., None], 3, axis=2))
    # A display emits light: half transparent white is half the light.
    veil = np.full((5, 6, 4), 255, np.uint8)
    veil[..., 3] = 128
    assert (same.apply(veil) == round(float(srgb(128 / 255)) * 255)).all()
    # Floats are premultiplied, as OpenEXR has them.
    veil = np.full((5, 6, 4), 0.25, np.float32)
    assert np.abs(same.apply(veil) - 0.25).max() < 1e-6


def test_arrays_of_any_layout_are_read(bare, picture):
    same = identity(bare, (48, 40))
    expected = same.apply(picture)
    wide = np.zeros((80, 96, 3), np.uint8)
    wide[::2, ::2] = picture
    for array in (np.asfortranarray(picture), wide[::2, ::2], picture[::-1][::-1], picture.tolist()):
        if isinstance(array, list):
            array = np.array(array, np.uint8)
        assert np.array_equal(same.apply(array), expected)
    for kind in (np.float16, np.float64, ">f4"):
        light = (picture / 255.0).astype(kind)
        assert same.apply(light).dtype == np.float32
    assert np.array_equal(picture, picture.copy())


def test_the_best_display_image_is_nearer_in_the_view(picture):
    """Least squares over the display's pixels: its view is nearer to the picture than that of the plain filter."""
    scene = midair.Scene(BALL)
    large = cv2.resize(picture, (64, 64), interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(1).integers(0, 256, (64, 64, 3))
    large = ((large + noise) // 2).astype(np.uint8)
    found = scene.map()
    bare = midair.Scene(BALL.split("[[element]]")[0])
    target = bare.view(bare.map().apply(large), size=(64, 64)).astype(float)
    # Where the ball forms the image.
    inner = np.s_[12:-12, 12:-12]
    errors = [
        np.square(scene.view(found.apply(large, optimal=optimal), size=(64, 64))[inner] - target[inner]).mean()
        for optimal in (False, True)
    ]
    assert errors[1] < errors[0]
    assert (found.status == Status.OK).any()


def test_the_view_of_the_compensated_display_is_the_picture(ball):
    """The point of it all: seen through the ball, the picture looks as it does with nothing in the way."""
    x = np.linspace(0.1, 0.9, 128, dtype=np.float32)
    ramp = np.stack([np.tile(x, (128, 1)), np.tile(x[::-1, None], (1, 128)), np.full((128, 128), 0.5, np.float32)], -1)
    display = ball.map(resolution=(256, 256)).apply(ramp)
    seen = ball.view(display, size=(128, 128))
    assert seen.dtype == np.float32 and seen.shape == (128, 128, 3)
    inner = np.s_[8:-8, 8:-8]
    # A ramp bends by the curvature of the map over a display pixel: far less than a code of 255.
    assert np.abs(seen - ramp)[inner].max() < 1 / 255
    # Without compensation it does not.
    plain = ball.view(ball.uncompensated_map(resolution=(256, 256)).apply(ramp), size=(128, 128))
    assert np.abs(plain - ramp)[inner].max() > 20 / 255


def test_a_gamma_display_is_sent_its_own_codes(picture):
    """A display whose light is the code to the power 1.8 is sent codes that make the picture's light: and its view shows that light."""
    scene = midair.Scene(BALL.split("[[element]]")[0].replace("[display]", "[display]\ngamma = 1.8"))
    same = scene.map(resolution=(48, 40))
    codes = same.apply(picture)
    expected = linear(picture / 255.0) ** (1 / 1.8) * 255
    assert np.abs(codes - expected).max() <= 0.5 + 0.05
    seen = scene.view(codes, size=(48, 40), supersampling=1)
    assert np.abs(seen.astype(int) - picture).max() <= 2


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_the_program_and_python_see_the_same(program, tmp_path, picture, kind):
    (tmp_path / "ball.toml").write_text(BALL)
    cv2.imwrite(str(tmp_path / "display.png"), picture[..., ::-1])
    scene = midair.Scene(tmp_path / "ball.toml")
    if kind == np.uint8:
        options = {"eye": (30, 10, 700), "size": (40, 40), "window": 1.5}
        program(
            "view", "ball.toml", "--display", "display.png", "--out", "view.png",
            "--from", "30,10,700", "--size", "40x40", "--window", "1.5", cwd=tmp_path,
        )
        seen = scene.view(picture, **options)
        assert np.array_equal(seen, cv2.imread(str(tmp_path / "view.png"))[..., ::-1])
    else:
        program(
            "view", "ball.toml", "--display", "display.png", "--out", "view.png", "--size", "16x16",
            "--spp", "16", "--plate", "slit-mirror", "--aperture", "4", "--light", "stray", "--exposure", "2",
            "--seed", "3", cwd=tmp_path,
        )
        options = {"size": (16, 16), "spp": 16, "plate": "slit-mirror", "aperture": 4.0, "light": "stray", "seed": 3}
        codes = scene.view(picture, exposure=2.0, **options)
        assert np.array_equal(codes, cv2.imread(str(tmp_path / "view.png"))[..., ::-1])
        # In floats: the same light, not exposed.
        light = scene.view(linear(picture / 255.0).astype(np.float32), **options)
        assert np.abs(srgb(2.0 * light) * 255 - codes).max() <= 0.5 + 0.05
        assert light.max() > 0
