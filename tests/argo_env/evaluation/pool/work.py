"""Functions that workers call in tests of the pool; workers can import them."""

import os
import signal
import time
from pathlib import Path


def square(number: int) -> int:
    return number * number


def fail_on_seven(number: int) -> int:
    if number % 10 == 7:
        raise ValueError(f"no {number}")
    return number


def die_on_500(number: int) -> int:
    """Kill the worker at each attempt of number 500; return any other number."""
    if number == 500:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_once(marked: tuple[str, int]) -> int:
    """Kill the worker at the first attempt of numbers 0 to 2, which files in the folder record."""
    folder, number = marked
    if number < 3:
        mark = Path(folder) / str(number)
        if not mark.exists():
            mark.touch()
            os._exit(9)
    return number


def not_sendable(number: int) -> object:
    """Return a function, which can't be pickled, for every tenth number; else the number."""
    return (lambda: number) if number % 10 == 7 else number


def worker_id(number: int) -> int:  # noqa: ARG001
    time.sleep(0.02)
    return os.getpid()
