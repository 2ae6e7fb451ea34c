"""Writes files so that nobody ever sees half of one, or old ones and new ones together."""

import errno
import os
import secrets
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from argo_compiler.base.errors import Conflict, NotFound, Unavailable

_OPEN_FILES = (Path("/dev/fd"), Path("/proc/self/fd"))
"""the files that this process has open"""
_STREAMS = (Path("/dev/stdout"), Path("/dev/stderr"))
_MOST_LINKS = 40
"""as Linux follows"""


def is_stream(path: Path) -> bool:
    """Whether it is no file but what can only be written to: a terminal, a pipe, a device, or
    what this process has open already."""
    place = path.absolute()
    if place in _STREAMS or place.parent in _OPEN_FILES:
        return True
    return os.path.exists(place) and not os.path.isfile(place) and not os.path.isdir(place)


def check_place(file: Path) -> None:
    """Raises ArgoError if no file can be written there. To be called before long work."""
    if is_stream(file):
        return
    place = Path(os.path.realpath(file)) if os.path.islink(file) else file.absolute()
    if os.path.isdir(place):
        raise Conflict(f"{file}: is a folder; choose another name")
    if os.path.isfile(place.parent):
        raise Conflict(f"{file}: {file.parent} is a file and no folder; choose another")
    if not os.path.isdir(place.parent):
        raise NotFound(f"{file}: there is no folder {file.parent}; make it, or choose another")
    if not os.access(place.parent, os.W_OK | os.X_OK):
        raise Unavailable(
            f"{file}: can't be written: its folder can't be written to; choose another place"
        )
    try:
        place.lstat()
    except FileNotFoundError:
        return
    except OSError as error:  # such as a name that is too long
        raise Unavailable(
            f"{file}: can't be written: {error.strerror}; choose another place"
        ) from None


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes bytes, or text as UTF-8 with Unix line ends; afterwards the file is old or new.

    It is written beside its place and then moved there. A link stays a link, and what is no file,
    such as a terminal, is written to as it is. Raises OSError.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    with drafting(path) as draft, draft.open("ab") as file:
        file.write(data)


@contextmanager
def drafting(path: Path) -> Iterator[Path]:
    """Gives the place for a draft, which becomes the file where the context ends well. The draft
    has the same name in a folder of its own. Raises OSError."""
    if is_stream(path):
        yield path
        return
    path = _behind_links(path)
    with _drafts_in(path.parent) as folder:
        draft = folder / path.name
        yield draft
        _finish(draft, path)
        draft.replace(path)


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Writes files, by their paths in the folder; afterwards all of them are old or all are new.
    Other files stay. Raises OSError.

    The last one is the first to go and the last to come, such as a page that shows the others.
    """
    for name in files:
        if os.path.isdir(folder / name):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
    made: list[Path] = []
    try:
        for name in files:
            _make_folder((folder / name).parent, made)
        with _drafts_in(folder) as drafts:
            old, new = drafts / "old", drafts / "new"
            for name, content in files.items():
                for side in (old, new):
                    (side / name).parent.mkdir(parents=True, exist_ok=True)
                (new / name).write_bytes(content)
                _finish(new / name, folder / name)
            _swap(folder, list(files), old, new)
    except BaseException:
        for path in reversed(made):
            with suppress(OSError):
                path.rmdir()
        raise


def _swap(folder: Path, names: list[str], old: Path, new: Path) -> None:
    """Moves the old files out of the folder and the new ones in; takes all back if that fails."""
    try:
        for name in reversed(names):
            if os.path.lexists(folder / name):
                (folder / name).replace(old / name)
        for name in names:
            (new / name).replace(folder / name)
    except BaseException:
        _insist(lambda: _swap_back(folder, names, old, new))
        raise


def _swap_back(folder: Path, names: list[str], old: Path, new: Path) -> None:
    """Takes a swap back, however far that one or this has come."""
    for name in reversed(names):
        if os.path.lexists(folder / name) and not os.path.lexists(new / name):
            (folder / name).replace(new / name)
    for name in names:
        if os.path.lexists(old / name):
            (old / name).replace(folder / name)


def _insist(act: Callable[[], None]) -> None:
    """Does what can be done again, and again where it is interrupted; only then raises that."""
    interruption = None
    while True:
        try:
            act()
            break
        except Exception:
            raise
        except BaseException as error:
            interruption = error
    if interruption:
        raise interruption


def _behind_links(path: Path) -> Path:
    """The file that a link stands for. Raises OSError if it stands for itself."""
    for _ in range(_MOST_LINKS):
        if not path.is_symlink():
            return path
        path = path.parent / path.readlink()
    raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))


@contextmanager
def _drafts_in(folder: Path) -> Iterator[Path]:
    """A hidden folder, on the same disk as what its files become."""
    drafts = folder / f".argo-{secrets.token_hex(6)}.tmp"
    try:
        drafts.mkdir()
        yield drafts
    finally:
        _insist(lambda: shutil.rmtree(drafts, ignore_errors=True))


def _finish(draft: Path, path: Path) -> None:
    """Has a draft on disk, with the permissions of the file that it replaces."""
    with draft.open("rb") as file:
        os.fsync(file.fileno())
    if os.path.exists(path):
        draft.chmod(path.stat().st_mode & 0o7777)


def _make_folder(path: Path, made: list[Path]) -> None:
    """Makes a folder and those that it is in, and adds them to those made."""
    if os.path.isdir(path):
        return
    _make_folder(path.parent, made)
    path.mkdir()
    made.append(path)
