"""Single keys and lines of text from the terminal.

The terminal itself edits and echoes a line; a key is read without Enter and not echoed. The mode
of the terminal changes only while a key is waited for, so any end of the program leaves it usable.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

INPUT_ENDED = ""
"""key and line that stand for the end of the input"""
_END = "\x04"
"""key by which a person ends the input"""
_END_OF_LINES = "\0"
"""what Linux hands over of the same key, if it was typed before the mode changed"""
_LONGEST_CHARACTER = 4
"""bytes"""
_MOST_BYTES = 100_000
"""of a line; more is cut"""


if sys.platform == "win32":
    import msvcrt

    def read_key() -> str:
        """Return the next key, or INPUT_ENDED. Raises KeyboardInterrupt on Ctrl-C."""
        key = msvcrt.getwch()
        if key == "\x03":
            raise KeyboardInterrupt
        if key in "\x00\xe0":  # a function key, which has two characters
            msvcrt.getwch()
            return "\x1b"
        return INPUT_ENDED if key in (_END, "\x1a") else key

else:
    import select
    import termios

    def read_key() -> str:
        """Return the next key, or INPUT_ENDED."""
        fd = sys.stdin.fileno()
        with _single_keys(fd):
            key = _read_character(fd)
            if key == "\x1b":  # a function key, whose other characters follow at once
                while select.select([fd], [], [], 0.02)[0] and os.read(fd, 1):
                    pass
        return INPUT_ENDED if key in (_END, _END_OF_LINES) else key

    @contextmanager
    def _single_keys(fd: int) -> Iterator[None]:
        """Let the terminal hand over keys at once in this context, without showing them."""
        before = termios.tcgetattr(fd)
        changed = [*before[:6], list(before[6])]
        changed[3] &= ~(termios.ICANON | termios.ECHO)
        changed[6][termios.VMIN], changed[6][termios.VTIME] = 1, 0
        try:
            termios.tcsetattr(fd, termios.TCSADRAIN, changed)
            yield
        finally:
            termios.tcsetattr(fd, termios.TCSADRAIN, before)

    def _read_character(fd: int) -> str:
        """Read a character of one byte or several."""
        content = b""
        while len(content) < _LONGEST_CHARACTER:
            part = os.read(fd, 1)
            if not part:
                return INPUT_ENDED
            content += part
            try:
                return content.decode()
            except UnicodeDecodeError:
                pass
        return "\ufffd"


def read_line() -> str | None:
    """Return the next line without its end, as the terminal has let a person edit it.

    Returns None if the person ends the input instead.
    """
    content = b""
    while not content.endswith(b"\n") and len(content) < _MOST_BYTES:
        part = os.read(sys.stdin.fileno(), 4096)
        if not part:
            break
        content += part
    if not content:
        return None
    return content.decode(sys.stdin.encoding or "utf-8", "replace").rstrip("\r\n")
