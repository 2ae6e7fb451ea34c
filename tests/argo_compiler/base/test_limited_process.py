"""Calls in a process with limits: results, errors, and what exceeds the limits."""

import os
import sys
import time
from typing import NoReturn

import pytest

from argo_compiler.base.errors import Conflict
from argo_compiler.base.limited_process import (
    CallLimits,
    LimitExceeded,
    call_limited,
    limits_for_size,
    process_kept,
)

ENOUGH = CallLimits(20.0, 200_000_000)
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory")


@pytest.fixture(autouse=True, scope="module")
def one_process():
    with process_kept():
        yield


def compute_endlessly() -> NoReturn:
    while True:
        pass


def wait_endlessly() -> NoReturn:
    while True:
        time.sleep(60)


def allocate(size: int) -> int:
    return len(bytes(size))


def refuse() -> NoReturn:
    raise Conflict("no")


def fail() -> NoReturn:
    raise ZeroDivisionError


def crash() -> NoReturn:
    os.abort()


def print_and_return() -> str:
    print("noise")
    os.write(1, b"noise")
    return "result"


def call_inside() -> int:
    return call_limited(CallLimits(0.0, 0), (), os.getpid)


def test_the_result_comes_from_another_process() -> None:
    first = call_limited(ENOUGH, (), os.getpid)
    assert first != os.getpid()
    assert call_limited(ENOUGH, (), os.getpid) == first, "the process is kept"
    assert call_limited(ENOUGH, (), call_inside) == first, "a call inside has the same limits"
    assert call_limited(ENOUGH, ("no.such.module",), print_and_return) == "result"


def test_errors_are_raised_here() -> None:
    with pytest.raises(Conflict, match="no"):
        call_limited(ENOUGH, (), refuse)
    with pytest.raises(ZeroDivisionError) as caught:
        call_limited(ENOUGH, (), fail)
    assert "in fail" in caught.value.__notes__[0], "the place of a defect is not lost"


def test_a_call_that_computes_or_waits_too_long_is_ended() -> None:
    busy = "takes (more than 1 s of processor time|longer than 6 s) to read"  # a busy machine
    with pytest.raises(LimitExceeded, match=busy):
        call_limited(CallLimits(1.0, 200_000_000), (), compute_endlessly)
    with pytest.raises(LimitExceeded, match="longer than 1 s to read"):
        call_limited(CallLimits(0.2, 200_000_000), (), wait_endlessly)
    assert call_limited(ENOUGH, (), abs, -1) == 1, "another process has taken its place"


@on_linux
def test_a_call_that_takes_too_much_memory_is_refused() -> None:
    with pytest.raises(LimitExceeded, match="more than 200 MB of memory to read"):
        call_limited(ENOUGH, (), allocate, 900_000_000)
    assert call_limited(ENOUGH, (), allocate, 100_000_000) == 100_000_000


def test_a_crash_is_reported() -> None:
    with pytest.raises(LimitExceeded, match="of memory to read, or makes its reader crash"):
        call_limited(ENOUGH, (), crash)


def test_large_files_have_more_time_but_no_more_memory() -> None:
    small, large = limits_for_size(12_000), limits_for_size(1_000_000_000)
    assert small.seconds < 11 < 200 < large.seconds
    assert small.memory == large.memory < 500_000_000
