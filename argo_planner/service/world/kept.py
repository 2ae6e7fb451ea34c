"""The obstacles that people have put on a site, kept on disk."""

import os
from pathlib import Path

from pydantic import Field, ValidationError

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.model import Model
from argo_env.files.checked_lines import sync_folder
from argo_planner.service.core.refusals import StaleRevision
from argo_planner.service.world.obstacles import Obstacle

_FILE = "obstacles.json"


class ObstacleList(Model):
    """The obstacles on a site, and how often they have changed."""

    revision: int = Field(default=1, ge=1)
    obstacles: tuple[Obstacle, ...] = ()


class KeptObstacles:
    """The obstacles of a folder. Holds how they are; one thread at a time may change them."""

    def __init__(self, folder: Path) -> None:
        """Raises Unavailable if they can't be read."""
        self._path = folder / _FILE
        self.present = ObstacleList()
        if not os.path.lexists(self._path):
            return
        try:
            file = os.open(self._path, os.O_RDONLY | os.O_NOFOLLOW)
            with open(file, "rb") as kept:
                self.present = ObstacleList.model_validate_json(kept.read())
        except (OSError, ValidationError) as error:
            raise Unavailable(
                f"{self._path}: the obstacles can't be read: {error}; mend the file, or remove it"
            ) from None

    def replace(self, obstacles: tuple[Obstacle, ...], made_on: int | None) -> ObstacleList:
        """Puts these in the place of all that there are. When this returns, it is on disk.

        Raises StaleRevision if they have changed since the revision `made_on`, and Unavailable if
        they can't be written.
        """
        if made_on is not None and made_on != self.present.revision:
            raise StaleRevision(made_on, self.present.revision)
        changed = ObstacleList(revision=self.present.revision + 1, obstacles=obstacles)
        draft = self._path.with_name(f"{_FILE}.new")
        try:
            draft.unlink(missing_ok=True)
            file = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
            with open(file, "wb") as new:
                new.write(changed.model_dump_json(indent=1).encode())
                new.flush()
                os.fsync(new.fileno())
            draft.replace(self._path)
            sync_folder(self._path.parent)
        except OSError as error:
            raise Unavailable(f"{self._path}: can't be written: {error.strerror}") from error
        self.present = changed
        return changed
