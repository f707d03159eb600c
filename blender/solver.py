# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on asks of midair, and its errors as words: no other module calls midair."""

from contextlib import contextmanager


class Trouble(Exception):
    """Something of the add-on's own that cannot be done; the message says what helps."""


def errors():
    """What `words` can tell."""
    import midair

    return (Trouble, midair.MidairError)


def words(error):
    """An error as one message: file, place, what is wrong, what helps."""
    text = str(error)
    remedy = getattr(error, "remedy", None)
    return f"{text}: {remedy}" if remedy and remedy not in text else text


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

    return midair.Scene(text, folder=folder)


def changed(text, folder, changes):
    """The text with values set by their paths; everything else of it stays."""
    scene = load(text, folder)
    for path, value in changes.items():
        scene[path] = value
    return scene.to_toml()


def display(scene):
    """Where the display stands, also where the scene leaves that out: position, rotation, size."""
    placed = scene.display
    return list(placed.position), list(placed.rotation), list(placed.size)


def resolution(scene):
    """The display's pixels: width, height."""
    return tuple(scene.display.resolution)


def index(scene, element):
    """The refractive index of an element, of any kind of glass, for green light."""
    return scene.index(element)


def at_eye(scene, eye):
    """The scene for another viewpoint."""
    moved = scene.copy()
    moved["viewpoint.position"] = list(eye)
    return moved


def solve(scene, size):
    """The map for a display of so many pixels."""
    return scene.map(resolution=size)
