"""Signals that ask the process to end: Ctrl-C (SIGINT), SIGTERM, and a closed terminal (SIGHUP).

Imported before anything else, so it brings next to nothing. A signal that whoever started the
process has it ignore, as `nohup` does, stays ignored.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AGAIN = 0.01
"""s until an interruption that was lost is tried again"""

_Handler = Callable[[int, FrameType | None], object]


class Interrupted(BaseException):
    """A signal asks the process to end. No Exception, so that nobody takes it for an error."""

    def __init__(self, number: int) -> None:
        super().__init__(f"signal {number}")
        self.status = 128 + number
        """that the process exits with, as shells tell it"""


class SignalWatch:
    """Whether a signal has come. Holds it."""

    def __init__(self) -> None:
        self.came: Interrupted | None = None

    def __call__(self) -> bool:
        return self.came is not None

    def require_none(self) -> None:
        """Raises Interrupted if one has come."""
        if self.came is not None:
            raise self.came


def end_at_once() -> None:
    """From now on a signal ends the process with a line: for as long as it has done nothing."""
    _answer(_end)


def ignore_signals() -> None:
    """From now on signals change nothing: for when all is done, and the process is ending."""
    for number in _NUMBERS:
        signal.signal(number, signal.SIG_IGN)


def raise_interrupted(raised: SignalWatch) -> None:
    """Let a signal raise Interrupted from now on, wherever the program is, and note it in `raised`.

    The first one may come before this has returned. A library may make another exception of it, so
    whoever catches one asks `raised`.
    """

    def interrupt(number: int, _: FrameType | None) -> None:
        raised.came = Interrupted(number)
        raise raised.came

    def unraisable(said: "sys.UnraisableHookArgs") -> None:
        """Python can't raise what comes up in a destructor or such, and would print it."""
        if raised.came is None:
            sys.__unraisablehook__(said)
        elif isinstance(said.exc_value, Interrupted):
            number = said.exc_value.status - 128
            signal.signal(signal.SIGALRM, lambda _, frame: interrupt(number, frame))
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)

    sys.unraisablehook = unraisable
    _answer(interrupt)


@contextmanager
def first_signal_deferred() -> Iterator[SignalWatch]:
    """Within the context the first signal is only noted, and what it gives says so; the next one is
    answered as before."""
    deferred = SignalWatch()
    before = {number: signal.getsignal(number) for number in _NUMBERS}

    def restore() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)

    def note(number: int, _: FrameType | None) -> None:
        deferred.came = Interrupted(number)
        restore()

    try:
        _answer(note)
    except ValueError:  # not in the main thread, where signals are answered
        yield deferred
        return
    try:
        yield deferred
    finally:
        restore()


def _answer(handler: _Handler) -> None:
    """Raises ValueError but in the main thread."""
    for number in _NUMBERS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def _end(number: int, _: FrameType | None) -> None:
    with suppress(OSError):
        os.write(2, b"argo: interrupted\n")
    os._exit(128 + number)
