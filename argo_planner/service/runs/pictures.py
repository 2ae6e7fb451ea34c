"""The pictures that readings of a run come from."""

import logging
from pathlib import Path

from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.world.world import Shot, World

_log = logging.getLogger(__name__)


def picture_of(folder: Path, checkpoint: int, t: float) -> Path:
    """The file with the picture of what was read at a checkpoint at a time (s)."""
    return folder / f"reading-{checkpoint}-{round(1000 * t)}.png"


class PictureKeeper(Observer):
    """Keeps the last picture of each reading of a run in its folder. Holds the last one taken."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._last: Shot | None = None

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:  # noqa: ARG002
        """Sees the pictures from now on; whoever sees them already goes on to."""
        if not isinstance(setup.world, World):
            return
        before = setup.world.on_shot

        def seen(shot: Shot) -> None:
            self._last = shot
            if before is not None:
                before(shot)

        setup.world.on_shot = seen

    def on_change(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """With a reading, its picture is kept. A run goes on where that is not possible."""
        if entry.reading is None or self._last is None:
            return
        import cv2  # there is a picture, so the sensor has it

        reading, shot, self._last = entry.reading, self._last, None
        path = picture_of(self._folder, reading.checkpoint, reading.t)
        try:
            made, content = cv2.imencode(".png", shot.pixels[..., ::-1])
            if made:
                path.write_bytes(content.tobytes())
        except OSError as error:
            _log.warning("%s: can't be written: %s", path, error.strerror)
