import os
import stat
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.files import atomic_write
from argo_compiler.files.atomic_write import write_atomically, write_files_atomically
from tests.conftest import examples
from tests.disks import fill, small_disk


def test_text_is_written_as_utf_8_with_unix_line_ends(tmp_path):
    path = tmp_path / "a.txt"
    write_atomically(path, "Öl\n\n")
    assert path.read_bytes() == "Öl\n\n".encode()
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_half_way_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic_write.os, "fsync", fail)
    with pytest.raises(OSError, match="No space"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_text_that_cannot_be_encoded_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError):
        write_atomically(path, "\ud800")
    assert path.read_text() == "old"


def test_permissions_and_links_stay(tmp_path):
    path, link = tmp_path / "a.txt", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_atomically(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_has_the_usual_permissions(tmp_path):
    (tmp_path / "usual").write_text("")
    write_atomically(tmp_path / "new", "")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_pipe_is_written_to_directly(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomically(pipe, "text")
        assert os.read(reader, 99) == b"text"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_an_open_file_descriptor_is_written_to_directly(tmp_path):
    path = tmp_path / "open.txt"
    path.write_text("before, ")
    with path.open("a") as file:
        write_atomically(Path(f"/dev/fd/{file.fileno()}"), "after")
    assert path.read_text() == "before, after"
    assert list(tmp_path.iterdir()) == [path]


FILES = {"data.json": b"new data", "pictures/1.png": b"new picture", "page.html": b"new page"}


def contents(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_files_of_a_folder_are_replaced_and_others_stay(tmp_path):
    (tmp_path / "page.html").write_text("old page")
    (tmp_path / "page.html").chmod(0o640)
    (tmp_path / "notes.txt").write_text("mine")
    write_files_atomically(tmp_path, FILES)
    assert contents(tmp_path) == FILES | {"notes.txt": b"mine"}
    assert stat.S_IMODE((tmp_path / "page.html").stat().st_mode) == 0o640
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "data.json", "notes.txt", "page.html", "pictures",
    ]  # fmt: skip


def test_a_folder_is_created_with_its_parents(tmp_path):
    write_files_atomically(tmp_path / "a" / "b", FILES)
    assert contents(tmp_path / "a" / "b") == FILES


def test_a_folder_with_the_name_of_a_file_stays(tmp_path):
    (tmp_path / "page.html").mkdir()
    with pytest.raises(IsADirectoryError, match="directory"):
        write_files_atomically(tmp_path, FILES)
    assert [p.name for p in tmp_path.iterdir()] == ["page.html"]


@pytest.mark.parametrize("steps", range(8))
def test_an_interruption_leaves_all_old_or_all_new(tmp_path, monkeypatch, steps):
    old = {"data.json": b"old data", "page.html": b"old page"}
    write_files_atomically(tmp_path, old)
    replace, moves = Path.replace, []

    def interrupted(self, target):
        moves.append(replace(self, target))
        # At no time there is a new page with old data, or an old page with new data.
        visible = contents(tmp_path)
        assert len({visible[name][:3] for name in old if name in visible}) <= 1
        if len(moves) == steps + 1:
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    try:
        write_files_atomically(tmp_path, FILES)
    except KeyboardInterrupt:
        assert contents(tmp_path) == old
        assert sorted(p.name for p in tmp_path.iterdir()) == ["data.json", "page.html"]
    else:
        assert steps >= 5, "two files are moved out, and three in"
        assert contents(tmp_path) == FILES


@pytest.mark.parametrize("steps", range(1, 6))
@pytest.mark.parametrize("more", range(1, 6))
def test_a_second_interruption_loses_nothing(tmp_path, monkeypatch, steps, more):
    """The second interruption comes while the old files are moved back."""
    old = {"data.json": b"old data", "page.html": b"old page"}
    write_files_atomically(tmp_path, old)
    replace, moves = Path.replace, []

    def interrupted(self, target):
        moves.append(replace(self, target))
        if len(moves) in {steps, steps + more}:
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_files_atomically(tmp_path, FILES)
    assert contents(tmp_path) == old
    assert sorted(p.name for p in tmp_path.iterdir()) == ["data.json", "page.html"]


_PAGE = 4096  # bytes


@pytest.mark.small_disk
def test_a_full_disk_leaves_all_old_or_all_new():
    old = {"data.json": b"o" * 7 * _PAGE, "page.html": b"o" * 2 * _PAGE}
    outcomes = set()

    @settings(max_examples=examples(60))
    @given(room=st.integers(0, 30), sizes=st.lists(st.integers(0, 9), min_size=3, max_size=3))
    def check(room, sizes):
        new = {name: b"n" * size * _PAGE for name, size in zip(FILES, sizes, strict=True)}
        write_files_atomically(disk, old)
        filler = fill(disk, leave=room * _PAGE)
        modes = {path: path.stat().st_mode for path in disk.rglob("*")}
        try:
            write_files_atomically(disk, new)
        except OSError:
            outcomes.add("old")
            assert contents(disk) == old | {"filler": filler.read_bytes()}
            assert {path: path.stat().st_mode for path in disk.rglob("*")} == modes
        else:
            outcomes.add("new")
            assert contents(disk) == new | {"filler": filler.read_bytes()}
        for path in disk.rglob("*"):
            path.is_dir() or path.unlink()
        (disk / "pictures").is_dir() and (disk / "pictures").rmdir()

    with small_disk(64 * _PAGE) as disk:
        check()
    assert outcomes == {"old", "new"}
