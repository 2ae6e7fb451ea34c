"""An assistant that is a command: it reads the request on standard input, and writes an answer."""

import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from typing import IO

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.message import Message

_CHUNK = 65536
_LAST_WORDS = 300
"""characters of its standard error that a message shows"""
_CLOSING_S = 0.5
"""for what a command has written when it has ended, and its children still hold its output"""


def ask_command(command: str, request: str, max_bytes: int, timeout_s: float) -> bytes:
    """Run a command with the request as its input, and return its output.

    All of its processes are ended when it has answered, takes too long or writes too much.

    Raises:
        Invalid: The command can't be read as one, or writes too much.
        Unavailable: It can't be started, fails, or takes too long.
    """
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise Invalid(
            Message("`{command}` is no command: {error}", command=command, error=error)
        ) from None
    if not words:
        raise Invalid("the command is empty")
    try:
        process = subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Unavailable(Message("it can't be started: {reason}", reason=reason)) from None
    try:
        return _converse(process, request.encode("utf-8"), max_bytes, timeout_s)
    finally:
        _end(process)


def _converse(
    process: "subprocess.Popen[bytes]", request: bytes, max_bytes: int, timeout_s: float
) -> bytes:
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    output, errors = _Collector(process.stdout, max_bytes), _Collector(process.stderr, _CHUNK)
    threading.Thread(target=_write, args=(process.stdin, request), daemon=True).start()
    deadline = time.monotonic() + timeout_s
    while not output.done.wait(0.05):
        if time.monotonic() > deadline:
            raise Unavailable(
                Message("it has not answered within {timeout_s:g} s", timeout_s=timeout_s)
            )
        if process.poll() is not None:
            output.done.wait(_CLOSING_S)
            break
    if output.overflow:
        raise Invalid(Message("the answer is larger than {max_bytes:,} bytes", max_bytes=max_bytes))
    try:
        status = process.wait(max(0.0, deadline - time.monotonic()) + _CLOSING_S)
    except subprocess.TimeoutExpired:
        raise Unavailable(
            Message("it has not ended within {timeout_s:g} s", timeout_s=timeout_s)
        ) from None
    if status != 0:
        errors.done.wait(_CLOSING_S)
        raise Unavailable(
            Message(
                "it has failed with status {status}{last}",
                status=status,
                last=_last_words(errors.content),
            )
        )
    return bytes(output.content)


class _Collector:
    """Reads a stream in a thread of its own, up to a limit."""

    def __init__(self, stream: IO[bytes], max_bytes: int) -> None:
        self.content = bytearray()
        self.done = threading.Event()
        self.overflow = False
        self._max_bytes = max_bytes
        threading.Thread(target=self._run, args=(stream,), daemon=True).start()

    def _run(self, stream: IO[bytes]) -> None:
        with suppress(OSError, ValueError), stream:
            while part := os.read(stream.fileno(), _CHUNK):
                if len(self.content) + len(part) > self._max_bytes:
                    self.overflow = True
                    break
                self.content += part
        self.done.set()


def _write(stream: IO[bytes], request: bytes) -> None:
    with suppress(OSError, ValueError):  # the command may end without reading
        stream.write(request)
    with suppress(OSError, ValueError):
        stream.close()


def _last_words(errors: bytearray) -> str:
    """Return the last line of standard error for a message."""
    lines = errors.decode("utf-8", "replace").strip().splitlines()
    if not lines:
        return ""
    shown = "".join(c if c.isprintable() else " " for c in lines[-1].strip())
    return f": {shown[:_LAST_WORDS]}"


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a command and what it has started."""
    with suppress(OSError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
    with suppress(subprocess.TimeoutExpired):
        process.wait(_CLOSING_S)
