"""Atomic writing of files: nobody sees a half-written file, or old and new files together."""

import errno
import os
import secrets
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from argo_compiler.base.errors import Conflict, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message

OPEN_FILES = (Path("/dev/fd"), Path("/proc/self/fd"))
"""Folders with the files that this process has open."""
_STREAMS = (Path("/dev/stdout"), Path("/dev/stderr"))
_MAX_LINKS = 40
"""Number of links to follow, as in Linux."""


def is_stream(path: Path) -> bool:
    """Return True if a file at the path can only be written to, not replaced by another one.

    That is so for a terminal, a pipe, a device, and the path of an open file descriptor such as
    `/dev/fd/3`.
    """
    absolute = path.absolute()
    if absolute in _STREAMS or absolute.parent in OPEN_FILES:
        return True
    return os.path.exists(absolute) and not os.path.isfile(absolute) and not os.path.isdir(absolute)


def check_writable(file: Path) -> None:
    """Raise ArgoError if no file can be written at the path; call it before long work."""
    if is_stream(file):
        return
    path = Path(os.path.realpath(file)) if os.path.islink(file) else file.absolute()
    if os.path.isdir(path):
        raise Conflict(Message("{file} is a folder; choose another name", file=file))
    if os.path.isfile(path.parent):
        raise Conflict(
            Message(
                "{file}: {parent} is a file, not a folder; choose another folder",
                file=file,
                parent=file.parent,
            )
        )
    if not os.path.isdir(path.parent):
        raise NotFound(
            Message(
                "{file}: folder {parent} does not exist; create it or choose another",
                file=file,
                parent=file.parent,
            )
        )
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise Unavailable(
            Message(
                "{file} can't be written: its folder is not writable; choose another folder",
                file=file,
            )
        )
    try:
        path.lstat()
    except FileNotFoundError:
        return
    except OSError as error:  # for example, the name is too long
        raise Unavailable(
            Message(
                "{file} can't be written: {reason}; choose another path",
                file=file,
                reason=reason_text(error),
            )
        ) from None


def write_atomically(path: Path, content: str | bytes, private: bool = False) -> None:
    """Write bytes or text to a file; on an error, the old file stays.

    Text is written as UTF-8 with unchanged line ends. The content is written to a draft on the same
    disk, which then replaces the file, so nobody ever sees a part of it. A symbolic link stays, and
    the file that it leads to is replaced. A stream such as a terminal is written to directly. With
    `private`, only the owner can read the file. Raises OSError.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    with atomic_draft(path, private) as draft, draft.open("ab") as file:
        file.write(data)


@contextmanager
def atomic_draft(path: Path, private: bool = False) -> Iterator[Path]:
    """Yield the path of a draft, which replaces the file if the block ends without an error.

    The caller creates the draft. It has the file's name and lies in a folder of its own. With
    `private`, only the owner can read the file. For a stream (see `is_stream`), the path itself is
    yielded. Raises OSError.
    """
    if is_stream(path):
        yield path
        return
    path = _resolve_links(path)
    with _draft_folder(path.parent) as folder:
        draft = folder / path.name
        yield draft
        _finish(draft, path, private)
        draft.replace(path)


def write_files_atomically(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files by their paths in the folder; afterwards all of them are old or all are new.

    Other files in the folder stay. The last file is removed first and added last, so it should be
    the one that refers to the others, such as a page. Raises OSError.
    """
    for name in files:
        if os.path.isdir(folder / name):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
    created: list[Path] = []
    try:
        for name in files:
            _make_folder((folder / name).parent, created)
        with _draft_folder(folder) as drafts:
            old, new = drafts / "old", drafts / "new"
            for name, content in files.items():
                for side in (old, new):
                    (side / name).parent.mkdir(parents=True, exist_ok=True)
                (new / name).write_bytes(content)
                _finish(new / name, folder / name)
            _swap(folder, list(files), old, new)
    except BaseException:
        for path in reversed(created):
            with suppress(OSError):
                path.rmdir()
        raise


def _swap(folder: Path, names: list[str], old: Path, new: Path) -> None:
    """Move files of the folder to `old` and those of `new` to the folder; undo that on an error.

    `names` are the paths of the files, the same in all three folders.
    """
    try:
        for name in reversed(names):
            if os.path.lexists(folder / name):
                (folder / name).replace(old / name)
        for name in names:
            (new / name).replace(folder / name)
    except BaseException:
        _complete(lambda: _undo_swap(folder, names, old, new))
        raise


def _undo_swap(folder: Path, names: list[str], old: Path, new: Path) -> None:
    """Undo `_swap` from any point that it, or an earlier undo, has reached."""
    for name in reversed(names):
        if os.path.lexists(folder / name) and not os.path.lexists(new / name):
            (folder / name).replace(new / name)
    for name in names:
        if os.path.lexists(old / name):
            (old / name).replace(folder / name)


def _complete(action: Callable[[], None]) -> None:
    """Call a function again after each interruption until it has ended; then raise the last one.

    An interruption is an exception such as KeyboardInterrupt. The function must be repeatable. If
    it raises an error (`Exception`), that is raised at once.
    """
    interruption = None
    while True:
        try:
            action()
            break
        except Exception:
            raise
        except BaseException as error:
            interruption = error
    if interruption:
        raise interruption


def _resolve_links(path: Path) -> Path:
    """Return the path to which symbolic links lead. Raises OSError for a loop or too many links."""
    for _ in range(_MAX_LINKS):
        if not path.is_symlink():
            return path
        path = path.parent / path.readlink()
    raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))


@contextmanager
def _draft_folder(folder: Path) -> Iterator[Path]:
    """Yield a hidden folder for drafts, on the same disk as `folder`, and delete it afterwards."""
    drafts = folder / f".argo-{secrets.token_hex(6)}.tmp"
    try:
        drafts.mkdir(mode=0o700)
        yield drafts
    finally:
        _complete(lambda: shutil.rmtree(drafts, ignore_errors=True))


def _finish(draft: Path, path: Path, private: bool = False) -> None:
    """Flush a draft to the disk, and give it the permissions of the file that it replaces.

    With `private`, give it those of a file that only its owner can read.
    """
    with draft.open("rb") as file:
        os.fsync(file.fileno())
    if private:
        draft.chmod(0o600)
    elif os.path.exists(path):
        draft.chmod(path.stat().st_mode & 0o7777)


def _make_folder(path: Path, created: list[Path]) -> None:
    """Create a folder and its missing parents, and append each to `created`."""
    if os.path.isdir(path):
        return
    _make_folder(path.parent, created)
    path.mkdir()
    created.append(path)
