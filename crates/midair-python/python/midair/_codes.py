"""What the numbers in arrays stand for."""

from enum import IntEnum


class Status(IntEnum):
    """What a map says of a sample: Map.status."""

    OK = 0
    """One image point and one display point belong together, error bound met."""
    FOLDED = 1
    """Several image points share a display pixel (a caustic); one is shown."""
    OUTSIDE = 2
    """No image point asks for the display pixel."""
    BLOCKED = 3
    """Something on the way cuts the path short: the plate's edge."""


class End(IntEnum):
    """How a path ends: Rays.end."""

    FORMED = 0
    """On the display, through the plate: the image point is formed."""
    TOTAL_REFLECTION = 1
    """By total internal reflection, which the scene does not ask to follow."""
    MISSED_PLATE = 2
    """Past the plate."""
    PLATE_BEHIND = 3
    """At the plate's back."""
    MISSED_DISPLAY = 4
    """Past the display, or away from its front."""
    TOO_MANY_INTERACTIONS = 5
    """At the limit of interactions that the scene allows."""


class Action(IntEnum):
    """What happens to a path at a place: Rays.action."""

    NONE = 0
    """Nothing: it begins or ends there."""
    REFRACT = 1
    """It is refracted, by Snell's law."""
    REFLECT = 2
    """It is reflected."""
    PASS = 3
    """It passes a surface inside a solid of higher priority, or between equal media."""
    PLATE = 4
    """It passes the plate."""


class Met(IntEnum):
    """What stands at a place of a path, if it is no element: Rays.met. Elements are numbered from 0."""

    EYE = -1
    PLATE = -2
    DISPLAY = -3
    NOTHING = -4
    """The path has ended."""
