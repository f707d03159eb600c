"""Figures show the data that they are given."""

import subprocess
import sys

import matplotlib
import numpy as np
import pytest
from conftest import BALL, BARE, SCENES

import midair

matplotlib.use("Agg")


def drawn(figure):
    """The figure's pixels, drawn: what cannot be drawn fails here."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def test_a_map_s_figure_has_its_lines_arrows_and_statuses(ball):
    found = ball.map(resolution=(96, 64))
    figure = midair.plot.map(found, against=ball.uncompensated_map(resolution=(96, 64)), lines=5, arrows=9)
    pixels = drawn(figure)
    assert pixels.std() > 5
    grid, moved, status = figure.axes
    # Lines of equal u pass where u has that value.
    contours = grid.collections[0]
    compared = 0
    for level, path in zip(contours.levels, contours.get_paths()):
        for s, t in path.vertices[:: max(1, len(path.vertices) // 5)]:
            column, row = s * 96 - 0.5, (1 - t) * 64 - 0.5
            around = found.uv[int(row) : int(row) + 2, int(column) : int(column) + 2, 0]
            if 0 < level < 1 and np.isfinite(around).all():
                assert around.min() - 1e-9 <= level <= around.max() + 1e-9
                compared += 1
    assert compared > 5
    assert np.array_equal(status.images[0].get_array(), found.status)
    # An arrow is as long as it says: the middle of the ball's image stays.
    arrows = moved.collections[0]
    lengths = np.hypot(arrows.U, arrows.V)
    assert np.nanmin(lengths) < 0.02 and np.nanmax(lengths) > 0.05
    with pytest.raises(ValueError, match="compare"):
        midair.plot.map(found, against=ball.map())


def test_a_map_without_an_answer_is_drawn():
    scene = midair.Scene(BARE.replace("488.0, 488.0", "1.0, 1.0").replace("-150.0]", "-150.0]", 1))
    scene.update({"plate.position": [0.0, 300.0, -150.0]})
    found = scene.map()
    assert not np.isfinite(found.uv).any()
    drawn(midair.plot.map(found))


def test_a_plate_s_figure_shows_its_shares(ball):
    figure = midair.plot.plate(ball)
    drawn(figure)
    mesh = figure.axes[0].collections[0].get_array()
    told = np.asarray(ball.plate()["directions"]["real"]) @ [0.2126, 0.7152, 0.0722]
    assert np.allclose(mesh, told)
    # Along the mirrors of a layer (45 degrees) no light forms the image.
    assert mesh[45].max() < 1e-9 and mesh[0].max() > 0.2


def test_a_set_up_is_drawn_to_scale(ball):
    figure = midair.plot.set_up(ball, uv=[[0.5, 0.5], [0.2, 0.8]])
    drawn(figure)
    side, top = figure.axes
    for axes in (side, top):
        # A millimetre is as long upwards as to the right.
        box, (x0, x1), (y0, y1) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
        assert box.width / (x1 - x0) == pytest.approx(box.height / (y1 - y0), rel=1e-3)
    # The plate is seen on edge from the side: 488 mm at 45 degrees.
    plate = [body for body in ball.layout()["bodies"] if body["role"] == "plate"][0]
    ends = np.vstack(plate["side"]["lines"])
    assert np.ptp(ends[:, 1]) == pytest.approx(488 / np.sqrt(2))
    # Rays begin at the eye, 800 mm towards the viewer.
    courses = [line.get_xydata() for line in side.lines if len(line.get_xydata()) == 5]
    assert any(np.allclose(course[0], [800, 0]) for course in courses)


def test_every_example_scene_is_drawn():
    for path in sorted(SCENES.glob("*.toml")):
        drawn(midair.plot.set_up(midair.Scene(path)))


def test_without_matplotlib_the_remedy_is_told():
    code = (
        f"import sys; sys.modules['matplotlib'] = None; sys.modules['matplotlib.figure'] = None; import midair\n"
        f"scene = midair.Scene({BALL!r})\n"
        "try:\n    midair.plot.set_up(scene)\nexcept ImportError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "pip install midair[plot]" in done.stdout, done.stderr
