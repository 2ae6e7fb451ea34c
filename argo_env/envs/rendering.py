"""How an environment shows itself: as pictures, or in a window for `render_mode="human"`."""

import os
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import NotFound, Unavailable

_DPI = 100


def check_render_mode(mode: str | None, known: Sequence[str]) -> None:
    """Raises ArgoError if there is no such render mode."""
    if mode is not None and mode not in known:
        raise NotFound(f"no render mode `{mode}`; there are: {', '.join(known)}")


class FigureWindow:
    """A matplotlib window that shows one picture after the other. Close it."""

    def __init__(self, title: str) -> None:
        """Raises ArgoError where there is no display. With the environment variable MPLBACKEND set
        to `agg` the window is drawn in memory, as on a machine that only runs tests."""
        headless = sys.platform.startswith("linux") and not (
            os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
        )
        if headless and os.environ.get("MPLBACKEND", "").lower() != "agg":
            raise Unavailable(
                "render_mode `human` needs a display, and DISPLAY is not set; "
                "use `rgb_array`, or set MPLBACKEND=agg to draw in memory"
            )
        from matplotlib import pyplot

        self._pyplot = pyplot
        self._title = title
        self._figure: Any = None

    def show(self, picture: NDArray[np.uint8]) -> None:
        """Shows a picture, shape (height, width, 3), and lets the window react."""
        if self._figure is None:
            height, width, _ = picture.shape
            # Named afterwards: a figure that is made by a name may be another one's window.
            self._figure = self._pyplot.figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
            self._figure.canvas.manager.set_window_title(self._title)
            axes = self._figure.add_axes((0, 0, 1, 1))
            axes.set_axis_off()
            self._image = axes.imshow(picture)
            self._figure.show() if self._interactive else None
        self._image.set_data(picture)
        self._figure.canvas.draw()
        self._figure.canvas.flush_events()

    def close(self) -> None:
        """Closes the window."""
        if self._figure is not None:
            self._pyplot.close(self._figure)
            self._figure = None

    @property
    def _interactive(self) -> bool:
        return str(self._pyplot.get_backend()).lower() != "agg"


class Rendering:
    """What environments have in common that draw a picture of themselves."""

    render_mode: str | None
    _title: str
    """of the window"""
    _window: FigureWindow | None = None

    def render(self) -> NDArray[np.uint8] | None:
        """A picture, shape (height, width, 3); with `human` it is in a window."""
        if self.render_mode is None:
            return None
        picture = self._picture()
        if self.render_mode == "rgb_array":
            return picture
        self._window = self._window or FigureWindow(self._title)
        self._window.show(picture)
        return None

    def close(self) -> None:
        """Closes the window."""
        if self._window:
            self._window.close()
            self._window = None

    def _picture(self) -> NDArray[np.uint8]:
        raise NotImplementedError

    def _show(self) -> None:
        """Brings the window up to date, if there is one."""
        if self.render_mode == "human":
            self.render()
