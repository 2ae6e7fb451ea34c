"""What the pool is given to do in its tests: functions that workers can import."""

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
    """Kills its worker each time."""
    if number == 500:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def die_once(marked: tuple[str, int]) -> int:
    """Kills its worker the first time that it gets one of the first three numbers."""
    folder, number = marked
    if number < 3:
        mark = Path(folder) / str(number)
        if not mark.exists():
            mark.touch()
            os._exit(9)
    return number


def not_sendable(number: int) -> object:
    """Something that can't be sent back, for every tenth number."""
    return (lambda: number) if number % 10 == 7 else number


def who(number: int) -> int:  # noqa: ARG001
    time.sleep(0.02)
    return os.getpid()
