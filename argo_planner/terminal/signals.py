"""Signals that ask the process to end: Ctrl-C (SIGINT), SIGTERM, and a closed terminal (SIGHUP).

This module is imported before anything else, so it imports very little. A signal that is ignored
when the process starts, as with `nohup`, stays ignored.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

if sys.platform == "win32":
    _NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGBREAK)
else:
    _NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AGAIN = 0.01
"""s until an interruption that could not be raised is raised again"""

_Handler = Callable[[int, FrameType | None], object]


class Interrupted(BaseException):
    """A signal that asks the process to end; no Exception, so `except Exception` ignores it."""

    def __init__(self, number: int) -> None:
        super().__init__(f"signal {number}")
        self.status = 128 + number
        """exit status of the process: 128 and the number of the signal, as in shells"""


class SignalWatch:
    """Function that returns True if a signal was received. Holds the signal."""

    def __init__(self) -> None:
        self.received: Interrupted | None = None

    def __call__(self) -> bool:
        return self.received is not None

    def raise_if_received(self) -> None:
        """Raise Interrupted if a signal was received."""
        if self.received is not None:
            raise self.received


def exit_on_signals() -> None:
    """Let a signal end the process at once with a message; for a process that has done nothing."""
    _set_handler(_end)


def ignore_signals() -> None:
    """Ignore signals from now on, as all work is done and the process is ending."""
    for number in _NUMBERS:
        signal.signal(number, signal.SIG_IGN)


def raise_on_signals(watch: SignalWatch) -> None:
    """Let signals raise Interrupted from now on, anywhere in the program, and store it in `watch`.

    The first signal may arrive before this function has returned. A library may turn Interrupted
    into another exception, so code that catches exceptions has to check `watch`.
    """

    def interrupt(number: int, _: FrameType | None) -> None:
        watch.received = Interrupted(number)
        raise watch.received

    def raise_later(unraisable: "sys.UnraisableHookArgs") -> None:
        """Raise a lost Interrupted again soon; Python can't raise it in a destructor."""
        if watch.received is None:
            sys.__unraisablehook__(unraisable)
        elif isinstance(unraisable.exc_value, Interrupted):
            number = unraisable.exc_value.status - 128
            _call_in_main_thread_later(_AGAIN, lambda _, frame: interrupt(number, frame))

    sys.unraisablehook = raise_later
    _set_handler(interrupt)


@contextmanager
def defer_first_signal() -> Iterator[SignalWatch]:
    """Yield a SignalWatch that receives the first signal; the next one acts as before the context.

    In another thread than the main one, no signal is received.
    """
    deferred = SignalWatch()
    before = {number: signal.getsignal(number) for number in _NUMBERS}

    def restore_handlers() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)

    def store_signal(number: int, _: FrameType | None) -> None:
        deferred.received = Interrupted(number)
        restore_handlers()

    try:
        _set_handler(store_signal)
    except ValueError:  # not in the main thread, the only one that may set handlers
        yield deferred
        return
    try:
        yield deferred
    finally:
        restore_handlers()


def _set_handler(handler: _Handler) -> None:
    """Set a handler for signals that are not ignored; raise ValueError outside the main thread."""
    for number in _NUMBERS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)


def _call_in_main_thread_later(seconds: float, handler: _Handler) -> None:
    """Call a function in the main thread after some seconds, as the handler of a signal."""
    if sys.platform == "win32":
        from threading import Timer

        signal.signal(signal.SIGABRT, handler)
        Timer(seconds, signal.raise_signal, (signal.SIGABRT,)).start()
    else:
        signal.signal(signal.SIGALRM, handler)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _end(number: int, _: FrameType | None) -> None:
    with suppress(OSError):
        os.write(2, b"argo: interrupted\n")
    os._exit(128 + number)
