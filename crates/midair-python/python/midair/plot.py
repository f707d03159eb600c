"""Figures of maps, plates and set-ups, by matplotlib: pip install midair[plot].

Each function returns a matplotlib Figure, drawn into `figure` if one is given.
"""

from __future__ import annotations

import functools
import io
from typing import TYPE_CHECKING, Any

from ._codes import End, Status

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._core import Map, Scene

# Okabe and Ito's colours (2008), which people of any colour vision tell apart.
_GREEN, _YELLOW, _SKY, _BLUE = "#009e73", "#f0e442", "#56b4e9", "#0072b2"
_VERMILION, _PURPLE, _DARK, _GREY = "#d55e00", "#cc79a7", "#46484c", "#787878"
_STATUS = {
    Status.OK: (_GREEN, "ok"),
    Status.FOLDED: (_YELLOW, "folded"),
    Status.OUTSIDE: (_DARK, "outside"),
    Status.BLOCKED: (_SKY, "blocked"),
}
_ROLES = {
    "display": _BLUE,
    "plate": _PURPLE,
    "image": _VERMILION,
    "solid": _SKY,
    "mirror": _GREY,
}


def _figure(figure: Any, size: tuple[float, float]) -> Any:
    if figure is not None:
        return figure
    return _class()(figsize=size, layout="constrained")


@functools.cache
def _class() -> Any:
    """matplotlib's Figure, which notebooks show as it is, whatever became of pyplot."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError("figures need matplotlib: pip install midair[plot]") from error

    class ShownFigure(Figure):
        def _repr_png_(self) -> bytes:
            png = io.BytesIO()
            self.savefig(png, format="png", dpi=90)
            return png.getvalue()

    return ShownFigure


def map(
    map: Map,
    *,
    against: Map | None = None,
    lines: int = 11,
    arrows: int = 21,
    figure: Any = None,
) -> Any:
    """A map on the display: lines of equal u and v, arrows of displacement, and the statuses.

    `lines` of equal u, and as many of equal v, at equal steps from 0 to 1. Each of the `arrows` x `arrows` arrows leads from the image point
    that the pixel would show without compensation to the one that it must show; without compensation is as `against` says
    (Scene.uncompensated_map()), or, left out, at uv = st.
    """
    import numpy as np
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    figure = _figure(figure, (13.5, 4.6))
    grid, moved, status = figure.subplots(1, 3)
    width, height = map.resolution
    s = (np.arange(width) + 0.5) / width
    t = 1.0 - (np.arange(height) + 0.5) / height
    # Beyond the coverage a map may be continued.
    answered = map.status <= Status.FOLDED
    uv = np.where(answered[..., None], map.uv, np.nan)

    levels = np.linspace(0.0, 1.0, lines)
    for axis, colour, name in ((0, _BLUE, "u"), (1, _VERMILION, "v")):
        if np.isfinite(uv).any():
            contours = grid.contour(s, t, uv[..., axis], levels, colors=colour, linewidths=1.0)
            grid.clabel(contours, contours.levels[:: max(1, lines // 5)], fontsize=7, fmt="%.1f")
        grid.plot([], [], color=colour, label=f"equal {name}")
    grid.set_title("Image points uv")

    columns = np.unique(np.linspace(0, width - 1, min(arrows, width)).round().astype(int))
    rows = np.unique(np.linspace(0, height - 1, min(arrows, height)).round().astype(int))
    at = np.ix_(rows, columns)
    if against is None:
        before = np.stack(np.meshgrid(s[columns], t[rows]), axis=-1)
    elif against.resolution == map.resolution:
        before = against.uv[at]
    else:
        raise ValueError(f"maps of {against.resolution} and {map.resolution} pixels do not compare")
    step = uv[at] - before
    moved.quiver(
        *np.meshgrid(s[columns], t[rows]),
        step[..., 0],
        step[..., 1],
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.004,
        color=_DARK,
    )
    lengths = np.linalg.norm(step, axis=-1)
    mean = f", mean {np.nanmean(lengths):.3f}" if np.isfinite(lengths).any() else ""
    moved.set_title(f"Displacement, in uv{mean}")

    colours = ListedColormap([colour for colour, _ in _STATUS.values()])
    norm = BoundaryNorm(np.arange(len(_STATUS) + 1) - 0.5, len(_STATUS))
    status.imshow(
        map.status, cmap=colours, norm=norm, extent=(0, 1, 0, 1), interpolation="nearest"
    )
    shares = np.bincount(map.status.ravel(), minlength=len(_STATUS)) / map.status.size
    patches = [
        Patch(color=colour, label=f"{name} {100 * shares[code]:.1f} %")
        for code, (colour, name) in _STATUS.items()
    ]
    status.legend(handles=patches, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=8)
    grid.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize=8)
    status.set_title("Status")
    for axes in (grid, moved, status):
        axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="s", ylabel="t")
        # As wide as the display is, in pixels.
        axes.set_aspect(height / width)
    return figure


def plate(scene: Scene, *, aperture: float = 4.0, figure: Any = None) -> Any:
    """The character of a scene's plate: efficiency by direction, luminance by viewpoint, sharpness through a pupil of `aperture` mm.

    Of the usual slit-mirror plate where the scene's is ideal.
    """
    import numpy as np

    told = scene.plate(aperture=aperture)
    figure = _figure(figure, (12.5, 7.6))
    panels = figure.subplots(2, 3)
    directions = told["directions"]
    incidence, azimuth = directions["incidence_degrees"], directions["azimuth_degrees"]
    for axes, (kind, title) in zip(
        panels[0],
        (("real", "Mid-air image"), ("stray", "Stray light"), ("through", "Through, as by a window")),
    ):
        # What is measured by eye is luminance (Rec. ITU-R BT.709).
        luminance = np.asarray(directions[kind], float) @ [0.2126, 0.7152, 0.0722]
        drawn = axes.pcolormesh(incidence, azimuth, luminance, cmap="viridis", vmin=0.0, vmax=1.0)
        axes.set(title=title, xlabel="incidence, degrees", ylabel="azimuth from the plate's +x, degrees")
    figure.colorbar(drawn, ax=panels[0], label="share of light")

    seen = told["viewpoints"]
    axes = panels[1][0]
    luminance = np.asarray(seen["luminance"], float)
    drawn = axes.pcolormesh(seen["azimuth_degrees"], seen["elevation_degrees"], luminance, cmap="viridis")
    figure.colorbar(drawn, ax=axes, label="over the display's")
    axes.set(
        title="Luminance of the image",
        xlabel="viewer's azimuth, degrees",
        ylabel="viewer's elevation, degrees",
    )

    spread = told["point_spread"]
    half = spread["extent_mm"] / 2
    axes = panels[1][1]
    axes.imshow(np.asarray(spread["cells"], float), cmap="magma", extent=(-half, half, -half, half))
    axes.set(title="A point of the image", xlabel="x, mm", ylabel="y, mm")

    transfer = told["modulation_transfer"]
    axes = panels[1][2]
    for name, colour in (("x", _BLUE), ("y", _VERMILION)):
        values = np.asarray(transfer[name], float)
        axes.plot(transfer["frequency_per_mm"], values, color=colour, label=f"across {name}")
    axes.axhline(0.5, color=_GREY, linewidth=0.8, linestyle=":")
    axes.set(
        title=f"Modulation transfer, pupil {spread['pupil_mm']:g} mm",
        xlabel="cycles per mm",
        ylabel="contrast",
        ylim=(0, 1.02),
    )
    axes.set_xlim(left=0)
    axes.legend(fontsize=8)
    return figure


def set_up(scene: Scene, *, uv: ArrayLike | None = None, figure: Any = None) -> Any:
    """The set-up from the side and from above, to scale, with rays through image points `uv` (n, 2).

    Left out, rays go through the image's middle and the middles of its edges. Rays that do not reach the display are dashed, and red where
    they end.
    """
    import numpy as np

    layout = scene.layout()
    places = [[0.5, 0.5], [0.5, 1.0], [0.5, 0.0], [0.0, 0.5], [1.0, 0.5]] if uv is None else uv
    rays = scene.trace(np.reshape(np.asarray(places, float), (-1, 2)))
    figure = _figure(figure, (9.0, 8.5))
    axes_of = dict(zip(("side", "top"), figure.subplots(2, 1, sharex=True)))
    for view, axes in axes_of.items():
        for body in layout["bodies"]:
            colour = _ROLES[body["role"]]
            shown = body[view]
            if len(shown["contour"]) > 2:
                axes.fill(*shown["contour"].T, color=colour, alpha=0.18, linewidth=0)
                closed = np.vstack([shown["contour"], shown["contour"][:1]])
                axes.plot(*closed.T, color=colour, linewidth=1.2)
            for line in shown["lines"]:
                axes.plot(*line.T, color=colour, linewidth=0.9)
            points = np.vstack([shown["contour"], *shown["lines"]])
            if view == "side":
                middle, top = points[:, 0].mean(), points[:, 1].max()
                axes.annotate(
                    body["name"],
                    (middle, top),
                    (0, 3),
                    textcoords="offset points",
                    ha="center",
                    fontsize=8,
                    color=colour,
                )
        for path, end in zip(rays.points, rays.end):
            path = path[np.isfinite(path[:, 0])]
            flat = path @ layout[f"{view}_axes"].T
            formed = end == End.FORMED
            axes.plot(*flat.T, color=_DARK if formed else _VERMILION, linewidth=0.8, linestyle="-" if formed else "--")
            if not formed:
                axes.plot(*flat[-1], "x", color=_VERMILION, markersize=5)
        axes.plot(*(layout["eye"] @ layout[f"{view}_axes"].T), "o", color=_DARK, markersize=5)
        axes.set_aspect("equal", adjustable="datalim")
        axes.grid(linewidth=0.3)
    axes_of["side"].annotate(
        "viewpoint",
        layout["eye"] @ layout["side_axes"].T,
        (0, 6),
        textcoords="offset points",
        ha="right",
        fontsize=8,
    )
    axes_of["side"].set(title=f"{scene.name}: from the side", ylabel="up, mm")
    axes_of["top"].set(title="From above", xlabel="towards the viewer, mm", ylabel="to the viewer's right, mm")
    return figure
