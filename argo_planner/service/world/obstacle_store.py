"""Obstacles that people have placed on a site, stored on disk."""

from contextlib import suppress
from pathlib import Path

from pydantic import Field

from argo_compiler.base.errors import NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import write_draft_and_replace
from argo_env.files.checked_files import checked_json
from argo_planner.service.core.refusals import StaleRevision
from argo_planner.service.storage.stored_files import read_stored
from argo_planner.service.world.obstacles import Obstacle

_FILE = "obstacles.json"
_REMEDY = Message(
    "restore the file from a copy, or delete it; if you have changed it, remove its `checksum`"
)


class ObstacleList(Model):
    """Obstacles on a site, with their revision."""

    revision: int = Field(default=1, ge=1)
    """revision of the obstacles; each change makes the next one"""
    obstacles: tuple[Obstacle, ...] = ()


class ObstacleStore:
    """The obstacles in a folder, in memory and on disk; one thread at a time may change them."""

    def __init__(self, folder: Path) -> None:
        """Read a folder's obstacles, none without a file; raises Unavailable for a bad file."""
        self._path = folder / _FILE
        self.present = ObstacleList()
        with suppress(NotFound):
            self.present = read_stored(ObstacleList, self._path, _REMEDY)

    def replace(self, obstacles: tuple[Obstacle, ...], made_on: int | None) -> ObstacleList:
        """Replace all obstacles on disk and in memory, and return the new list.

        Args:
            obstacles: All obstacles that are to be on the site.
            made_on: Revision that the change is made on; None: any revision.

        Raises:
            StaleRevision: The obstacles have changed since the revision `made_on`.
            Unavailable: The file can't be written.
        """
        if made_on is not None and made_on != self.present.revision:
            raise StaleRevision(made_on, self.present.revision)
        changed = ObstacleList(revision=self.present.revision + 1, obstacles=obstacles)
        draft = self._path.with_name(f"{_FILE}.new")
        content = checked_json(changed.model_dump_json(indent=1)).encode()
        try:
            write_draft_and_replace(draft, self._path, content)
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be written: {reason}", path=self._path, reason=reason_text(error)
                )
            ) from error
        self.present = changed
        return changed
