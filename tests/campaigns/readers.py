"""Search for files that make a reader fail, take too long or take too much memory.

Each reader of outside files gets mutated files in a process with the limits that Argo itself uses.
It must return or raise an ArgoError. Readers that Argo runs in such a process may exceed the
limits too: then Argo refuses the file.

    python -m tests.campaigns.readers --count 20000 --only mcap recording
"""

import argparse
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from io import BytesIO
from itertools import chain
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
MODULES = (
    *("numpy", "rosbags.rosbag1", "rosbags.rosbag2", "mcap.stream_reader", "zstandard"),
    *("openpyxl", "docx", "pdfplumber"),
)


def draw_binary(rng: random.Random, corpus: Sequence[bytes]) -> bytes:
    return BinaryMutator(corpus, rng).make()


def draw_text(rng: random.Random, corpus: Sequence[bytes]) -> bytes:
    mutator = Mutator(corpus)
    mutator.rng = rng
    return mutator.make()


@dataclass(frozen=True)
class Reader:
    """Reader of one kind of file."""

    read: Callable[[Path], object]
    suffix: str
    samples: Callable[[], Sequence[bytes]]
    """function that returns contents of files which it reads"""
    draw: Callable[[random.Random, Sequence[bytes]], bytes] = draw_text
    """function that draws the content of a file, from the samples"""
    limited: bool = False
    """whether Argo runs it in a process with limits"""

    def make(self, rng: random.Random) -> bytes:
        """Draw the content of a file."""
        return self.draw(rng, self.samples())


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

    read_recording_here(path, "fuzz")


def read_journal_file(path: Path) -> None:
    from argo_env.run.journal import open_journal

    with open_journal(path):
        pass


def read_mission_source(path: Path) -> None:
    from argo_planner.use_cases.importing import Upload, load_unchecked_mission
    from tests.argo_compiler.script.conftest import CATALOG

    load_unchecked_mission(Upload(path.name, path.read_bytes()), CATALOG)


def read_document_file(path: Path) -> None:
    from argo_compiler.script.documents.reading import document_format, read_here

    content = path.read_bytes()
    if document_format(content) is not None:
        read_here(content, "fuzz")


def read_separated_file(path: Path) -> None:
    from argo_compiler.script.documents.reading import decode_document

    decode_document(path.read_bytes(), "fuzz.csv")


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
    from argo_env.planning.opening import open_site
    from tests.whole_scripts import import_whole

    [script] = texts("scenarios/umad/missions/mission_1.txt")
    catalog = open_site("umad").catalog
    return import_whole(script.decode(), catalog, start_area=1, end_area=1).mission


@cache
def scripts() -> tuple[bytes, ...]:
    """Return shipped scripts, with one starting area where they leave it open."""
    shipped = texts("scenarios/umad/missions/*.txt")
    return tuple(script.replace(b"1 or 2", b"1") for script in shipped)


@cache
def bag_folder() -> dict[str, bytes]:
    from argo_compiler.ros import to_ros2_bag

    return to_ros2_bag(mission())


def metadata_of_bags() -> tuple[bytes, ...]:
    return (bag_folder()["metadata.yaml"],)


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


def draw_ros1_bag(rng: random.Random, samples: Sequence[bytes]) -> bytes:
    """Return a mutated bag, or one with a mutated message."""
    return bag_with_message(rng) if rng.random() < 0.5 else draw_binary(rng, samples)


def draw_sqlite_bag(rng: random.Random, samples: Sequence[bytes]) -> bytes:
    """Return a mutated bag, or a database with calculated parts."""
    return draw_database(rng) if rng.random() < 0.3 else draw_binary(rng, samples)


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
        database.execute("PRAGMA synchronous=OFF")
        database.execute("PRAGMA journal_mode=MEMORY")
        for name, columns in rng.sample(sorted(tables.items()), rng.choice((1, 1, 2))):
            values = [rng.choice(expressions) for _ in columns]
            database.execute(f"DROP TABLE IF EXISTS {name}")
            match rng.randrange(3):
                case 0:
                    chosen = ", ".join(f"{v} AS {c}" for v, c in zip(values, columns, strict=True))
                    definitions = [f"CREATE VIEW {name} AS SELECT {chosen}"]
                case 1:
                    kept, small = ", ".join(columns[:-1]), rng.choice(expressions[2:5])
                    definitions = [
                        f"CREATE TABLE {name}({kept}, {columns[-1]} DEFAULT ({small}))",
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


def draw_recording(rng: random.Random, samples: Sequence[bytes]) -> bytes:
    """Return a mutated recording, or one with right checksums around mutated parts."""
    if rng.random() < 0.5:
        return draw_binary(rng, samples)
    from mcap.reader import make_reader
    from mcap.writer import CompressionType, Writer

    reader, stream = make_reader(BytesIO(samples[0])), BytesIO()
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
    from argo_env.planning.opening import open_site
    from argo_planner.use_cases.exporting import export_mission
    from argo_planner.use_cases.importing import Upload, import_mission

    site = open_site("umad")
    [script] = texts("scenarios/umad/missions/mission_1.txt")
    imported = import_mission(Upload("mission_1.txt", script), site, 1, 1)
    content = export_mission(imported, site, "isar").content
    assert isinstance(content, str)
    return (content.encode(),)


@cache
def route_problems() -> tuple[bytes, ...]:
    import numpy as np

    from argo_compiler.files.route_problem_file import route_problem_text
    from argo_compiler.route.problem import EnergyBudget, Precedence, Round, RouteProblem, Visit

    visits = (Visit("valve 1", 5), Visit("gauge 2", mandatory=False, prize=3), Visit("level 3"))
    travel = np.arange(16).reshape(4, 4)
    plain = RouteProblem(visits, travel, max_duration=100, unit=0.5)
    rich = RouteProblem(
        (*visits, Visit("valve 4", earliest=10, latest=60)),
        np.arange(36).reshape(6, 6),
        precedences=(Precedence((0, 3), "valve 1 before valve 4", needed=True),),
        rounds=(Round("Round", (1, 2), repeat=3, duration=50, soft=True),),
        battery=EnergyBudget(np.ones((6, 6), np.int64), capacity=90, used=10, overhead=4),
        chargers=("dock",),
        words={"max_duration": "in 2 min"},
    )
    return tuple(route_problem_text(one).encode() for one in (plain, rich))


@cache
def documents(suffix: str) -> tuple[bytes, ...]:
    """Return documents with what their readers look at: merged and hidden cells, lists, columns."""
    from tests.argo_compiler.script import documents_made as made

    match suffix:
        case ".xlsx":
            return made.workbook(), made.workbook(change=made.furnish)
        case ".docx":
            return (made.word(made.fill_with_all),)
        case ".pdf":
            table = (("CP", "Name"), ("1", "gauge\n1"), ("Floor 2", ""), ("2", "gauge 2"))
            return made.pdf(made.draw_columns), made.pdf_table(table, ((2, 2),))
    return (b'\xef\xbb\xbfCP;"Na\nme";Min\r\n1;"a;b";3,5\r\n', b"a,b\n# c\n1,2\n", b"a\tb\n1\t2\n")


def draw_zipped(rng: random.Random, samples: Sequence[bytes]) -> bytes:
    """Return a mutated document, or a whole one with a mutated part."""
    import zipfile

    if rng.random() < 0.2:
        return draw_binary(rng, samples)
    stream = BytesIO()
    with (
        zipfile.ZipFile(BytesIO(rng.choice(samples))) as read,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as written,
    ):
        names = read.namelist()
        changed = {*rng.sample(names, min(len(names), rng.choice((1, 1, 2))))}
        for name in names:
            content = read.read(name)
            written.writestr(name, draw_text(rng, (content,)) if name in changed else content)
    return stream.getvalue()


READERS = {
    "ros1": Reader(read_bag_file, ".bag", partial(bags, ".bag"), draw_ros1_bag, limited=True),
    "sqlite": Reader(read_bag_file, ".db3", partial(bags, ".db3"), draw_sqlite_bag, limited=True),
    "mcap": Reader(read_bag_file, ".mcap", partial(bags, ".mcap"), draw_binary, limited=True),
    "metadata": Reader(read_bag_folder, ".yaml", metadata_of_bags, limited=True),
    "recording": Reader(
        read_recording_file, ".mcap", lambda: run_files()[:1], draw_recording, limited=True
    ),
    "journal": Reader(read_journal_file, ".journal", lambda: run_files()[1:], draw_binary),
    "script": Reader(read_mission_source, ".txt", scripts),
    "workbook": Reader(
        read_document_file, ".xlsx", partial(documents, ".xlsx"), draw_zipped, limited=True
    ),
    "text document": Reader(
        read_document_file, ".docx", partial(documents, ".docx"), draw_zipped, limited=True
    ),
    "pages": Reader(
        read_document_file, ".pdf", partial(documents, ".pdf"), draw_binary, limited=True
    ),
    "separated values": Reader(read_separated_file, ".csv", partial(documents, ".csv")),
    "mission": Reader(
        read_mission_source, ".json", lambda: (mission().model_dump_json().encode(),)
    ),
    "isar": Reader(read_mission_source, ".json", isar_missions),
    "site": Reader(read_site_file, ".yaml", partial(texts, "scenarios/*/site.yaml")),
    "faults": Reader(read_faults_file, ".yaml", partial(texts, "scenarios/umad/faults/*.yaml")),
    "evaluation": Reader(
        read_evaluation_file, ".yaml", partial(texts, "scenarios/umad/evaluation.yaml")
    ),
    "route problem": Reader(read_route_file, ".json", route_problems),
}


def read_or_refuse(name: str, path: Path) -> str:
    """Return `read` or `refused` for a file; any other outcome is an error of the reader."""
    try:
        READERS[name].read(path)
    except ArgoError:
        return "refused"
    return "read"


def try_inputs(name: str, first: int, count: int) -> Iterator[tuple[str, str, float]]:
    """Yield name, outcome and time (s) of each sample of a reader, and of its inputs."""
    from tests.campaigns.readers import read_or_refuse  # not of `__main__`, for the other process

    reader = READERS[name]
    samples = ((f"sample {i}", content) for i, content in enumerate(reader.samples()))
    numbers = range(first, first + count)
    inputs = ((str(n), reader.make(random.Random(f"{name} {n}"))) for n in numbers)
    with tempfile.TemporaryDirectory() as folder, process_kept():
        path = Path(folder) / f"fuzz{reader.suffix}"
        for input, content in chain(samples, inputs):
            path.write_bytes(content)
            limits = limits_for_size(path.stat().st_size, held=path.stat().st_size)
            begun = time.monotonic()
            try:
                outcome = call_limited(limits, MODULES, read_or_refuse, name, path)
            except LimitExceeded as error:
                outcome = f"{'beyond limits' if reader.limited else 'ERROR'}: {error}"
            except Exception as error:
                outcome = f"ERROR: {type(error).__name__}: {error}"
            if input.startswith("sample") and outcome != "read":
                outcome = f"ERROR: it is not read, but {outcome}"
            yield input, outcome, time.monotonic() - begun


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
        for input, outcome, seconds in try_inputs(name, options.first, options.count):
            kind = outcome.partition(":")[0]
            outcomes[kind] += 1
            if kind == "ERROR":
                print(f"{name} {input}: {outcome[:300]}", flush=True)
            slowest = max(slowest, seconds)
        failed = failed or bool(outcomes["ERROR"])
        counts = ", ".join(f"{kind} {count}" for kind, count in sorted(outcomes.items()))
        print(f"{name:<14} {options.count} inputs: {counts}; slowest {slowest:.1f} s", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
