"""Search for files that make a reader fail, take too long or take too much memory.

Each reader of outside files gets mutated files in a process with the limits that Argo itself uses.
It must return or raise an ArgoError. Readers that Argo runs in such a process may exceed the
limits too: then Argo refuses the file.

    python -m tests.campaigns.readers --count 20000 --only mcap recording
"""

import argparse
import json
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from io import BytesIO
from pathlib import Path

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.limited_process import (
    LimitExceeded,
    call_limited,
    limits_for_size,
    process_kept,
)
from argo_compiler.il import Mission
from tests.campaigns.fuzz.binary import BinaryMutator
from tests.campaigns.fuzz.mutating import Mutator

ROOT = Path(__file__).parents[2]
MODULES = ("numpy", "rosbags.rosbag1", "rosbags.rosbag2", "mcap.stream_reader", "zstandard")


@dataclass(frozen=True)
class Reader:
    """Reader of one kind of file."""

    read: Callable[[Path], object]
    make: Callable[[random.Random], bytes]
    """function that draws the content of a file"""
    suffix: str
    limited: bool = False
    """whether Argo runs it in a process with limits"""


# ---- what is read, in the process with limits


def read_bag_file(path: Path) -> None:
    from argo_compiler.ros.bags import read_bag_here

    read_bag_here(path, "fuzz")


def read_bag_folder(path: Path) -> None:
    from argo_compiler.ros.bags import read_bag_here

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in bag_folder().items():
            (folder / file).write_bytes(content)
        (folder / "metadata.yaml").write_bytes(path.read_bytes())
        read_bag_here(folder, "fuzz")


def read_recording_file(path: Path) -> None:
    from argo_env.recording.reader import read_recording_here

    read_recording_here(path)


def read_journal_file(path: Path) -> None:
    from argo_env.run.journal import open_journal

    with open_journal(path):
        pass


def read_mission_source(path: Path) -> None:
    from argo_planner.use_cases.importing import Upload, load_unchecked_mission
    from tests.argo_compiler.script.conftest import CATALOG

    load_unchecked_mission(Upload(path.name, path.read_bytes()), CATALOG)


def read_site_file(path: Path) -> None:
    from argo_env.site import make_site
    from argo_env.site.site_file import parse_site_spec

    make_site(parse_site_spec(path.read_text("utf-8", "replace"), "fuzz"))


def read_faults_file(path: Path) -> None:
    from argo_env.faults.loading import decode_distribution, decode_faults

    content = path.read_bytes()
    if b"distribution" in content or b"chance" in content:
        decode_distribution(content, "fuzz")
    decode_faults(content, "fuzz")


def read_evaluation_file(path: Path) -> None:
    from argo_env.evaluation.file import decode_evaluation

    decode_evaluation(path.read_bytes(), "fuzz")


def read_route_file(path: Path) -> None:
    from argo_compiler.files.route_problem_file import read_route_problem

    read_route_problem(path)


# ---- what the files are made from


@cache
def texts(*patterns: str) -> tuple[bytes, ...]:
    """Return the contents of the shipped files that match one of the patterns."""
    return tuple(path.read_bytes() for pattern in patterns for path in sorted(ROOT.glob(pattern)))


@cache
def mission() -> Mission:
    from argo_compiler.script import import_script
    from argo_env.planning.opening import open_site

    [script] = texts("scenarios/umad/missions/mission_1.txt")
    catalog = open_site("umad").catalog
    return import_script(script.decode(), catalog, start_area=1, end_area=1).mission


@cache
def bag_folder() -> dict[str, bytes]:
    from argo_compiler.ros import to_ros2_bag

    return to_ros2_bag(mission())


@cache
def bags(suffix: str) -> tuple[bytes, ...]:
    from argo_compiler.ros import Storage, to_ros1_bag, to_ros2_bag

    if suffix == ".bag":
        return (to_ros1_bag(mission()),)
    folder = bag_folder() if suffix == ".db3" else to_ros2_bag(mission(), Storage.MCAP)
    return tuple(content for name, content in folder.items() if name.endswith(suffix))


@cache
def run_files() -> tuple[bytes, bytes]:
    """Return the recording and the journal of a run."""
    from argo_env.planning.opening import open_site
    from argo_env.recording.files import recording_to
    from argo_env.run.session import simulate
    from argo_env.run.spec import RunSpec

    with tempfile.TemporaryDirectory() as folder:
        recording, journal = Path(folder) / "run.mcap", Path(folder) / "run.journal"
        spec = RunSpec(mission=mission(), site="umad", drive="route", seed=1)
        with recording_to(recording) as recorder:
            simulate(spec, open_site("umad"), observers=[recorder], journal=journal)
        return recording.read_bytes(), journal.read_bytes()


def draw_binary(rng: random.Random, corpus: Sequence[bytes]) -> bytes:
    return BinaryMutator(corpus, rng).make()


def draw_text(rng: random.Random, corpus: Sequence[bytes]) -> bytes:
    mutator = Mutator(corpus)
    mutator.rng = rng
    return mutator.make()


def draw_bag(rng: random.Random, suffix: str) -> bytes:
    """Return a mutated bag, or one with a mutated message, or a database with calculated parts."""
    if suffix == ".db3" and rng.random() < 0.3:
        return draw_database(rng)
    if suffix == ".bag" and rng.random() < 0.5:
        return bag_with_message(rng)
    return draw_binary(rng, bags(suffix))


def draw_database(rng: random.Random) -> bytes:
    """Return a database with other definitions than a recorder writes."""
    import sqlite3

    expressions = (
        "zeroblob(900000000)",
        "(WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT max(x) FROM c)",
        "randomblob(100000)",
        "'/mission'",
        "1",
        "printf('%.*c', 900000000, 'x')",
    )
    tables = {
        "schema": ("schema_version", "ros_distro"),
        "topics": ("id", "name", "type", "serialization_format", "offered_qos_profiles"),
        "messages": ("id", "topic_id", "timestamp", "data"),
        "metadata": ("id", "metadata_version", "metadata"),
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bag.db3"
        [content] = bags(".db3")
        path.write_bytes(content)
        database = sqlite3.connect(path)
        for name, columns in rng.sample(sorted(tables.items()), rng.choice((1, 1, 2))):
            values = [rng.choice(expressions) for _ in columns]
            database.execute(f"DROP TABLE IF EXISTS {name}")
            match rng.randrange(3):
                case 0:
                    chosen = ", ".join(f"{v} AS {c}" for v, c in zip(values, columns, strict=True))
                    definitions = [f"CREATE VIEW {name} AS SELECT {chosen}"]
                case 1:
                    kept = ", ".join(columns[:-1])
                    definitions = [
                        f"CREATE TABLE {name}({kept}, {columns[-1]} DEFAULT ({values[0]}))",
                        f"INSERT INTO {name}({kept}) VALUES({', '.join('1' for _ in columns[1:])})",
                    ]
                case _:
                    kept = ", ".join(columns)
                    small = ", ".join(rng.choice(expressions[3:5]) for _ in columns)
                    definitions = [
                        f"CREATE TABLE {name}({kept})",
                        f"INSERT INTO {name} VALUES({small})",
                        f"CREATE INDEX i_{name} ON {name}(length({columns[-1]}))",
                    ]
            for definition in definitions:
                try:
                    database.execute(definition)
                except sqlite3.Error:  # such as a subquery where none may be
                    break
        database.commit()
        database.close()
        return path.read_bytes()


def bag_with_message(rng: random.Random) -> bytes:
    """Return a valid ROS 1 bag whose message is mutated."""
    from rosbags.rosbag1 import Writer

    from argo_compiler.ros import ros1_types, to_message
    from argo_compiler.ros.package import SPECIFICATION

    types = ros1_types()
    message = draw_binary(rng, (types.encode(to_message(mission(), types)),))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.bag"
        with Writer(path) as writer:
            topic = writer.add_connection("/mission", SPECIFICATION, typestore=types.store)
            writer.write(topic, 1, message)
        return path.read_bytes()


def draw_recording(rng: random.Random) -> bytes:
    """Return a mutated recording, or one with right checksums around mutated parts."""
    recording = run_files()[0]
    if rng.random() < 0.5:
        return draw_binary(rng, (recording,))
    from mcap.reader import make_reader
    from mcap.writer import CompressionType, Writer

    reader, stream = make_reader(BytesIO(recording)), BytesIO()
    writer = Writer(
        stream,
        chunk_size=rng.choice((1, 1_000, 10**7)),
        compression=rng.choice([*CompressionType]),
        enable_data_crcs=True,
    )
    writer.start()

    def changed(content: bytes) -> bytes:
        return draw_text(rng, (content,)) if content and rng.random() < 0.2 else content

    for facts in reader.iter_metadata():
        writer.add_metadata(facts.name, facts.metadata)
    for part in reader.iter_attachments():
        if rng.random() < 0.9:
            writer.add_attachment(0, 0, part.name, part.media_type, changed(part.data))
    channels: dict[str, int] = {}
    for _, channel, message in reader.iter_messages(topics=["/readings", "/tasks"]):
        if channel.topic not in channels:
            channels[channel.topic] = writer.register_channel(channel.topic, "json", 0)
        writer.add_message(
            channels[channel.topic], message.log_time, changed(message.data), message.publish_time
        )
    writer.finish()
    return stream.getvalue()


@cache
def isar_missions() -> tuple[bytes, ...]:
    task = {
        "type": "inspection",
        "id": "1",
        "robot_pose": {
            "position": {"x": 1.0, "y": 2.0, "z": 0.0, "frame_name": "asset"},
            "orientation": {"x": 0, "y": 0, "z": 0, "w": 1, "frame_name": "asset"},
            "frame_name": "asset",
        },
        "inspection": {
            "type": "Image",
            "inspection_target": {"x": 1, "y": 1, "z": 1, "frame_name": "asset"},
        },
        "tag": "4",
    }
    definition = {"name": "Round", "tasks": [task, task | {"id": "2", "tag": "8"}]}
    return (json.dumps({"mission_definition": definition}).encode(),)


PROBLEMS = (
    b"NAME: a\nTYPE: TSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n"
    b"1 0 0\n2 1 0\n3 0 1\nEOF\n",
    b"NAME: b\nTYPE: ATSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\n"
    b"EDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n0 1 2\n3 0 4\n5 6 0\nEOF\n",
)

READERS = {
    "ros1": Reader(read_bag_file, lambda rng: draw_bag(rng, ".bag"), ".bag", limited=True),
    "sqlite": Reader(read_bag_file, lambda rng: draw_bag(rng, ".db3"), ".db3", limited=True),
    "mcap": Reader(read_bag_file, lambda rng: draw_bag(rng, ".mcap"), ".mcap", limited=True),
    "metadata": Reader(
        read_bag_folder,
        lambda rng: draw_text(rng, (bag_folder()["metadata.yaml"],)),
        ".yaml",
        limited=True,
    ),
    "recording": Reader(read_recording_file, draw_recording, ".mcap", limited=True),
    "journal": Reader(read_journal_file, lambda rng: draw_binary(rng, run_files()[1:]), ".journal"),
    "script": Reader(
        read_mission_source, lambda rng: draw_text(rng, texts("scenarios/*/missions/*.txt")), ".txt"
    ),
    "mission": Reader(
        read_mission_source, lambda rng: draw_text(rng, (mission().model_dump_json().encode(),)),
        ".json",
    ),
    "isar": Reader(read_mission_source, lambda rng: draw_text(rng, isar_missions()), ".json"),
    "site": Reader(
        read_site_file, lambda rng: draw_text(rng, texts("scenarios/*/site.yaml")), ".yaml"
    ),
    "faults": Reader(
        read_faults_file, lambda rng: draw_text(rng, texts("scenarios/umad/faults/*.yaml")), ".yaml"
    ),
    "evaluation": Reader(
        read_evaluation_file,
        lambda rng: draw_text(rng, texts("scenarios/umad/evaluation.yaml")),
        ".yaml",
    ),
    "route problem": Reader(read_route_file, lambda rng: draw_text(rng, PROBLEMS), ".txt"),
}  # fmt: skip


def read_or_refuse(name: str, path: Path) -> str:
    """Return `read` or `refused` for a file; any other outcome is an error of the reader."""
    try:
        READERS[name].read(path)
    except ArgoError:
        return "refused"
    return "read"


def try_inputs(name: str, first: int, count: int) -> Iterator[tuple[int, str, float]]:
    """Yield number, outcome and time (s) of each input of a reader."""
    from tests.campaigns.readers import read_or_refuse  # not of `__main__`, for the other process

    reader = READERS[name]
    with tempfile.TemporaryDirectory() as folder, process_kept():
        path = Path(folder) / f"fuzz{reader.suffix}"
        for number in range(first, first + count):
            path.write_bytes(reader.make(random.Random(f"{name} {number}")))
            limits = limits_for_size(path.stat().st_size, held=path.stat().st_size)
            begun = time.monotonic()
            try:
                outcome = call_limited(limits, MODULES, read_or_refuse, name, path)
            except LimitExceeded as error:
                outcome = f"{'beyond limits' if reader.limited else 'ERROR'}: {error}"
            except Exception as error:
                outcome = f"ERROR: {type(error).__name__}: {error}"
            yield number, outcome, time.monotonic() - begun


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the inputs and print what became of them; return 1 if a reader fails, otherwise 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000, help="inputs for each reader")
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--only", nargs="+", choices=READERS, default=[*READERS], metavar="READER")
    options = parser.parse_args(arguments)
    failed = False
    for name in options.only:
        outcomes: Counter[str] = Counter()
        slowest = 0.0
        for number, outcome, seconds in try_inputs(name, options.first, options.count):
            kind = outcome.partition(":")[0]
            outcomes[kind] += 1
            if kind in ("ERROR", "beyond limits"):
                print(f"{name} {number}: {outcome[:300]}", flush=True)
            slowest = max(slowest, seconds)
        failed = failed or bool(outcomes["ERROR"])
        counts = ", ".join(f"{kind} {count}" for kind, count in sorted(outcomes.items()))
        print(f"{name:<14} {options.count} inputs: {counts}; slowest {slowest:.1f} s", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
