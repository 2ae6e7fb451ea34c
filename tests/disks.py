"""Small disks, to test what happens when a disk is full."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest


@contextmanager
def small_disk(size: int) -> Iterator[Path]:
    """Yield a folder on a disk of its own with `size` bytes, rounded up to whole pages.

    It is mounted for one process only, which Linux allows all users by default.
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
    """Fill the disk with a file, except for `leave` bytes, and return the file's path."""
    filler = folder / "filler"
    with filler.open("wb", buffering=0) as file:
        try:
            while file.write(bytes(4096)):
                pass
        except OSError:
            file.truncate(max(0, file.tell() - leave))
    return filler
