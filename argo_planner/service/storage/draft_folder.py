"""Folder with the drafts of a service: the text of each script, and what people have decided."""

import logging
import os
import re
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import ArgoError, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.script.documents.document import Document
from argo_compiler.script.drafts.draft import LineDecision
from argo_env.files.checked_files import checked_json
from argo_env.files.folders import make_private_folder
from argo_planner.service.storage.stored_files import (
    read_stored,
    remove_if_empty,
    require_own_id,
)

_log = logging.getLogger(__name__)
DRAFT_ID = r"[0-9a-f]{12}"
"""regular expression for the id of a draft"""
_REMEDY = Message("restore the file from a copy, or delete it and import the script again")


class DraftRecord(Model):
    """A script, and what people have decided on its lines."""

    id: str
    name: str
    """of the mission that it becomes"""
    source_name: str
    """name of the script's file"""
    text: str
    """of the script"""
    document: Document | None = None
    """the document that the text is of; None: it is the text of a file"""
    start_area: int | None = None
    end_area: int | None = None
    decisions: tuple[LineDecision, ...] = ()
    created: datetime
    changed: datetime
    revision: int = 1
    """each request that decides makes the next one"""
    to_confirm: int
    """lines to confirm when it was stored"""
    to_answer: int
    """open lines when it was stored"""


class DraftFolder:
    """Folder with drafts, a file for each."""

    def __init__(self, path: Path, new_id: Callable[[], str]) -> None:
        self._path = path
        self._new_id = new_id

    def free_id(self) -> str:
        """Return an id that no draft has."""
        while os.path.lexists(self._file(id := self._new_id())):
            pass
        return id

    def store(self, draft: DraftRecord) -> None:
        """Store a draft; on return it is on disk. Raises Unavailable if that fails."""
        path = self._file(draft.id)
        try:
            make_private_folder(self._path)
            write_atomically(path, checked_json(draft.model_dump_json()), private=True)
        except OSError as error:
            remove_if_empty(self._path)
            raise Unavailable(
                Message(
                    "the draft can't be stored: {path}: {reason}; nothing was changed",
                    path=path,
                    reason=reason_text(error),
                )
            ) from error

    def load(self, id: str) -> DraftRecord:
        """Return a stored draft; raises NotFound if there is none, Unavailable if it is damaged."""
        try:
            draft = read_stored(DraftRecord, self._file(id), _REMEDY)
        except NotFound:
            raise _no_draft(id) from None
        require_own_id(self._file(id), draft.id, id, _REMEDY)
        return draft

    def load_drafts(self) -> list[DraftRecord]:
        """Return all stored drafts, without those that can't be read."""
        found = []
        for path in self._path.glob("*.json"):
            try:
                found.append(self.load(path.stem))
            except ArgoError as error:
                _log.warning("%s; the draft is left out", error)
        return found

    def delete(self, id: str) -> None:
        """Delete a draft; raises NotFound if there is none, Unavailable if it can't be deleted."""
        try:
            self._file(id).unlink()
        except FileNotFoundError:
            raise _no_draft(id) from None
        except OSError as error:
            raise Unavailable(
                Message("draft {id} can't be deleted: {reason}", id=id, reason=reason_text(error))
            ) from error
        with suppress(OSError):
            remove_if_empty(self._path)

    def _file(self, id: str) -> Path:
        if not re.fullmatch(DRAFT_ID, id):
            raise _no_draft(id)
        return self._path / f"{id}.json"


def _no_draft(id: str) -> NotFound:
    return NotFound(Message("there is no draft {id} here", id=repr(id[:40])))
