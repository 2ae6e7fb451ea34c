"""Validation of a mission file's data with bounded effort, however many errors there are.

A file of 16 MB may contain millions of errors, and pydantic would describe each of them. So
the lists of a mission are validated in portions, until a limited number of errors has been found.
"""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.files.fields import unknown_field_hint
from argo_compiler.files.json_places import JsonPath, format_path
from argo_compiler.il import Group, Mission, Reaction, Task

MAX_FAULTS = 100
"""Largest number of errors that are reported for one file."""

MAX_ITEM = 300_000
"""Largest size of one task, group or reaction, and of all other fields together, in characters."""

_LISTS: dict[str, TypeAdapter[Any]] = {
    "tasks": TypeAdapter(tuple[Task, ...]),
    "groups": TypeAdapter(tuple[Group, ...]),
    "reactions": TypeAdapter(tuple[Reaction, ...]),
}


class UnplacedDiagnostic(NamedTuple):
    """Diagnostic without a place in the file, and the path of the value that it is about."""

    diagnostic: Diagnostic
    path: JsonPath | None


def unplaced(
    code: str, message: str, hint: str | None, path: JsonPath | None = None
) -> UnplacedDiagnostic:
    """Return an error about the value at the path; None stands for the whole file."""
    subject = None if path is None else format_path(path)
    return UnplacedDiagnostic(diagnostic_of(code, message, hint, subject), path)


def too_deep() -> UnplacedDiagnostic:
    """Return the error for data that are nested too deeply for the program's stack."""
    return unplaced(
        "file.too-deep",
        Message("the file is nested too deeply"),
        Message("no mission needs that: check the file"),
    )


def validate_mission(data: dict[str, Any]) -> Mission | list[UnplacedDiagnostic]:
    """Return the mission in data of the current version, or the errors in the data."""
    lists = {name: data[name] for name in _LISTS if isinstance(data.get(name), list)}
    header = {name: value for name, value in data.items() if name not in lists}
    try:
        mission, faults = _validate_header(header)
        items: dict[str, tuple[Model, ...]] = {}
        for name, values in lists.items():
            items[name], list_faults = _validate_list(name, values, MAX_FAULTS - len(faults))
            faults += list_faults
    except RecursionError:
        return [too_deep()]
    return faults or mission.model_copy(update=items)


def _validate_header(header: dict[str, Any]) -> tuple[Mission, list[UnplacedDiagnostic]]:
    text = json.dumps(header)
    if len(text) > MAX_ITEM:
        return Mission(), [
            _too_large(Message("the mission without its tasks, groups and reactions"), None)
        ]
    try:
        # From JSON: only then pydantic is strict about numbers and accepts values of enumerations.
        return Mission.model_validate_json(text, strict=True), []
    except ValidationError as error:
        return Mission(), list(_faults(error, (), 0))


def _validate_list(
    name: str, values: list[Any], max_faults: int
) -> tuple[tuple[Model, ...], list[UnplacedDiagnostic]]:
    """Return the items of one of the mission's lists, and the errors in it.

    `name` is that of the list. If there are errors, faultless items may be missing, too: the items
    are of no use then. The validation stops after `max_faults` errors.
    """
    items: list[Model] = []
    faults: list[UnplacedDiagnostic] = []
    for start, text in _portions(values):
        if len(faults) >= max_faults:
            break
        if len(text) > MAX_ITEM + 2:
            faults.append(_too_large(format_path((name, start)), (name, start)))
            continue
        try:
            items += _LISTS[name].validate_json(text, strict=True)
        except ValidationError as error:
            faults += _faults(error, (name,), start)
    return tuple(items), faults[:max_faults]


def _portions(values: list[Any]) -> Iterator[tuple[int, str]]:
    """Yield portions of the values as JSON lists, each after the position of its first value.

    A JSON list is not longer than MAX_ITEM characters, unless it has only one value.
    """
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


def _too_large(part: str, path: JsonPath | None) -> UnplacedDiagnostic:
    return unplaced(
        "file.too-large",
        Message("{part} is longer than {max_item} characters", part=part, max_item=MAX_ITEM),
        Message("no mission needs that much: check the file"),
        path,
    )


def _faults(
    error: ValidationError, list_path: JsonPath, first: int
) -> Iterator[UnplacedDiagnostic]:
    """Yield pydantic's errors in a portion of a list of the mission, with paths in the mission.

    `list_path` is the path of the list, and `first` the position of the portion's first item.
    `list_path` is empty for the mission without its lists.
    """
    for fault in error.errors(include_url=False, include_input=False)[:MAX_FAULTS]:
        if fault["type"] == "json_invalid":
            if "recursion" in fault["msg"]:
                yield too_deep()
            else:  # a character that JSON allows and Unicode does not
                message = re.sub("^Invalid JSON: (.*) at line .*", r"\1", fault["msg"])
                where = format_path((*list_path, first)) if list_path else Message("the file")
                yield unplaced(
                    "file.not-json",
                    Message(
                        "{where} or a part after it is not usable JSON: {message}",
                        where=where,
                        message=message,
                    ),
                    Message("correct the character"),
                )
            continue
        path = fault["loc"]
        if list_path and path and isinstance(path[0], int):
            path = (*list_path, path[0] + first, *path[1:])
        message, hint = fault["msg"][:1].lower() + fault["msg"][1:], None
        if fault["type"] == "extra_forbidden":
            message, hint = (
                Message("the mission format has no such field"),
                unknown_field_hint(Mission, path),
            )
        where = format_path(path) or Message("the file")
        yield unplaced("file.wrong-field", f"{where}: {message}", hint, path)
