"""Notes and scripts of imports, stored next to the mission plans.

A plan does not depend on its notes: notes that can't be read or written are left out.
"""

import logging
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import NotFound, Unavailable
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.files.atomic_write import write_atomically
from argo_env.files.checked_files import checked_json
from argo_env.files.folders import make_private_folder
from argo_planner.service.storage.stored_files import read_stored, remove_if_empty

_log = logging.getLogger(__name__)
MOST_NOTES = 200
MAX_SCRIPT_LENGTH = 1_000_000
"""characters of a script; of a longer one only the notes are stored"""


class _Notes(Model):
    revision: int
    notes: tuple[Diagnostic, ...] = ()
    script: str = ""


def store_import_notes(
    folder: Path,
    plan: str,
    revision: int,
    notes: tuple[Diagnostic, ...],
    script: str | None = None,
) -> None:
    """Store the notes and the script of the import that made a revision of a plan.

    They replace those of earlier imports. `script` is None if something else was imported.
    """
    path = _path(folder, plan)
    try:
        make_private_folder(path.parent)
        text = script if script is not None and len(script) <= MAX_SCRIPT_LENGTH else ""
        stored = _Notes(revision=revision, notes=notes[:MOST_NOTES], script=text)
        write_atomically(path, checked_json(stored.model_dump_json()), private=True)
    except OSError as error:
        remove_if_empty(path.parent)
        _log.warning("%s: can't be written: %s", path, error.strerror)


def load_import_notes(folder: Path, plan: str) -> tuple[int, tuple[Diagnostic, ...]]:
    """Return the revision number and the notes of the last import.

    The result is 0 and () if no import is stored, or its file can't be read, which gives a warning.
    """
    stored = _load(folder, plan)
    return stored.revision, stored.notes


def load_imported_script(folder: Path, plan: str) -> tuple[int, str]:
    """Return the revision number and the script of the last import; the script may be empty.

    The result is 0 and an empty text where `load_import_notes` returns no notes.
    """
    stored = _load(folder, plan)
    return stored.revision, stored.script


def _load(folder: Path, plan: str) -> _Notes:
    try:
        return read_stored(_Notes, _path(folder, plan), Message("import the mission again"))
    except NotFound:
        return _Notes(revision=0)
    except Unavailable as error:
        _log.warning("the notes of an import can't be read: %s", error)
        return _Notes(revision=0)


def delete_import_notes(folder: Path, plan: str) -> None:
    """Delete the notes of a plan, if there are any."""
    with suppress(OSError):
        _path(folder, plan).unlink()


def _path(folder: Path, plan: str) -> Path:
    return folder / "notes" / f"{plan}.json"
