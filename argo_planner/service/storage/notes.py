"""What imports had to say, kept beside the plans. They are worth little without their plan, and a
plan is worth the same without them: what can't be read or written is left out."""

import logging
from contextlib import suppress
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.files.atomic_write import write_atomically

_log = logging.getLogger(__name__)
MOST_NOTES = 200


class _Notes(Model):
    revision: int
    notes: tuple[Diagnostic, ...] = ()


def keep_notes(folder: Path, plan: str, revision: int, notes: tuple[Diagnostic, ...]) -> None:
    """Keeps what an import said that made a revision of a plan, in place of what was kept."""
    path = _path(folder, plan)
    try:
        path.parent.mkdir(exist_ok=True)
        notes = notes[:MOST_NOTES]
        write_atomically(path, _Notes(revision=revision, notes=notes).model_dump_json())
    except OSError as error:
        _log.warning("%s: can't be written: %s", path, error.strerror)


def read_notes(folder: Path, plan: str) -> tuple[int, tuple[Diagnostic, ...]]:
    """The revision that the last import made, and what it said; 0 where nothing is known."""
    try:
        kept = _Notes.model_validate_json(_path(folder, plan).read_bytes())
    except (OSError, ValidationError):
        return 0, ()
    return kept.revision, kept.notes


def drop_notes(folder: Path, plan: str) -> None:
    """The plan is gone for good."""
    with suppress(OSError):
        _path(folder, plan).unlink()


def _path(folder: Path, plan: str) -> Path:
    return folder / "notes" / f"{plan}.json"
