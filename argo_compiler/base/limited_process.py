"""Calls in a separate process with limits of time and memory, to read files from outside.

A file may be made to take a reader any time and any memory. What reads it therefore works in a
process that the system ends. Windows and macOS limit the time, but not the memory.
"""

import os
import pickle
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import IO, Any, NamedTuple, ParamSpec, TypeVar

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.operating_system import limit_processor_time_and_memory, sigint_blocked

P = ParamSpec("P")
T = TypeVar("T")

_BYTES_PER_SECOND = 5_000_000
"""a reader that is slower than this takes longer than its limit for large files"""
_WAIT_FACTOR = 6
"""A busy machine may make a process wait for this many times its processor time."""
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Numerical libraries reserve memory for each of their threads, which counts for the limit."""
_NO_BACKTRACE = {"RUST_BACKTRACE": "0"}
"""Libraries in Rust may wait for ever where there is no memory to print how they came to fail."""
_START = "import sys; sys.path[:] = {path!r}; from {module} import _serve; _serve()"


class CallLimits(NamedTuple):
    """Limits of a call."""

    seconds: float
    """processor time; the call may take six times as long, as other processes work too"""
    memory: int
    """bytes besides those that the process has before"""

    @property
    def total_seconds(self) -> float:
        """Time in s after which the call is ended."""
        return self.seconds * _WAIT_FACTOR


def limits_for_size(size: int, held: int = 0) -> CallLimits:
    """Return the limits to read a file of `size` bytes, of which the reader holds `held` at once.

    A small file has 10 s and 400 MB.
    """
    return CallLimits(10.0 + size / _BYTES_PER_SECOND, 400_000_000 + held)


class LimitExceeded(Invalid):
    """Raised when a call exceeds its limits; the message is what it takes, without a subject."""


class _Work(threading.local):
    """State of this thread: whether its work is limited already, and the process that it keeps."""

    kept: "_Process | None" = None


_work = _Work()
_inside = False
"""whether this process is a limited one"""


def call_limited(
    limits: CallLimits,
    modules: Sequence[str],
    function: Callable[P, T],
    *args: P.args,
    **named: P.kwargs,
) -> T:
    """Call a function in a process with limits, and return its result.

    In a process that has limits already, the function is called directly.

    Args:
        limits: The limits.
        modules: Modules that are imported before the limits apply, if they are installed.
        function: A function of a module, with arguments and a result that can be pickled.
        args: Its arguments.
        named: Its arguments with names.

    Raises:
        LimitExceeded: The function takes longer, takes more memory, or crashes its process.
        Unavailable: The process can't start.
        Exception: The function has raised it.
    """
    if _inside:
        return function(*args, **named)
    request = (limits, modules, function, args, named)
    if _work.kept is not None:
        return _work.kept.call(limits, request)  # type: ignore[no-any-return]
    process = _Process()
    try:
        return process.call(limits, request)  # type: ignore[no-any-return]
    finally:
        process.end()


@contextmanager
def process_kept() -> Iterator[None]:
    """Let all calls of this thread inside the block use the same process, until one kills it."""
    before, _work.kept = _work.kept, _Process()
    try:
        yield
    finally:
        _work.kept.end()
        _work.kept = before


@contextmanager
def limited(limits: CallLimits) -> Iterator[None]:
    """Limit what this process does in the block; it must be one for this only: it may be killed.

    Raises LimitExceeded if it takes too much memory. If it takes too long, the system kills the
    process; `exceeded_limit` then states the reason.
    """
    global _inside
    before, _inside = _inside, True
    os.environ.update(_NO_BACKTRACE)
    try:
        with limit_processor_time_and_memory(limits.seconds, limits.memory):
            yield
    except MemoryError:
        raise LimitExceeded(_too_much_memory(limits)) from None
    finally:
        _inside = before


def exceeded_limit(limits: CallLimits, exit_code: int | None, timed_out: bool) -> LimitExceeded:
    """Return the error for a limited process that has ended without an answer."""
    ended_by = -exit_code if exit_code is not None and exit_code < 0 else 0
    if timed_out:
        return LimitExceeded(
            Message(
                "takes longer than {total_seconds:.0f} s to read",
                total_seconds=limits.total_seconds,
            )
        )
    if ended_by and ended_by == getattr(signal, "SIGXCPU", 0):
        return LimitExceeded(
            Message(
                "takes more than {seconds:.0f} s of processor time to read", seconds=limits.seconds
            )
        )
    if ended_by == getattr(signal, "SIGABRT", None):  # how compiled libraries end without memory
        return LimitExceeded(
            Message(
                "{too_much_memory}, or makes its reader crash",
                too_much_memory=_too_much_memory(limits),
            )
        )
    status = (
        Message("signal {ended_by}", ended_by=ended_by)
        if ended_by
        else Message("status {exit_code}", exit_code=exit_code)
    )
    return LimitExceeded(Message("makes its reader crash ({status})", status=status))


def _too_much_memory(limits: CallLimits) -> str:
    return Message(
        "takes more than {memory} MB of memory to read", memory=limits.memory // 1_000_000
    )


class _Process:
    """Process that carries out calls, one after the other; started by a call if it has ended."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0
        """id of the process that has started it; one that is forked from that can't use it"""

    def call(self, limits: CallLimits, request: object) -> Any:
        """Send a request, and return the result; the errors are those of `call_limited`."""
        process = self._process
        if process is None or self._owner != os.getpid() or process.poll() is not None:
            try:
                self._process, self._owner = process, _ = _start(), os.getpid()
            except OSError as error:
                message = Message(
                    "the process that reads the file can't start: {reason}; try again",
                    reason=reason_text(error),
                )
                raise Unavailable(message) from None
        timed_out = threading.Event()

        def stop() -> None:
            timed_out.set()
            process.kill()

        timer = threading.Timer(limits.total_seconds, stop)
        timer.daemon = True
        try:
            _send(process.stdin, pickle.dumps(request, pickle.HIGHEST_PROTOCOL))
            _receive(process)  # it has loaded the modules
            timer.start()
            content = _receive(process)
        except EOFError:
            self.end()
            raise exceeded_limit(limits, process.returncode, timed_out.is_set()) from None
        except BaseException:  # such as Ctrl-C: what is in the pipes belongs to no later call
            self.end()
            raise
        finally:
            timer.cancel()
        return _result(content)

    def end(self) -> None:
        """Kill the process, if it has started."""
        process, self._process = self._process, None
        if process is None or self._owner != os.getpid():
            return
        process.kill()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(OSError):  # what could not be written any more
                    pipe.close()
        process.wait()


def _start() -> "subprocess.Popen[bytes]":
    start = _START.format(path=[path or os.getcwd() for path in sys.path], module=__name__)
    with sigint_blocked():
        return subprocess.Popen(
            [sys.executable, "-c", start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | _ONE_THREAD,
        )


def _send(pipe: "IO[bytes] | None", content: bytes) -> None:
    """Send bytes after their number. Raises EOFError if the other process has ended."""
    assert pipe is not None
    try:
        pipe.write(len(content).to_bytes(8))
        pipe.write(content)
        pipe.flush()
    except BrokenPipeError:
        raise EOFError from None


def _receive(process: "subprocess.Popen[bytes]") -> bytes:
    """Return the next answer. Raises EOFError if the process has ended instead."""
    assert process.stdout is not None
    return _read(process.stdout)


def _result(answer: bytes) -> Any:
    """Return the result in an answer, or raise the error in it."""
    kind, content = pickle.loads(answer)
    if kind == "raised":
        raise content
    return content


def _read(pipe: "IO[bytes]") -> bytes:
    size = pipe.read(8)
    if len(size) < 8:
        raise EOFError
    content = pipe.read(int.from_bytes(size))
    if len(content) < int.from_bytes(size):
        raise EOFError
    return content


def _serve() -> None:
    """Carry out the calls that come from the process that has started this one."""
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    with suppress(EOFError):
        while True:
            limits, modules, function, args, named = pickle.loads(_read(requests))
            _import_if_installed(modules)
            _send(answers, b"ready")
            _send(answers, _answer(limits, function, args, named))


def _import_if_installed(modules: Sequence[str]) -> None:
    for module in modules:
        with suppress(ImportError):
            import_module(module)


def _answer(limits: CallLimits, function: Callable[..., Any], args: Any, named: Any) -> bytes:
    """Call the function, and return its result or error, pickled."""
    try:
        with limited(limits):
            return pickle.dumps(("done", function(*args, **named)), pickle.HIGHEST_PROTOCOL)
    except ArgoError as error:
        return pickle.dumps(("raised", error))
    except Exception as error:
        error.add_note(f"in a separate process:\n{traceback.format_exc()}")
        return pickle.dumps(("raised", error))
