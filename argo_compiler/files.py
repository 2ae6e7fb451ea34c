"""Missions as files: JSON that a person can read, with errors that say where it is wrong."""

import json
from pathlib import Path
from typing import Any, NoReturn

from pydantic import ValidationError

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from argo_compiler.il import Mission
from argo_compiler.migration import VERSION, migrate

MAX_BYTES = 50_000_000
"""Far above any mission (10,000 tasks take 4 MB), far below what would exhaust the memory."""

MAX_EXCERPT = 200
"""characters of the longest source line that an error shows"""


def read_mission(path: Path) -> Mission:
    """The mission in a JSON file (UTF-8, with or without a byte order mark).

    Only its shape is looked at; what it means is for `check`.

    Raises:
        DiagnosticError: the file can't be read or is no mission. Says where: by line and column if
            it is not JSON, by the path of the field (`tasks[3].action`) if it does not fit.
    """
    text = _read_text(path)
    data = _parse(path, text)
    _require_object(path, data)
    migrated = migrate(data)
    _require_version(path, migrated)
    try:
        return Mission.model_validate_json(
            text if migrated is data else json.dumps(migrated), strict=True
        )
    except ValidationError as error:
        findings = [
            _finding("file.wrong-field", f"{_field_path(e['loc'])}: {e['msg']}", _field_hint(e))
            for e in error.errors(include_url=False)
        ]
        raise DiagnosticError(str(path), findings) from None


def write_mission(mission: Mission, path: Path) -> None:
    """Writes a mission as JSON, without the fields that have their default value.

    `read_mission` gives back an equal mission.

    Raises:
        DiagnosticError: the file can't be written.
    """
    data = {"version": mission.version} | mission.model_dump(mode="json", exclude_defaults=True)
    text = json.dumps(data, indent=2, ensure_ascii=False) + "\n"
    try:
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        _refuse(path, "file.unwritable", f"can't be written: {error.strerror}", "choose another")


def _finding(code: str, message: str, hint: str | None) -> Diagnostic:
    return Diagnostic(code=code, severity=Severity.ERROR, message=message, hint=hint)


def _refuse(path: Path, code: str, message: str, hint: str) -> NoReturn:
    raise DiagnosticError(str(path), [_finding(code, message, hint)]) from None


def _read_text(path: Path) -> str:
    if path.is_dir():
        _refuse(path, "file.directory", "is a directory", "name the mission file in it")
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        _refuse(path, "file.missing", "there is no such file", "check the path")
    except OSError as error:
        _refuse(path, "file.unreadable", f"can't be read: {error.strerror}", "check the file")
    if len(content) > MAX_BYTES:
        _refuse(
            path,
            "file.too-large",
            f"is larger than {MAX_BYTES // 1_000_000} MB",
            "a mission file is far smaller: is this the right file?",
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        _refuse(
            path,
            "file.not-text",
            f"is not UTF-8 text: byte {error.start} is 0x{content[error.start]:02x}",
            "save it as UTF-8, or name the mission's JSON file",
        )
    if "\0" in text:
        _refuse(path, "file.not-text", "is a binary file", "name the mission's JSON file")
    return text


def _parse(path: Path, text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        line = text.split("\n")[error.lineno - 1].rstrip("\r")
        finding = Diagnostic(
            code="file.not-json",
            severity=Severity.ERROR,
            message=f"is not JSON: {error.msg}",
            span=Span(line=error.lineno, column=error.colno),
            excerpt=line if len(line) <= MAX_EXCERPT else None,
            hint="correct the file at the mark",
        )
        raise DiagnosticError(str(path), [finding]) from None
    except RecursionError:
        _refuse(path, "file.too-deep", "is nested too deeply", "no mission is: check the file")
    except ValueError as error:  # an integer of thousands of digits
        _refuse(path, "file.not-json", f"is not usable JSON: {error}", "correct the number")


def _require_object(path: Path, data: Any) -> None:
    if not isinstance(data, dict):
        _refuse(
            path,
            "file.not-a-mission",
            "is not a mission: the JSON is no object",
            f'a mission begins with {{"version": {VERSION}, "tasks": [',
        )


def _require_version(path: Path, data: dict[str, Any]) -> None:
    version = data.get("version", VERSION)
    if version != VERSION or isinstance(version, bool):
        _refuse(
            path,
            "file.unsupported-version",
            f"has version {json.dumps(version)} of the mission format",
            f"this Argo reads versions up to {VERSION}: use a newer Argo or save the mission again",
        )


def _field_path(location: tuple[int | str, ...]) -> str:
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return "".join(steps).removeprefix(".") or "the file"


def _field_hint(error: Any) -> str | None:
    if error["type"] == "extra_forbidden":
        return "the mission format has no such field: check its spelling or remove it"
    return None
