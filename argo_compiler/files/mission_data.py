"""From the data in a JSON file to a mission, with bounded effort however wrong the data are.

A file of 50 MB may hold tens of millions of faults, each of which pydantic would describe. So the
lists of a mission are validated in portions, and no further than some faults have been found.
"""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.files.fields import field_hint
from argo_compiler.files.json_places import JsonPath, format_path
from argo_compiler.il import Group, Mission, Reaction, Task

MAX_FAULTS = 100
"""that are looked for in one file"""

MAX_ITEM = 300_000
"""characters of one task, group or reaction, and of all else together"""

_LISTS: dict[str, TypeAdapter[Any]] = {
    "tasks": TypeAdapter(tuple[Task, ...]),
    "groups": TypeAdapter(tuple[Group, ...]),
    "reactions": TypeAdapter(tuple[Reaction, ...]),
}


class UnplacedDiagnostic(NamedTuple):
    """A diagnostic that has no place yet, and the path of what it is about."""

    diagnostic: Diagnostic
    path: JsonPath | None


def unplaced(
    code: str, message: str, hint: str | None, path: JsonPath | None = None
) -> UnplacedDiagnostic:
    """An error about what is at the path; None: about the whole file."""
    subject = None if path is None else format_path(path)
    return UnplacedDiagnostic(diagnostic_of(code, message, hint, subject), path)


def too_deep() -> UnplacedDiagnostic:
    """The fault of data that are nested deeper than a program's stack."""
    return unplaced("file.too-deep", "is nested too deeply", "no mission is: check the file")


def to_mission(data: dict[str, Any]) -> Mission | list[UnplacedDiagnostic]:
    """The mission that the data of the present version describe, or what is wrong with them."""
    lists = {name: data[name] for name in _LISTS if isinstance(data.get(name), list)}
    header = {name: value for name, value in data.items() if name not in lists}
    try:
        read, faults = _read_header(header)
        items: dict[str, tuple[Model, ...]] = {}
        for name, values in lists.items():
            items[name], found = _read_list(name, values, MAX_FAULTS - len(faults))
            faults += found
    except RecursionError:
        return [too_deep()]
    return faults or read.model_copy(update=items)


def _read_header(header: dict[str, Any]) -> tuple[Mission, list[UnplacedDiagnostic]]:
    text = json.dumps(header)
    if len(text) > MAX_ITEM:
        return Mission(), [_too_large("what is no task, group or reaction", None)]
    try:
        # As JSON: only then is pydantic strict about numbers and takes the values of enumerations.
        return Mission.model_validate_json(text, strict=True), []
    except ValidationError as error:
        return Mission(), list(_faults(error, (), 0))


def _read_list(
    name: str, values: list[Any], most: int
) -> tuple[tuple[Model, ...], list[UnplacedDiagnostic]]:
    """The items of a list, as far as there were no more than `most` faults in them."""
    items: list[Model] = []
    faults: list[UnplacedDiagnostic] = []
    for start, text in _portions(values):
        if len(faults) >= most:
            break
        if len(text) > MAX_ITEM + 2:
            faults.append(_too_large(format_path((name, start)), (name, start)))
            continue
        try:
            items += _LISTS[name].validate_json(text, strict=True)
        except ValidationError as error:
            faults += _faults(error, (name,), start)
    return tuple(items), faults[:most]


def _portions(values: list[Any]) -> Iterator[tuple[int, str]]:
    """The values as JSON lists no longer than MAX_ITEM or one value, and where each begins."""
    texts: list[str] = []
    length = start = 0
    for i, value in enumerate(values):
        text = json.dumps(value)
        if texts and length + len(text) >= MAX_ITEM:
            yield start, f"[{','.join(texts)}]"
            texts, length, start = [], 0, i
        texts.append(text)
        length += len(text) + 1
    if texts:
        yield start, f"[{','.join(texts)}]"


def _too_large(what: str, path: JsonPath | None) -> UnplacedDiagnostic:
    return unplaced(
        "file.too-large",
        f"{what}: takes more than {MAX_ITEM} characters",
        "no mission's does: check the file",
        path,
    )


def _faults(error: ValidationError, around: JsonPath, first: int) -> Iterator[UnplacedDiagnostic]:
    """The faults in a portion of the list `around`, which begins with its item `first`."""
    for found in error.errors(include_url=False, include_input=False)[:MAX_FAULTS]:
        if found["type"] == "json_invalid":
            if "recursion" in found["msg"]:
                yield too_deep()
            else:  # a character that JSON allows and Unicode does not
                message = re.sub("^Invalid JSON: (.*) at line .*", r"\1", found["msg"])
                where = format_path((*around, first)) if around else "the file"
                yield unplaced(
                    "file.not-json",
                    f"{where} or what follows is not usable JSON: {message}",
                    "correct the character",
                )
            continue
        path = found["loc"]
        if around and path and isinstance(path[0], int):
            path = (*around, path[0] + first, *path[1:])
        message, hint = found["msg"][:1].lower() + found["msg"][1:], None
        if found["type"] == "extra_forbidden":
            message, hint = "the mission format has no such field", field_hint(Mission, path)
        where = format_path(path) or "the file"
        yield unplaced("file.wrong-field", f"{where}: {message}", hint, path)
