"""Subjects of diagnostics: paths into a mission with tasks, groups and reactions by name.

An example is `tasks['MEASURE 4'].transitions[0].target`: a position changes when something is added
before it, a name does not. Names are in single quotes with the escapes of normalised paths in
JSONPath (RFC 9535, 2.7). An item without a unique name, such as the second task of one name, is
identified by its position from 0.
"""

import json
import re

from argo_compiler.base.records import dataclass

_STEP = re.compile(r"\[(\d+)\]|\['((?:[^'\\]|\\.)*)'\]|\.?([^.\[\]']+)", re.S)
_CONTROL = re.compile(r"[\x00-\x1f'\\]")
_ESCAPES = {
    "\b": r"\b", "\t": r"\t", "\n": r"\n", "\f": r"\f", "\r": r"\r", "'": r"\'", "\\": r"\\",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class NamedItem:
    """Step of a path to the item of this name in a list."""

    name: str


SubjectPath = tuple[str | int | NamedItem, ...]
"""fields, positions in lists and names in lists, from the outermost to the innermost"""


def subject_of(field: str, name: str, rest: str = "") -> str:
    """Return the path of a named item in the list `field`, `tasks['A']`, followed by `rest`."""
    return f"{field}['{_CONTROL.sub(_escaped, name)}']{rest}"


def split_subject(text: str) -> SubjectPath:
    """Return the steps of a path that `subject_of` or `format_path` wrote; it is not checked."""
    return tuple(_step(match) for match in _STEP.finditer(text))


def _step(match: re.Match[str]) -> str | int | NamedItem:
    position, name, field = match.groups()
    if position is not None:
        return int(position)
    if name is not None:
        escaped = name.replace(r"\'", "'").replace('"', r"\"")
        return NamedItem(json.loads(f'"{escaped}"', strict=False))
    return field


def _escaped(match: re.Match[str]) -> str:
    character = match[0]
    return _ESCAPES.get(character) or f"\\u{ord(character):04x}"
