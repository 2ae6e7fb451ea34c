"""Functions that differ between POSIX systems (Linux, macOS) and Windows.

Signals and the start of worker processes differ too; see `argo_planner.terminal.signals`, which
must not import this package, and `argo_env.worker_processes`.
"""

import math
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform == "win32":
    import _winapi
    import msvcrt
else:
    import fcntl
    import resource

if sys.platform == "win32":
    OPEN_FLAGS = os.O_BINARY | os.O_NOINHERIT
    NO_LINK_FLAGS = OPEN_FLAGS
else:
    OPEN_FLAGS = os.O_CLOEXEC
    """flags for `os.open` with which other programs don't inherit the file, and bytes stay as is"""
    NO_LINK_FLAGS = OPEN_FLAGS | os.O_NOFOLLOW
    """the same, and where the system has that, opening a symbolic link raises OSError"""

_LOCKED_BYTE = 0x7FFF_FFFE
"""position of the byte that Windows locks: other processes can't read or write locked bytes"""
_PERIOD = 1.0  # s between two checks that the parent exists


def try_lock(file: int) -> bool:
    """Lock an open file for this process, and return True; return False if another one locked it.

    The lock ends when the file is closed. Raises OSError if files can't be locked there.
    """
    if sys.platform == "win32":
        position = os.lseek(file, 0, os.SEEK_CUR)
        os.lseek(file, _LOCKED_BYTE, os.SEEK_SET)
        try:
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        finally:
            os.lseek(file, position, os.SEEK_SET)
    else:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
    return True


def _open_private(path: str, flags: int) -> int:
    """Open a file like `os.open`, as the `opener` of `open`; a new one is its owner's alone."""
    return os.open(path, flags | OPEN_FLAGS, 0o600)


def write_draft_and_replace(draft: Path, path: Path, content: bytes) -> None:
    """Write a draft, which only its owner can read and which then replaces `path`, and sync both.

    The draft is in the folder of `path`; what lies there in its place is removed. Raises OSError;
    the old file then stays, and no draft.
    """
    try:
        draft.unlink(missing_ok=True)
        with open(draft, "xb", opener=_open_private) as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, path)
        sync_folder(path.parent)
    except OSError:
        with suppress(OSError):
            draft.unlink(missing_ok=True)
        raise


def sync_content(file: int) -> None:
    """Sync an open file's content and size, but no other properties where the system allows that.

    Raises OSError if that fails.
    """
    if sys.platform == "linux":
        os.fdatasync(file)
    else:
        os.fsync(file)


def sync_folder(folder: Path) -> None:
    """Sync the folder, so that the names of its files are on disk as well.

    No-op on Windows, which can't sync folders. Raises OSError if that fails.
    """
    if sys.platform == "win32":
        return
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)


def raise_open_file_limit(wanted: int) -> None:
    """Raise the limit of open files to `wanted`, as far as the hard limit allows.

    No-op on Windows, which limits sockets by memory only.
    """
    if sys.platform != "win32":
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        limit = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        if soft != resource.RLIM_INFINITY and soft < limit:
            resource.setrlimit(resource.RLIMIT_NOFILE, (limit, hard))


@contextmanager
def limit_processor_time_and_memory(seconds: float, memory: int) -> Iterator[None]:
    """Limit the processor time and the memory that this process takes in the block.

    It is killed after so many seconds of processor time. More than `memory` bytes besides those
    that it has before raise MemoryError, or end it where a library can't handle that; this is so
    on Linux only. No-op on Windows.
    """
    if sys.platform == "win32":
        yield
    else:
        used = resource.getrusage(resource.RUSAGE_SELF)
        limits = {
            resource.RLIMIT_CPU: math.ceil(used.ru_utime + used.ru_stime + seconds),
            resource.RLIMIT_CORE: 0,  # a file as large as the memory, for each killed process
        }
        if sys.platform == "linux":
            pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
            limits[resource.RLIMIT_AS] = pages * resource.getpagesize() + memory
        before = {kind: resource.getrlimit(kind) for kind in limits}
        for kind, limit in limits.items():
            soft, hard = before[kind]
            if soft == resource.RLIM_INFINITY or limit < soft:
                resource.setrlimit(kind, (limit, hard))
        try:
            yield
        finally:
            for kind, previous in before.items():
                resource.setrlimit(kind, previous)


def niceness() -> int:
    """Return the niceness of this process: 0 is the usual one, 19 the lowest priority.

    Always 0 on Windows, which has none.
    """
    if sys.platform != "win32":
        return os.getpriority(os.PRIO_PROCESS, 0)
    return 0


def set_niceness(value: int) -> None:
    """Set the niceness of this process, 19 if `value` is above that; no-op on Windows."""
    if sys.platform != "win32":
        os.setpriority(os.PRIO_PROCESS, 0, min(value, 19))


def wait_for_parent_end(parent: int) -> None:
    """Return when the process that started this one has ended; `parent` is that one's id."""
    if sys.platform == "win32":
        try:
            handle = _winapi.OpenProcess(_winapi.SYNCHRONIZE, False, parent)
        except OSError:  # it has ended already
            return
        _winapi.WaitForSingleObject(handle, _winapi.INFINITE)
        return
    while os.getppid() == parent:
        time.sleep(_PERIOD)


@contextmanager
def sigint_blocked() -> Iterator[None]:
    """Block SIGINT in this thread, and for good in processes and threads that start meanwhile.

    Worker processes are started this way: a process that imports its modules does not ignore SIGINT
    yet, and would end with a traceback. No-op on Windows.
    """
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
