"""Missions as files: JSON that a person can read, with errors that say where it is wrong."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from argo_compiler.diagnostics import (
    MAX_EXCERPT,
    Diagnostic,
    DiagnosticError,
    Span,
    by_place,
)
from argo_compiler.files.json_places import (
    JsonPath,
    JsonText,
    find_duplicates,
    find_places,
    format_path,
)
from argo_compiler.files.migration import VERSION, fields_of_later, migrate, updated
from argo_compiler.files.mission_data import (
    MAX_FAULTS,
    UnplacedDiagnostic,
    to_mission,
    too_deep,
    unplaced,
)
from argo_compiler.files.reading import (
    FileError,
    FileProblem,
    decode_text,
    read_bytes,
    require_size,
)
from argo_compiler.files.writing import write_whole
from argo_compiler.il import Mission
from argo_compiler.il.subjects import Subjects

MAX_BYTES = 50_000_000
"""Far above any mission (10,000 tasks take 4 MB), far below what would exhaust the memory."""

_RECORD = {"mission", "result", "trace"}
"""fields of a run's record, which has a version of its own"""


@dataclass(frozen=True)
class MissionFile:
    """A mission with the text that it was read from."""

    mission: Mission
    text: str
    changes: tuple[Diagnostic, ...] = ()
    """what a file of an older version says that can't be said any more; no places yet"""

    def placed(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """The diagnostics with their places in the file, by their subjects.

        The places that they had are the script's from which the mission was imported.
        """
        path = Subjects(self.mission).path
        faults = (
            UnplacedDiagnostic(f, None if f.subject is None else path(f.subject))
            for f in diagnostics
        )
        return by_place(_placed(self.text, faults))


def read_mission(path: Path) -> Mission:
    """The mission in a JSON file, UTF-8 or UTF-16.

    Only its shape is looked at; what it means is for `check`.

    Raises:
        DiagnosticError: the file can't be read or is no mission; says where, by line and column.
    """
    return decode_mission(read_mission_bytes(path), str(path)).mission


def read_mission_bytes(path: Path) -> bytes:
    """What a mission's file holds. Raises DiagnosticError if it can't be read."""
    try:
        return read_bytes(path, "mission file", MAX_BYTES)
    except FileError as error:
        _refuse_file(str(path), error)


def decode_mission(content: bytes, source_name: str) -> MissionFile:
    """The mission in JSON, with its text, in which the places of later diagnostics can be looked
    up. Messages call it `source_name`. Raises DiagnosticError as `read_mission` does."""
    try:
        require_size(content, source_name, "mission file", MAX_BYTES)
        text = decode_text(content, source_name, "mission file")
    except FileError as error:
        _refuse_file(source_name, error)
    data, repeats = _parse(source_name, text)
    faults = [*_duplicate_keys(text)] if repeats else []
    if not isinstance(data, dict):
        _refuse(source_name, text, [*faults, _not_a_mission()])
    if _RECORD.issubset(data):
        _refuse(source_name, text, [*faults, _a_record()])
    present, written_as = migrate(data)
    version = present.get("version", VERSION)
    if version != VERSION or isinstance(version, bool):
        _refuse(source_name, text, [*faults, _unsupported(version)])
    result = to_mission(present)
    if isinstance(result, list) or faults:
        _refuse(source_name, text, faults + (result if isinstance(result, list) else []))
    if later := [_later(written_as, *field) for field in fields_of_later(result, written_as)]:
        _refuse(source_name, text, later[:MAX_FAULTS])
    mission, changes = updated(result, written_as)
    return MissionFile(mission, text, changes)


def write_mission(mission: Mission, path: Path) -> None:
    """Writes a mission as JSON, without the fields that have their default value.

    `read_mission` gives back an equal mission. A file that was there is replaced as a whole.

    Raises:
        DiagnosticError: the file can't be written.
    """
    try:
        write_whole(path, mission_text(mission))
    except OSError as error:
        message = f"can't be written: {error.strerror}"
        _refuse(str(path), "", [unplaced("file.unwritable", message, "choose another place")])


def mission_text(mission: Mission) -> str:
    """What `write_mission` writes."""
    data = {"version": mission.version} | mission.model_dump(mode="json", exclude_defaults=True)
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def _refuse(source_name: str, text: str, faults: Iterable[UnplacedDiagnostic]) -> NoReturn:
    raise DiagnosticError(source_name, _placed(text, faults)) from None


def _refuse_file(source_name: str, error: FileError) -> NoReturn:
    def refuse(code: str, message: str = error.message) -> NoReturn:
        _refuse(source_name, "", [unplaced(code, message, error.hint)])

    match error.problem:
        case FileProblem.MISSING:
            refuse("file.missing")
        case FileProblem.DIRECTORY:
            refuse("file.directory")
        case FileProblem.TOO_LARGE:
            refuse("file.too-large", f"is larger than {MAX_BYTES // 1_000_000} MB")
        case FileProblem.NOT_TEXT:
            refuse("file.not-text")
        case FileProblem.UNREADABLE:
            refuse("file.unreadable")


def _placed(text: str, faults: Iterable[UnplacedDiagnostic]) -> list[Diagnostic]:
    faults = list(faults)
    paths = [path for _, path in faults if path is not None]
    lines = JsonText(text)
    spans = find_places(lines, paths) if paths else {}
    return [_at(lines, diagnostic, spans[path] if path else None) for diagnostic, path in faults]


def _at(lines: JsonText, diagnostic: Diagnostic, span: Span | None) -> Diagnostic:
    excerpt = lines.line(span.line) if span else None
    if excerpt is not None and len(excerpt) > MAX_EXCERPT:
        excerpt = None
    return diagnostic.model_copy(update={"span": span, "excerpt": excerpt})


def _parse(source_name: str, text: str) -> tuple[Any, bool]:
    """The data in a JSON text, and whether any of its objects has a key twice."""
    repeats = False

    def to_dict(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        nonlocal repeats
        data = dict(pairs)
        repeats = repeats or len(data) < len(pairs)
        return data

    if not text.strip():
        _refuse(source_name, "", [unplaced("file.not-json", "is empty", "name a mission's file")])
    try:
        return json.loads(text, object_pairs_hook=to_dict), repeats
    except json.JSONDecodeError as error:
        lines = JsonText(text)
        diagnostic, _ = unplaced(
            "file.not-json", f"is not JSON: {error.msg}", "correct it at the mark"
        )
        span = lines.span(error.pos, error.pos + 1)
        raise DiagnosticError(source_name, [_at(lines, diagnostic, span)]) from None
    except RecursionError:
        _refuse(source_name, text, [too_deep()])
    except ValueError as error:  # an integer of thousands of digits
        message = f"is not usable JSON: {error}"
        _refuse(source_name, text, [unplaced("file.not-json", message, "correct the number")])


def _not_a_mission() -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission",
        "is not a mission: the JSON is no object",
        f'a mission begins with {{"version": {VERSION}, "tasks": [',
    )


def _a_record() -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission", "is not a mission but the report of a run", "name the mission's file"
    )


def _unsupported(version: object) -> UnplacedDiagnostic:
    shown = json.dumps(version)
    return unplaced(
        "file.unsupported-version",
        f"has version {shown if len(shown) < 40 else '...'} of the mission format",
        f"this Argo reads versions up to {VERSION}: use a newer Argo or save the mission again",
        ("version",),
    )


def _later(version: int, path: JsonPath, name: str) -> UnplacedDiagnostic:
    return unplaced(
        "file.wrong-field",
        f"{format_path(path)}: version {version} of the mission format has no {name}",
        f'write "version": {VERSION}, in which velocities are those of the way to each task',
        path,
    )


def _duplicate_keys(text: str) -> Iterator[UnplacedDiagnostic]:
    for path, first in find_duplicates(JsonText(text), MAX_FAULTS).items():
        yield unplaced(
            "file.duplicate-key",
            f"{format_path(path)} stands here again; it was given at line {first.line}, "
            f"column {first.column}",
            "remove one of the two",
            path,
        )
