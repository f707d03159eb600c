# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements' blocks in a scene file's text: what a value by its path cannot do, because the block itself comes or goes."""

import re

_HEADER = re.compile(r"\s*\[")
_ELEMENT = re.compile(r"\s*\[\[\s*element\s*\]\]")
_OF_ELEMENT = re.compile(r"\s*\[\[?\s*element\s*\.")


def appended(text, element):
    """The text with one more element at its end."""
    lines = ["", "[[element]]"]
    for key, value in element.items():
        lines.append(f"{key} = {_toml(value)}")
    return text.rstrip("\n") + "\n" + "\n".join(lines) + "\n"


def without(text, index):
    """The text without an element's block, counted from 0; the comment right above it goes with it."""
    lines = text.splitlines(keepends=True)
    heads = [number for number, line in enumerate(lines) if _ELEMENT.match(line)]
    first = heads[index]
    last = first + 1
    while last < len(lines) and (not _HEADER.match(lines[last]) or _OF_ELEMENT.match(lines[last])):
        last += 1
    if last < len(lines):
        # What stands above the next block belongs to that one.
        last = _above(lines, last)
    return "".join(lines[: _above(lines, first)] + lines[max(last, first + 1) :])


def _above(lines, number):
    """The first line of the comment right above a line."""
    while number > 0 and lines[number - 1].lstrip().startswith("#"):
        number -= 1
    return number


def _toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{escaped}"'
    return repr(value)
