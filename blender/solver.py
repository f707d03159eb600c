# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on asks of midair, and its errors as words: no other module calls midair."""

import re
import tomllib
from contextlib import contextmanager


class Trouble(Exception):
    """Something of the add-on's own that cannot be done; the message says what helps."""


def errors():
    """What `words` can tell."""
    import midair

    return (Trouble, midair.Error)


def words(error):
    """An error as one message: file, place, what is wrong, what helps."""
    return str(error)


@contextmanager
def told(operator):
    """Tells the errors of a block as the operator's report; yields what makes the operator's result."""
    done = [True]
    try:
        yield lambda: {"FINISHED"} if done[0] else {"CANCELLED"}
    except errors() as error:
        done[0] = False
        operator.report({"ERROR"}, words(error))


def load(text, folder):
    """A scene from its text; files that it names are looked for in the folder."""
    import midair

    # A text is told from a path by its line breaks.
    return midair.Scene(text + "\n", files=folder)


def values(text, folder):
    """A scene's values as its text gives them, lengths and angles with a unit of their own in millimetres and degrees."""
    given = tomllib.loads(text)
    if not _has_units(given):
        return given
    import midair

    return _in_own_units(given, tomllib.loads(midair.Scene(given, files=folder).toml))


# As scene files write a number with its unit: "5 cm".
_WITH_UNIT = re.compile(r"\s*[-+]?[\d.]+(e[-+]?\d+)?\s*[a-z°]+\s*", re.IGNORECASE)


def _has_units(given):
    if isinstance(given, dict):
        return any(map(_has_units, given.values()))
    if isinstance(given, list):
        return any(map(_has_units, given))
    return isinstance(given, str) and _WITH_UNIT.fullmatch(given) is not None


def _in_own_units(given, known):
    """Where a text has a number with its unit, the number that midair reads it as."""
    if isinstance(given, dict) and isinstance(known, dict):
        return {key: _in_own_units(value, known.get(key)) for key, value in given.items()}
    if isinstance(given, list) and given and isinstance(given[0], dict):
        return [_in_own_units(a, b) for a, b in zip(given, known)]
    return known if _has_units(given) and known is not None and not isinstance(known, str) else given


def changed(text, folder, changes):
    """The text with values set by their paths, all or none; everything else of it stays."""
    if not changes:
        return text
    scene = load(text, folder)
    scene.update(changes)
    return scene.toml[:-1]


def display(scene):
    """Where the display stands, also where the scene leaves that out: position, rotation, size."""
    placed = scene.display
    return list(placed["position"]), list(placed["rotation"]), list(placed["size"])


def resolution(scene):
    """The display's pixels: width, height."""
    return tuple(scene.display["resolution"])


def index(scene, element):
    """The refractive index of an element, of any kind of glass, at the wavelength of the map."""
    return scene.index(element)


def at_eye(scene, eye):
    """The scene for another viewpoint."""
    return scene.changed({"viewpoint.position": list(eye)})


def solve(scene, size):
    """The map for a display of so many pixels."""
    return scene.map(resolution=size)


def looked_up(made, bleed):
    """A map as textures are read: uv, continued by so many pixels beyond the answers, and which pixels have one of their own."""
    import numpy as np

    return made.bled(bleed).uv, np.isfinite(made.uv).all(axis=2)


def applied(made, picture, optimal):
    """What the display must show of a picture: an array like the picture's."""
    return made.apply(picture, optimal=optimal)


def judged(scene):
    """The share of the image that is formed, and what is found of the set-up: severity, sentence, remedy."""
    check = scene.check()
    return check.formed, [(f.severity, f.sentence, f.remedy or "") for f in check.findings]


def folded(made):
    """How many of the map's pixels are folded, and how many there are."""
    counts = made.counts
    return counts["folded"], sum(counts.values())


def rays(scene, uv):
    """The ways of light through image points: for each its places in mm, and its status."""
    import midair
    import numpy as np

    traced = scene.trace(np.array(uv, np.float64))
    for places, end in zip(traced.points, traced.end):
        line = places[np.isfinite(places).all(axis=1)]
        yield line.tolist(), STATUS.get(midair.End(int(end)).name.lower(), "blocked")


# What becomes of a pixel by how its path ends; all other ends block it.
STATUS = {"formed": "ok", "missed_display": "outside"}
