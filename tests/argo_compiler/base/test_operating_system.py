import os
import subprocess
import sys
from pathlib import Path

import pytest

from argo_compiler.base import operating_system as system

LOCKS = """
import os, sys
from argo_compiler.base.operating_system import try_lock
print(try_lock(os.open(sys.argv[1], os.O_RDWR)), flush=True)
"""


def locked_by_another_process(path: Path) -> bool:
    done = subprocess.run(
        [sys.executable, "-c", LOCKS, str(path)], capture_output=True, text=True, check=True
    )
    return done.stdout.strip() == "True"


def test_one_process_at_a_time_has_the_lock_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    file = os.open(path, os.O_RDWR | os.O_CREAT | system.OPEN_FLAGS)
    os.write(file, b"content")
    assert system.try_lock(file)
    assert not locked_by_another_process(path)
    assert path.read_bytes() == b"content"
    os.close(file)
    assert locked_by_another_process(path)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows can open links only")
def test_links_are_not_followed(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("content")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    with pytest.raises(OSError, match="link"):
        os.open(tmp_path / "link", os.O_RDONLY | system.NO_LINK_FLAGS)


def test_the_end_of_the_parent_is_noticed() -> None:
    system.wait_for_parent_end(os.getppid() + 1)  # not the parent: that one has ended
