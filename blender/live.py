# SPDX-License-Identifier: GPL-3.0-or-later
"""Live: the map again while things move, coarse at first and in full when they rest.

A timer of Blender's looks at the set-ups a few times a second. It knows no clock of its own: time is an argument, so that tests drive it.
"""

import time

import bpy
from bpy.app.handlers import persistent

from . import compensate, properties, solver, sync

# Seconds between looks, and at rest before the full map is made.
EVERY = 0.05
REST = 0.3

# The display's pixels over the coarse map's, along each side.
COARSE = 4


class Watch:
    """What is known of the set-ups from one look to the next."""

    def __init__(self):
        self.seen = {}
        self.moved = {}

    def look(self, context, now):
        """Compensates what has moved, coarsely, and what has come to rest, in full; what was done, by set-up."""
        done = {}
        for root in properties.roots_in(context.scene):
            if root.midair.live:
                what = self._one(context, root, now)
                if what:
                    done[root.name] = what
        return done

    def _one(self, context, root, now):
        state = fingerprint(context, root)
        coarse = None
        if state != self.seen.get(root.name):
            coarse, self.moved[root.name] = COARSE, now
        elif root.name in self.moved and now - self.moved[root.name] >= REST:
            coarse = 1
            del self.moved[root.name]
        if coarse is None:
            return None
        own = root.midair
        try:
            compensate.compensate(context, root, coarse)
            own.said = ""
        except solver.errors() as error:
            # It is told once, in the panel; the display keeps what it shows.
            own.said = solver.words(error)
            self.moved.pop(root.name, None)
            coarse = None
        # What the edits brought along is no new movement.
        self.seen[root.name] = fingerprint(context, root)
        return {None: "failed", 1: "full"}.get(coarse, "coarse")


def fingerprint(context, root):
    """All that the map depends on, as it is now."""
    try:
        parts = tuple((thing.name, sync.written(sync.values(thing, root))) for thing in properties.parts(root))
    except solver.Trouble as error:
        parts = str(error)
    own = root.midair
    picture = own.picture.name if own.picture else ""
    return parts, tuple(compensate.eye(context, root)), own.text.as_string(), picture, own.way, own.optimal


_watch = Watch()


def _tick():
    if not any(root.midair.live for scene in bpy.data.scenes for root in properties.roots_in(scene)):
        return None
    if _watch.look(bpy.context, time.monotonic()):
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
    return EVERY


def start():
    """Begins to look, unless that has begun."""
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=EVERY, persistent=True)


@persistent
def _loaded(*_):
    """Maps are not in .blend files: those that a display showed are made again."""
    for root in properties.roots_in(bpy.context.scene):
        if root.midair.formed >= 0.0 and root.midair.way == "MAP":
            try:
                compensate.compensate(bpy.context, root)
            except solver.errors() as error:
                root.midair.said = solver.words(error)
    start()


def register():
    bpy.app.handlers.load_post.append(_loaded)


def unregister():
    bpy.app.handlers.load_post.remove(_loaded)
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
