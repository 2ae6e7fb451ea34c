"""Mission files: JSON that people can read, with errors that point to the place in the file."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from argo_compiler.base.errors import reason_text
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import (
    MAX_EXCERPT,
    Diagnostic,
    DiagnosticError,
    Span,
    by_position,
)
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.foreign import ForeignFile, find_foreign_json
from argo_compiler.files.json_places import (
    LONG_NUMBER,
    JsonPath,
    JsonText,
    find_duplicate_keys,
    find_places_or_parents,
    format_path,
)
from argo_compiler.files.loading import (
    FileError,
    FileProblem,
    decode_text,
    read_bytes,
    require_size,
)
from argo_compiler.files.migration import VERSION, copy_with_current_version, newer_fields, upgrade
from argo_compiler.files.mission_data import (
    MAX_FAULTS,
    UnplacedDiagnostic,
    too_deep,
    unplaced,
    validate_mission,
)
from argo_compiler.il import Mission, Task
from argo_compiler.il.subjects import Subjects

MAX_BYTES = 16_000_000
"""Limit far above any mission (10,000 tasks take 4 MB); such a file takes up to 400 MB to read."""

_RECORD_FIELDS = {"mission", "result", "trace"}
"""Fields of a run's record, which has its own versions."""
_MIN_UNKNOWN = 3
"""number of unknown fields from which on an object without tasks is no mission with mistakes"""


@dataclass(frozen=True)
class MissionFile:
    """Mission with the text of its file."""

    mission: Mission
    text: str
    changes: tuple[Diagnostic, ...] = ()
    """warnings about meanings that changed since the file's version, without positions"""

    def diagnostics_with_positions(
        self, diagnostics: Iterable[Diagnostic]
    ) -> tuple[Diagnostic, ...]:
        """Return the diagnostics with their places in the file, found by their subjects.

        The new places replace those in the script from which the mission was imported. A diagnostic
        without a subject loses its place.
        """
        path = Subjects(self.mission).subject_path
        unplaced = (
            UnplacedDiagnostic(d, None if d.subject is None else path(d.subject))
            for d in diagnostics
        )
        return by_position(_add_places(self.text, unplaced))


def read_mission(path: Path) -> Mission:
    """Return the mission in a JSON file, which may be UTF-8 or UTF-16.

    This validates only the file's structure; `check` validates the mission's meaning.

    Raises:
        DiagnosticError: The file can't be read or is not a mission. The diagnostics have the line
            and column.
    """
    return decode_mission(read_mission_bytes(path), str(path)).mission


def read_mission_bytes(path: Path) -> bytes:
    """Return the content of a mission file. Raises DiagnosticError if it can't be read."""
    try:
        return read_bytes(path, Message("mission file"), MAX_BYTES)
    except FileError as error:
        _refuse_file(str(path), error)


def decode_mission(content: bytes, source_name: str) -> MissionFile:
    """Return the mission in a file's content, with the text for the places of later diagnostics.

    Messages call the file `source_name`. Raises DiagnosticError as `read_mission` does.
    """
    try:
        require_size(content, source_name, Message("mission file"), MAX_BYTES)
        text = decode_text(content, source_name, Message("mission file"))
    except FileError as error:
        _refuse_file(source_name, error)
    data, has_repeated_keys = _parse(source_name, text)
    faults = [*_duplicate_keys(text)] if has_repeated_keys else []
    if isinstance(data, list) and (foreign := find_foreign_json(data)):
        _refuse(source_name, text, [_foreign(foreign)])
    if not isinstance(data, dict):
        _refuse(source_name, text, [*faults, _not_a_mission()])
    if _RECORD_FIELDS.issubset(data):
        _refuse(source_name, text, [*faults, _run_record()])
    if foreign := find_foreign_json(data):
        _refuse(source_name, text, [_foreign(foreign)])
    if reason := _why_other_json(data):
        _refuse(source_name, text, [_other_json(reason)])
    current, written_as = copy_with_current_version(data)
    version = current.get("version", VERSION)
    if version != VERSION or isinstance(version, bool):
        _refuse(source_name, text, [*faults, _unsupported_version(version)])
    result = validate_mission(current)
    if isinstance(result, list) or faults:
        _refuse(source_name, text, faults + (result if isinstance(result, list) else []))
    if newer := [_newer_field(written_as, *field) for field in newer_fields(result, written_as)]:
        _refuse(source_name, text, newer[:MAX_FAULTS])
    mission, changes = upgrade(result, written_as)
    return MissionFile(mission, text, changes)


def write_mission(mission: Mission, path: Path) -> None:
    """Write a mission as JSON, without the fields that have their default value.

    `read_mission` returns an equal mission. An existing file is replaced atomically.

    Raises:
        DiagnosticError: The file can't be written.
    """
    try:
        write_atomically(path, mission_text(mission))
    except OSError as error:
        message = Message("the file can't be written: {reason}", reason=reason_text(error))
        _refuse(
            str(path), "", [unplaced("file.unwritable", message, Message("choose another path"))]
        )


def mission_text(mission: Mission) -> str:
    """Return the text that `write_mission` writes."""
    data = {"version": mission.version} | mission.model_dump(mode="json", exclude_defaults=True)
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def _refuse(source_name: str, text: str, faults: Iterable[UnplacedDiagnostic]) -> NoReturn:
    raise DiagnosticError(source_name, _add_places(text, faults)) from None


def _refuse_file(source_name: str, error: FileError) -> NoReturn:
    def refuse(
        code: str, message: str = Message("the file {message}", message=error.message)
    ) -> NoReturn:
        _refuse(source_name, "", [unplaced(code, message, error.hint)])

    match error.problem:
        case FileProblem.MISSING:
            refuse("file.missing")
        case FileProblem.DIRECTORY:
            refuse("file.directory")
        case FileProblem.TOO_LARGE:
            refuse(
                "file.too-large",
                Message("the file is larger than {max_bytes} MB", max_bytes=MAX_BYTES // 1000000),
            )
        case FileProblem.NOT_TEXT:
            refuse("file.not-text")
        case FileProblem.UNREADABLE:
            refuse("file.unreadable")


def _add_places(text: str, faults: Iterable[UnplacedDiagnostic]) -> list[Diagnostic]:
    faults = list(faults)
    paths = [path for _, path in faults if path is not None]
    lines = JsonText(text)
    spans = find_places_or_parents(lines, paths) if paths else {}
    return [
        _with_span(lines, diagnostic, spans[path] if path else None) for diagnostic, path in faults
    ]


def _with_span(lines: JsonText, diagnostic: Diagnostic, span: Span | None) -> Diagnostic:
    excerpt = lines.line_text(span.line) if span else None
    if excerpt is not None and len(excerpt) > MAX_EXCERPT:
        excerpt = None
    return diagnostic.model_copy(update={"span": span, "excerpt": excerpt})


def _parse(source_name: str, text: str) -> tuple[Any, bool]:
    """Return the data in a JSON text, and whether any of its objects has a repeated key."""
    has_repeated_keys = False

    def to_dict(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        nonlocal has_repeated_keys
        data = dict(pairs)
        has_repeated_keys = has_repeated_keys or len(data) < len(pairs)
        return data

    if not text.strip():
        _refuse(
            source_name,
            "",
            [
                unplaced(
                    "file.not-json",
                    Message("the file is empty"),
                    Message("choose a file with a mission"),
                )
            ],
        )
    try:
        return json.loads(text, object_pairs_hook=to_dict), has_repeated_keys
    except json.JSONDecodeError as error:
        lines = JsonText(text)
        diagnostic, _ = unplaced(
            "file.not-json",
            Message("the file is not JSON: {msg}", msg=error.msg),
            Message("correct it at the marked place"),
        )
        span = lines.span(error.pos, error.pos + 1)
        raise DiagnosticError(source_name, [_with_span(lines, diagnostic, span)]) from None
    except RecursionError:
        _refuse(source_name, text, [too_deep()])
    except ValueError:
        message = Message("the file can't be read: {long_number}", long_number=LONG_NUMBER)
        _refuse(
            source_name, text, [unplaced("file.not-json", message, Message("correct the number"))]
        )


def _not_a_mission() -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission",
        Message(
            "the file is not a mission: its JSON is not an object; a mission begins "
            'with {{"version": {version}, "tasks": [',
            version=VERSION,
        ),
        None,
    )


def _why_other_json(data: dict[str, Any]) -> str | None:
    """Return why an object is no mission of Argo, not even one with mistakes; None: it may be."""
    unknown = [name for name in data if name not in Mission.model_fields]
    known = [name for name in data if name in Mission.model_fields and name != "version"]
    many = 2 if not known else _MIN_UNKNOWN
    if len(unknown) >= many and "tasks" not in data:
        return Message("it has {unknown}, but no 'tasks'", unknown=repr(unknown[0][:40]))
    tasks = data.get("tasks")
    if not isinstance(tasks, list) or not tasks or not all(isinstance(t, dict) for t in tasks):
        return None
    names = {name for task in tasks for name in task}
    other = sorted(names - Task.model_fields.keys())
    if other and not names & {"action", "transitions"}:
        return Message("its tasks have {other}, but no 'action'", other=repr(other[0][:40]))
    return None


def _other_json(reason: str) -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission",
        Message("the file is not a mission: {reason}; choose the mission's file", reason=reason),
        None,
    )


def _foreign(foreign: ForeignFile) -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission", Message("the file {message}", message=foreign.message), None
    )


def _run_record() -> UnplacedDiagnostic:
    return unplaced(
        "file.not-a-mission",
        Message("the file is the report of a run, not a mission"),
        Message("choose the mission's file"),
    )


def _unsupported_version(version: object) -> UnplacedDiagnostic:
    text = json.dumps(version)
    is_newer = isinstance(version, int) and version > VERSION and not isinstance(version, bool)
    return unplaced(
        "file.unsupported-version",
        Message(
            "the file has version {part} of the mission format",
            part=text if len(text) < 40 else "...",
        ),
        Message("this Argo reads versions up to {version}: ", version=VERSION)
        + (
            Message("use a newer Argo, or save the mission again")
            if is_newer
            else Message("write one of them")
        ),
        ("version",),
    )


def _newer_field(version: int, path: JsonPath, name: str) -> UnplacedDiagnostic:
    return unplaced(
        "file.wrong-field",
        Message(
            "{format_path}: version {version} of the mission format has no {name}",
            format_path=format_path(path),
            version=version,
            name=name,
        ),
        Message(
            'write "version": {version}; there, a velocity applies to the path to its task',
            version=VERSION,
        ),
        path,
    )


def _duplicate_keys(text: str) -> Iterator[UnplacedDiagnostic]:
    for path, first in find_duplicate_keys(JsonText(text), MAX_FAULTS).items():
        yield unplaced(
            "file.duplicate-key",
            Message(
                "{format_path} is given here again; it was first given at line {line}, "
                "column {column}",
                format_path=format_path(path),
                line=first.line,
                column=first.column,
            ),
            Message("remove one of the two"),
            path,
        )
