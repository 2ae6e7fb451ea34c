"""Programs in a pseudo terminal, as a person uses them."""

import os
import re
import select
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

from tests.processes import ROOT

_WAIT_S = 60
_UTF8 = 0x4000
"""input flag `IUTF8`, by which Backspace removes a whole letter, as terminals of people have it"""


class Terminal:
    """A program that runs in a pseudo terminal of its own."""

    def __init__(self, *command: object, cwd: Path) -> None:
        import pty
        import termios

        self._fd, inner = pty.openpty()
        mode = termios.tcgetattr(inner)
        mode[0] |= _UTF8
        termios.tcsetattr(inner, termios.TCSANOW, mode)
        self._process = subprocess.Popen(
            [*map(str, command)],
            cwd=cwd,
            stdin=inner,
            stdout=inner,
            stderr=inner,
            env=os.environ | {"PYTHONPATH": str(ROOT), "TERM": "dumb"},
            start_new_session=True,
            preexec_fn=_take_terminal,
        )
        os.close(inner)
        self.output = ""
        """all that the program has shown"""
        self._seen = 0
        self.echoes_at_end = False
        """whether the terminal shows what is typed after the program has ended"""

    def type(self, keys: str) -> None:
        os.write(self._fd, keys.encode())

    def resize(self, rows: int, columns: int) -> None:
        import fcntl
        import struct
        import termios

        fcntl.ioctl(self._fd, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def echoes(self) -> bool:
        """Return True if the terminal shows what is typed, as a shell needs."""
        import termios

        return bool(termios.tcgetattr(self._fd)[3] & termios.ECHO)

    def expect(self, pattern: str) -> str:
        """Wait until new output matches a pattern, and return the output up to its end."""
        deadline = time.monotonic() + _WAIT_S
        while (found := re.compile(pattern).search(self.output, self._seen)) is None:
            assert self._read(deadline), f"{pattern!r} is not in:\n{self.output[self._seen :]}"
        shown = self.output[self._seen : found.end()]
        self._seen = found.end()
        return shown

    def kill(self) -> None:
        """Kill the program, so that it can do nothing any more."""
        self._process.send_signal(signal.SIGKILL)
        self._process.wait(_WAIT_S)

    def end(self) -> int:
        """Wait until the program ends, and return its status."""
        deadline = time.monotonic() + _WAIT_S
        while self._read(deadline):
            pass
        assert time.monotonic() < deadline, f"it still runs:\n{self.output[self._seen :]}"
        status = self._process.wait(_WAIT_S)
        self.echoes_at_end = self.echoes()
        os.close(self._fd)
        return status

    def __enter__(self) -> "Terminal":
        return self

    def __exit__(self, *_: Any) -> None:
        if self._process.poll() is None:
            self.kill()

    def _read(self, deadline: float) -> bool:
        """Read what is shown next; return False if nothing more is coming."""
        ready, _, _ = select.select([self._fd], [], [], max(0, deadline - time.monotonic()))
        if not ready:
            return False
        try:
            part = os.read(self._fd, 65536)
        except OSError:  # the program has ended
            return False
        self.output += part.decode(errors="replace").replace("\r\n", "\n")
        return bool(part)


def _take_terminal() -> None:
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a suite in the background ignores it
