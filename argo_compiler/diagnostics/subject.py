"""How a diagnostic names what it is about: a path whose tasks, groups and reactions go by name.

`tasks['MEASURE 4'].transitions[0].target`: a position changes when something is added before it, a
name does not. Names stand in single quotes with the escapes of normalised paths in JSONPath
(RFC 9535, 2.7). What has no name of its own, as the second task of one name, goes by its position
from 0.
"""

import json
import re
from dataclasses import dataclass

_STEP = re.compile(r"\[(\d+)\]|\['((?:[^'\\]|\\.)*)'\]|\.?([^.\[\]']+)", re.S)
_CONTROL = re.compile(r"[\x00-\x1f'\\]")
_ESCAPES = {
    "\b": r"\b", "\t": r"\t", "\n": r"\n", "\f": r"\f", "\r": r"\r", "'": r"\'", "\\": r"\\",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Named:
    """The step of a path to the item of this name in a list."""

    name: str


SubjectPath = tuple[str | int | Named, ...]
"""fields, positions in lists and names in lists, from the outermost inward"""


def subject_of(field: str, name: str, rest: str = "") -> str:
    """What stands under a name in a list of the mission: `tasks['A']`, and `rest` of the path."""
    return f"{field}['{_CONTROL.sub(_escaped, name)}']{rest}"


def parse_subject(text: str) -> SubjectPath:
    """The steps of a path that `subject_of` or `format_path` wrote."""
    return tuple(_step(found) for found in _STEP.finditer(text))


def _step(found: re.Match[str]) -> str | int | Named:
    position, name, field = found.groups()
    if position is not None:
        return int(position)
    if name is not None:
        written = name.replace(r"\'", "'").replace('"', r"\"")
        return Named(json.loads(f'"{written}"', strict=False))
    return field


def _escaped(found: re.Match[str]) -> str:
    character = found[0]
    return _ESCAPES.get(character) or f"\\u{ord(character):04x}"
