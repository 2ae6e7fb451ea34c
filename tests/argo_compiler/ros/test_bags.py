"""Tests of missions in bags, and of the errors for bags without a mission."""

import os
import re
import sqlite3
import sys
from contextlib import closing, suppress
from functools import cache
from pathlib import Path
from runpy import run_path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Reader as Ros2Reader
from rosbags.rosbag2 import Writer as Ros2Writer

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.limited_process import CallLimits, process_kept
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.ros import (
    Storage,
    bags,
    compression,
    is_bag,
    read_bag,
    ros1_types,
    ros2_types,
    to_message,
    to_ros1_bag,
    to_ros2_bag,
)
from argo_compiler.ros import types as ros_types
from argo_compiler.ros.bags import read_bag_here
from argo_compiler.ros.package import SPECIFICATION
from tests.conftest import examples
from tests.mission_writing import measure, start
from tests.missions_all import carried_missions

PLAN = Mission(
    designation="Öl #1",
    tasks=(start("S", "A"), measure("A", object_id="4")),
)
FORMS = ["ros1", *Storage]
OF_PYTHON = re.compile(
    r"Error\(|object|subscriptable|codec|instance|argument|NoneType|indices|please report|ord\(\)"
)
"""what only the texts of Python's errors have"""


@pytest.fixture(autouse=True, scope="module")
def one_process():
    """Let one process read all bags, as each start takes a second."""
    with process_kept():
        yield


def write(folder, form, mission=PLAN):
    content = _bag(form) if mission is PLAN else _make(form, mission)
    if isinstance(content, bytes):
        path = folder / "mission.bag"
        path.write_bytes(content)
        return path
    path = folder / form.value
    path.mkdir(exist_ok=True)
    for name, part in content.items():
        (path / name).write_bytes(part)
    return path


def _make(form, mission):
    return to_ros1_bag(mission) if form == "ros1" else to_ros2_bag(mission, form)


@cache
def _bag(form):
    return _make(form, PLAN)


def read_error(path, here=False):
    """Return the error of a bag; `here`: without another process, which knows no monkeypatch."""
    with pytest.raises(DiagnosticError) as caught:
        read_bag_here(path, str(path)) if here else read_bag(path)
    (diagnostic,) = caught.value.diagnostics
    assert str(caught.value).startswith(f"{path}: error: ")
    assert diagnostic.hint
    return diagnostic


@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=examples(8))
@given(mission=carried_missions())
def test_reading_a_bag_returns_the_written_mission(tmp_path_factory, form, mission):
    path = write(tmp_path_factory.mktemp("bag"), form, mission)
    assert is_bag(path)
    assert read_bag(path).mission.model_dump_json() == mission.model_dump_json()


@pytest.mark.parametrize("form", FORMS)
def test_equal_missions_give_equal_bags(form):
    assert _make(form, PLAN) == _make(form, PLAN)


@pytest.mark.parametrize("storage", Storage)
def test_a_single_file_of_a_rosbag2_can_be_read(tmp_path, storage):
    (data,) = write(tmp_path, storage).glob("mission.*")
    assert is_bag(data)
    assert read_bag(data).mission == PLAN


@pytest.mark.parametrize("storage", Storage)
def test_the_topic_is_latched_in_ros_2(tmp_path, storage):
    with Ros2Reader(write(tmp_path, storage)) as reader:
        (connection,) = reader.connections
        (qos,) = connection.ext.offered_qos_profiles
    assert connection.topic == "/mission"
    assert (qos.durability.name, qos.reliability.name) == ("TRANSIENT_LOCAL", "RELIABLE")


def test_bags_are_recognised_by_suffix_or_first_bytes(tmp_path):
    (tmp_path / "plan.json").write_text("{}")
    (tmp_path / "renamed").write_bytes(to_ros1_bag(PLAN))
    assert not is_bag(tmp_path / "plan.json")
    assert not is_bag(tmp_path / "missing.txt")
    assert is_bag(tmp_path / "renamed")
    assert is_bag(tmp_path / "missing.bag")
    assert read_bag(tmp_path / "renamed").mission == PLAN


def test_paths_that_are_no_bag_are_refused(tmp_path):
    text = tmp_path / "text.bag"
    text.write_text("Starting area 1")
    assert read_error(text).code == "ros.not-a-bag"
    assert read_error(tmp_path / "missing.bag").code == "file.missing"
    assert read_error(tmp_path).code == "file.directory"
    (tmp_path / "metadata.yaml").write_text("[" * 2000)
    assert read_error(tmp_path).code == "ros.broken-bag"
    (tmp_path / "metadata.yaml").write_text("#" * (compression.MAX_METADATA_BYTES + 1))
    assert read_error(tmp_path).code == "ros.compressed"


def ros1_bag(path, contents, topic="/mission", **connection):
    types = ros1_types()
    with Ros1Writer(path) as writer:
        added = writer.add_connection(
            topic, **({"msgtype": SPECIFICATION, "typestore": types.store} | connection)
        )
        for time, content in enumerate(contents, 1):
            writer.write(added, time, content)
    return path


def encoded(mission):
    return ros1_types().encode(to_message(mission, ros1_types()))


def test_bags_without_a_mission_are_refused(tmp_path):
    other = ros1_bag(tmp_path / "1.bag", [encoded(PLAN)], topic="/plan")
    assert read_error(other).message == "the bag has no topic /mission, only /plan"
    empty = ros1_bag(tmp_path / "2.bag", [])
    assert read_error(empty).message == "the bag has no message on /mission"
    typed = ros1_bag(tmp_path / "3.bag", [b""], msgtype="std_msgs/msg/Empty")
    assert "type std_msgs/msg/Empty on /mission" in read_error(typed).message


def test_bags_with_other_definitions_are_refused(tmp_path):
    other = ros1_bag(tmp_path / "1.bag", [b""], msgdef="uint8 x\n", md5sum="0" * 32)
    diagnostic = read_error(other)
    assert diagnostic.code == "ros.other-definitions"
    assert "0" * 32 in diagnostic.message
    assert ros1_types().digest() in diagnostic.hint


def test_several_missions_are_refused_and_repetitions_are_not(tmp_path):
    repeated = ros1_bag(tmp_path / "1.bag", [encoded(PLAN)] * 1500)
    assert read_bag(repeated).mission == PLAN
    several = ros1_bag(tmp_path / "2.bag", [encoded(PLAN), encoded(Mission())])
    assert read_error(several).code == "ros.several-missions"


def test_the_error_names_a_wrong_field_in_a_bag(tmp_path):
    types = ros1_types()
    message = to_message(PLAN, types)
    message.tasks[1].velocity = -1.0
    path = ros1_bag(tmp_path / "1.bag", [types.encode(message)])
    assert read_error(path).message.startswith("tasks[1].velocity: ")


@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=examples(60))
@given(data=st.data())
def test_broken_bags_end_in_a_message(tmp_path_factory, form, data):
    path = write(tmp_path_factory.getbasetemp(), form)
    file = path if form == "ros1" else data.draw(st.sampled_from(sorted(path.iterdir())))
    content = bytearray(file.read_bytes())
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    else:
        for _ in range(data.draw(st.integers(1, 4))):
            position = data.draw(st.integers(0, len(content) - 1))
            content[position] = data.draw(st.integers(0, 255))
    file.write_bytes(content)
    # If the change is within a text, or changes nothing, the bag still contains a mission.
    try:
        assert isinstance(read_bag(path).mission, Mission)
    except DiagnosticError as error:
        assert not OF_PYTHON.search(str(error)), error  # noqa: PT017


DAMAGED = "a part of it is damaged, or is not that of a bag"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", "its metadata.yaml has no `rosbag2_bagfile_information`"),
        ("", "null", "its metadata.yaml has no `rosbag2_bagfile_information`"),
        ("", "- 1", "its metadata.yaml has no `rosbag2_bagfile_information`"),
        ("", "rosbag2_bagfile_information: 3", "has no `rosbag2_bagfile_information`"),
        ("version: 8", "version: 99", "the `version` in its metadata.yaml is 99, and those up to"),
        ("version: 8", "version: x", "the `version` in its metadata.yaml is x, and those up to 9"),
        ("identifier: sqlite3", "identifier: tape", "Storage plugin 'tape' not supported"),
        ("topics_with_message_count", "topics", DAMAGED),
        ("topic_metadata", "topic", DAMAGED),
        ("relative_file_paths", "paths", DAMAGED),
    ],
)
def test_metadata_that_are_not_those_of_a_bag_are_refused_in_words(tmp_path, old, new, said):
    path = write(tmp_path, Storage.SQLITE3)
    metadata = path / "metadata.yaml"
    before = metadata.read_text()
    assert old in before
    metadata.write_text(before.replace(old, new, 1) if old else new)
    diagnostic = read_error(path)
    assert diagnostic.code == "ros.broken-bag"
    assert said in diagnostic.message
    assert not OF_PYTHON.search(diagnostic.message)


@pytest.mark.skipif(sys.platform == "win32", reason="pipes have names in folders on POSIX only")
@pytest.mark.parametrize("place", [os.mkfifo, lambda path: path.symlink_to("nothing")])
def test_a_pipe_or_a_broken_link_in_a_bag_is_refused_at_once(tmp_path, place):
    path = write(tmp_path, Storage.SQLITE3)
    (data,) = path.glob("mission.*")
    data.unlink()
    place(data)
    diagnostic = read_error(path)
    assert diagnostic.code == "ros.broken-bag"
    assert f"`{data.name}` in it is not a file" in diagnostic.message


def changed_database(folder: Path, command: str) -> Path:
    """Write a bag in SQLite and execute a command of SQL in it; return its path."""
    path = folder / "bag.db3"
    (data,) = write(folder, Storage.SQLITE3).glob("mission.*")
    path.write_bytes(data.read_bytes())
    with closing(sqlite3.connect(path)) as database:
        database.execute(command)
        database.commit()
    return path


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE messages SET data = 7",
        "UPDATE messages SET data = 'text'",
        "UPDATE messages SET timestamp = 'noon'",
        "UPDATE topics SET name = X'00FF'",
        "UPDATE topics SET offered_qos_profiles = '[3]'",
    ],
)
def test_values_of_other_types_in_a_database_are_refused_in_words(tmp_path, change):
    path = changed_database(tmp_path, change)
    with suppress(DiagnosticError):
        assert read_bag(path).mission == PLAN
        return
    assert not OF_PYTHON.search(str(read_error(path)))


@pytest.mark.parametrize("form", FORMS)
def test_truncated_bags_are_refused(tmp_path, form):
    path = write(tmp_path, form)
    file = path if form == "ros1" else next(path.glob("mission.*"))
    content = file.read_bytes()
    for size in (20, len(content) // 2, len(content) * 9 // 10):
        file.write_bytes(content[:size])
        assert read_error(path).code == "ros.broken-bag"


@pytest.mark.parametrize("format", Ros1Writer.CompressionFormat)
def test_compressed_ros_1_bags_are_read_up_to_a_size(tmp_path, monkeypatch, format):
    path = tmp_path / "mission.bag"
    writer = Ros1Writer(path)
    writer.set_compression(format)
    with writer:
        connection = writer.add_connection("/mission", SPECIFICATION, typestore=ros1_types().store)
        writer.write(connection, 1, encoded(PLAN))
    assert read_bag(path).mission == PLAN
    monkeypatch.setattr(compression, "MAX_CHUNK_BYTES", 100)
    assert read_error(path, here=True).code == "ros.compressed"


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_rosbag2_compressed_as_a_whole_is_refused(tmp_path, mode):
    path = tmp_path / "bag"
    writer = Ros2Writer(path, version=8)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        writer.add_connection("/mission", SPECIFICATION, typestore=ros2_types().store)
    assert read_error(path).message.endswith(f"it is compressed by {mode.name.lower()}")


def test_compressed_mcap_chunks_are_read_up_to_a_size(tmp_path, monkeypatch):
    path = tmp_path / "bag"
    writer = Ros2Writer(path, version=8, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    types = ros2_types()
    with writer:
        connection = writer.add_connection("/mission", SPECIFICATION, typestore=types.store)
        writer.write(connection, 1, types.encode(to_message(PLAN, types)))
    assert b"zstd" in (path / "bag.mcap").read_bytes()
    assert read_bag(path).mission == PLAN
    monkeypatch.setattr(compression, "MAX_CHUNK_BYTES", 100)
    assert read_error(path, here=True).code == "ros.compressed"
    assert read_error(path / "bag.mcap", here=True).code == "ros.compressed"


def test_without_rosbags_the_error_gives_the_install_command(monkeypatch, tmp_path):
    path = write(tmp_path, "ros1")
    monkeypatch.setitem(sys.modules, "rosbags", None)
    monkeypatch.setitem(sys.modules, "rosbags.typesys", None)
    ros_types.ros1_types.cache_clear()
    try:
        with pytest.raises(ArgoError, match=r"need rosbags: pip install .*\[ros\]"):
            read_bag_here(path, str(path))
    finally:
        ros_types.ros1_types.cache_clear()


CALCULATED = {
    "a view without end": (
        "CREATE VIEW more AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x FROM c) "
        "SELECT x AS schema_version FROM c WHERE x = 0",
        "view more",
    ),
    "a generated column": (
        "CREATE TABLE more(id INTEGER, data BLOB AS (zeroblob(900000000 + id)))",
        "table more",
    ),
    "a generated column behind a comment": (
        "CREATE TABLE more(id INTEGER, data BLOB AS/**/(zeroblob(900000000 + id)))",
        "table more",
    ),
    "a trigger": (
        "CREATE TRIGGER t AFTER INSERT ON topics BEGIN DELETE FROM messages; END",
        "trigger t",
    ),
    "a virtual table": ("CREATE VIRTUAL TABLE words USING fts5(text)", "table words"),
}


@pytest.mark.parametrize("name", CALCULATED)
def test_databases_that_calculate_their_content_are_refused(tmp_path, name):
    definition, part = CALCULATED[name]
    diagnostic = read_error(changed_database(tmp_path, definition))
    assert diagnostic.code == "ros.broken-bag"
    assert f"the content of its {part} is calculated" in diagnostic.message


@pytest.mark.parametrize(("script", "file"), [("endless", "evil.db3"), ("huge", "bomb.db3")])
def test_the_bags_on_which_argo_hung_are_refused(tmp_path, fault_inputs, monkeypatch, script, file):
    monkeypatch.chdir(tmp_path)
    run_path(str(fault_inputs / f"{script}_bag.py"))
    assert read_error(tmp_path / file).code == "ros.broken-bag"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory")
def test_a_bag_that_takes_too_much_memory_is_refused_with_the_way_out(tmp_path, monkeypatch):
    path = ros1_bag(tmp_path / "1.bag", [bytes(40_000_000)])
    monkeypatch.setattr(bags, "limits_for_size", lambda _: CallLimits(10.0, 9_000_000))
    diagnostic = read_error(path)
    assert diagnostic.code == "file.beyond-limits"
    assert diagnostic.message == "the file takes more than 9 MB of memory to read"
    assert diagnostic.hint == "is it the right file, and whole? If it is, record /mission alone"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such files")
def test_a_bag_that_is_open_already_is_read(tmp_path):
    with write(tmp_path, "ros1").open("rb") as file:
        assert read_bag(Path(f"/dev/fd/{file.fileno()}")).mission == PLAN


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such files")
def test_a_bag_that_takes_too_long_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "endless.bag"
    os.mkfifo(path)
    monkeypatch.setattr(bags, "limits_for_size", lambda _: CallLimits(0.1, 400_000_000))
    diagnostic = read_error(path)
    assert diagnostic.code == "file.beyond-limits"
    assert diagnostic.message == "the file takes longer than 1 s to read"
