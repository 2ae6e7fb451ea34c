"""Disks so small that they are full at once."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest


@contextmanager
def small_disk(size: int) -> Iterator[Path]:
    """A folder on a disk of its own, of so many bytes; the system takes whole pages of them.

    It is mounted for a process alone, which Linux lets all users do unless its owner forbids it.
    """
    with TemporaryDirectory() as folder:
        mount = f"mount -t tmpfs -o size={size} tmpfs {folder} && echo mounted && exec cat"
        with subprocess.Popen(
            ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as holder:
            assert holder.stdin
            assert holder.stdout
            assert holder.stderr
            if holder.stdout.readline() != "mounted\n":
                pytest.skip(
                    "left out: a disk that is full; it takes Linux, with namespaces for users: "
                    f"{holder.stderr.read().strip()}"
                )
            yield Path(f"/proc/{holder.pid}/root{folder}")
            holder.stdin.close()


def fill(folder: Path, leave: int = 0) -> Path:
    """Fills the disk but for so many bytes with a file, and returns its path."""
    filler = folder / "filler"
    with filler.open("wb", buffering=0) as file:
        try:
            while file.write(bytes(4096)):
                pass
        except OSError:
            file.truncate(max(0, file.tell() - leave))
    return filler
