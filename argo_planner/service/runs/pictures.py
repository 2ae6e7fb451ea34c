"""Pictures from which the readings of a run were made."""

import logging
from pathlib import Path

from argo_env.run.log import Entry
from argo_env.run.machine import Machine
from argo_env.run.observer import Observer
from argo_env.run.run_setup import RunSetup
from argo_env.run.spec import RunSpec
from argo_env.world.world import Shot, World

_log = logging.getLogger(__name__)


def picture_path(folder: Path, checkpoint: int, t: float) -> Path:
    """Return the path of the picture for a checkpoint's reading at simulated time `t`, in s."""
    return folder / f"reading-{checkpoint}-{round(1000 * t)}.png"


class PictureWriter(Observer):
    """Observer that writes the picture of each reading into the folder of the run.

    Holds the last picture that was taken.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._last: Shot | None = None

    def on_begin(self, setup: RunSetup, spec: RunSpec) -> None:  # noqa: ARG002
        """Register to receive the sensor's pictures; an earlier receiver still gets them, too."""
        if not isinstance(setup.world, World):
            return
        earlier_receiver = setup.world.on_shot

        def receive_shot(shot: Shot) -> None:
            self._last = shot
            if earlier_receiver is not None:
                earlier_receiver(shot)

        setup.world.on_shot = receive_shot

    def on_entry_applied(self, entry: Entry, machine: Machine) -> None:  # noqa: ARG002
        """Write the picture of the entry's reading; a file that can't be written is only logged."""
        if entry.reading is None or self._last is None:
            return
        import cv2  # there is a picture, so the sensor has imported it

        reading, shot, self._last = entry.reading, self._last, None
        path = picture_path(self._folder, reading.checkpoint, reading.t)
        try:
            encoded, content = cv2.imencode(".png", shot.pixels[..., ::-1])
            if encoded:
                path.write_bytes(content.tobytes())
        except OSError as error:
            _log.warning("%s: can't be written: %s", path, error.strerror)
