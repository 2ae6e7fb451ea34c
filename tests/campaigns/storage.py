"""Campaign: damaged files, and what a loss of power leaves: `python -m tests.campaigns.storage`.

Journals, plans, rows and Parquet files are damaged at random places: a bit is flipped, or a page of
4 kB is zeroed, dropped or swapped with another one. Nothing of them may then be read as if it were
whole. Of journals, plans and rows, pages that were not synced are lost as well, in any order:
nothing that was synced may be lost then, and all losses must be told.
"""

import argparse
import os
import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from argo_compiler.base.errors import ArgoError
from argo_compiler.editing import commands as edits
from argo_compiler.il import Mission, Task
from argo_env.evaluation.row import RunOutcome, RunRow
from argo_env.evaluation.store import LOG, RowStore, read_rows
from argo_env.files import checked_lines
from argo_env.planning.opening import open_site
from argo_env.run.journal import Header, create_journal, open_journal
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.service.core.commands import EditPlan
from argo_planner.service.core.document import PlanDocument
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.storage.plan_file import open_plan_file, write_plan_file
from argo_planner.use_cases.importing import Upload, import_mission

PAGE = 4096
MISSION = Path(__file__).parents[2] / "scenarios/umad/missions/mission_1.txt"
AT = datetime(2026, 1, 2, tzinfo=UTC)


@dataclass(frozen=True)
class Outcome:
    """Result of reading a file: its items, and the message about the rest."""

    items: Sequence[Any]
    """entries, revisions or rows"""
    told: str
    """what was lost or damaged; empty: nothing"""


@dataclass(frozen=True)
class Subject:
    """Kind of file, one of them that is whole, and how it is read."""

    name: str
    content: bytes
    syncs: Sequence[int]
    """sizes in bytes at which the file was synced, in order; the last one may be its whole size"""
    items: Sequence[Any]
    """what is in the whole file"""
    ends: Sequence[int]
    """size in bytes that the file needs to have for each of the items"""
    read: Callable[[bytes], Outcome]
    """reads a file with this content; raises ArgoError if it is refused"""
    in_order: bool = True
    """whether an item can only be read if all before it can"""


class Failure(Exception):
    """Raised when a file is read in another way than it should be."""


def flip(content: bytes, rng: random.Random) -> bytes:
    """Return the content with one flipped bit."""
    damaged = bytearray(content)
    damaged[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    return bytes(damaged)


def zero(content: bytes, rng: random.Random) -> bytes:
    """Return the content with one page of zeros."""
    at = rng.randrange(0, len(content), PAGE)
    return content[:at] + bytes(len(content[at : at + PAGE])) + content[at + PAGE :]


def drop(content: bytes, rng: random.Random) -> bytes:
    """Return the content without one of its pages, but not without the last."""
    at = rng.randrange(0, len(content) - PAGE, PAGE) if len(content) > PAGE else 0
    return content[:at] + content[at + PAGE :]


def swap(content: bytes, rng: random.Random) -> bytes:
    """Return the content with two pages swapped."""
    pages = [content[at : at + PAGE] for at in range(0, len(content), PAGE)]
    if len(pages) < 2:
        return zero(content, rng)
    a, b = rng.sample(range(len(pages)), 2)
    pages[a], pages[b] = pages[b], pages[a]
    return b"".join(pages)


DAMAGES = {"flipped": flip, "zeroed": zero, "dropped": drop, "swapped": swap}


def lose_power(subject: Subject, rng: random.Random) -> tuple[bytes, int]:
    """Return what a loss of power leaves of a file at a random time, and how much was synced."""
    written = rng.randint(subject.syncs[0], len(subject.content))
    synced = max(size for size in subject.syncs if size <= written)
    left = bytearray(subject.content[:written])
    for at in range(synced - synced % PAGE, written, PAGE):
        first = max(at, synced)
        fate = rng.choice(("written", "lost", "written in part"))
        if fate != "written":
            kept = first if fate == "lost" else rng.randint(first, min(at + PAGE, written))
            end = min(at + PAGE, written)
            left[kept:end] = bytes(end - kept)
    if rng.random() < 0.3:
        del left[rng.randint(synced, written) :]
    return bytes(left), synced


def check_damage(subject: Subject, damaged: bytes) -> str:
    """Return how a damaged file is read; raise Failure if the damage is not told."""
    try:
        outcome = subject.read(damaged)
    except ArgoError:
        return "refused"
    require_part(subject, outcome)
    if outcome.told:
        return "told"
    # Only marks can be missing without a word: the end of a file that a killed process leaves.
    if list(outcome.items) != list(subject.items):
        raise Failure(f"{subject.name}: {len(outcome.items)} of {len(subject.items)}, and no word")
    return "whole"


def check_loss(subject: Subject, left: bytes, synced: int) -> str:
    """Return how a file is read after a loss of power; raise Failure if synced items are lost."""
    try:
        outcome = subject.read(left)
    except ArgoError as error:
        raise Failure(f"{subject.name}: refused after a loss of power: {error}") from error
    require_part(subject, outcome)
    must = sum(end <= synced for end in subject.ends)
    if list(outcome.items[:must]) != list(subject.items[:must]):
        raise Failure(f"{subject.name}: of {must} synced items, some are lost")
    if not outcome.told and left != subject.content[: len(left)]:
        raise Failure(f"{subject.name}: a loss of power is not told")
    return "told" if outcome.told else "complete"


def require_part(subject: Subject, outcome: Outcome) -> None:
    """Raise Failure if something was read that the whole file does not have."""
    whole = list(subject.items)
    if subject.in_order and list(outcome.items) != whole[: len(outcome.items)]:
        raise Failure(f"{subject.name}: other items were read")
    if not subject.in_order and not set(outcome.items) <= set(whole):
        raise Failure(f"{subject.name}: an item was read that was never written")


def logged_syncs(write: Callable[[], None]) -> list[int]:
    """Call a function that writes lines, and return the sizes of the file at each sync."""
    sizes: list[int] = []
    original = checked_lines.sync_content

    def sync(file: int) -> None:
        original(file)
        sizes.append(os.fstat(file).st_size)

    with patch.object(checked_lines, "sync_content", sync):
        write()
    return sizes


def ends_of(content: bytes, mark: bytes) -> list[int]:
    """Return the positions of the ends of all lines that contain `mark`."""
    ends, size = [], 0
    for line in content.splitlines(keepends=True):
        size += len(line)
        if mark in line:
            ends.append(size)
    return ends


def journal_of_a_mission(folder: Path) -> Subject:
    """Return the journal of mission #1, in which up to 13 pages in a row were not synced."""
    site = open_site("umad").prepare()
    mission = import_mission(Upload(MISSION.name, MISSION.read_bytes()), site, 1, 2).mission
    path = folder / "run.journal"
    spec = RunSpec(mission=mission, site="umad", drive="kinematic")
    create_journal(folder / "empty.journal", Header.from_run(site, spec)).close()
    begun = (folder / "empty.journal").stat().st_size
    syncs = logged_syncs(lambda: simulate(spec, site, journal=path) and None)
    content = path.read_bytes()

    def read(damaged: bytes) -> Outcome:
        path.write_bytes(damaged)
        with open_journal(path) as journal:
            return Outcome(journal.entries, journal.loss)

    entries = read(content).items
    return Subject("journal", content, [begun, *syncs], entries, ends_of(content, b'"t":'), read)


def plan_with_revisions(folder: Path, revisions: int = 60) -> Subject:
    """Return the file of a plan whose revisions take up to some pages each."""
    rng = random.Random(1)
    path = folder / "0123456789ab.plan"
    mission = Mission(
        tasks=(Task.model_validate({"name": "a", "action": "MEASURE", "object_id": "1"}),)
    )
    document = PlanDocument("0123456789ab", "round", AT, AT, MissionPlan(mission))
    with write_plan_file(path, document) as file:
        begun = path.stat().st_size

        def write() -> None:
            for number in range(revisions):
                text = "x" * rng.choice((10, 200, 9_000))
                edit = edits.SetHeader(anomaly_specification=f"{number}{text}")
                command = EditPlan(id=f"c{number}", edits=(edit,))
                plan = file.document.plan
                file.append(*file.document.with_plan(plan.execute(command, "ann", None, AT)))

        syncs = logged_syncs(write)
    content = path.read_bytes()

    def read(damaged: bytes) -> Outcome:
        for other in folder.glob("*.plan.*"):  # what was kept of earlier ones
            other.unlink()
        path.write_bytes(damaged)
        with open_plan_file(path) as opened:
            told = opened.recovery.message if opened.recovery else ""
            return Outcome(opened.document.plan.history, told)

    ends = ends_of(content, b'"kind":"revision"')
    return Subject("plan", content, [begun, *syncs], read(content).items, ends, read)


def rows_of_an_evaluation(folder: Path, count: int = 400) -> Subject:
    """Return the log of rows of an evaluation, which was synced after each 60 rows."""
    rows = [
        RunRow(
            key=f"{number:024x}", mission="m", policy="as written", site="umad", robot="tracker",
            drive="route", sensor="ideal", faults="none", seed=number, outcome=RunOutcome.SUCCESS,
            reason="done", duration=100.0 + number,
        )
        for number in range(count)
    ]  # fmt: skip
    path = folder / LOG

    def write() -> None:
        with RowStore(folder, clock=lambda: 0.0) as store:
            for number, row in enumerate(rows):
                store.add_if_new(row)
                if number % 60 == 59:
                    store.sync()

    syncs = logged_syncs(write)
    content = path.read_bytes()

    def read(damaged: bytes) -> Outcome:
        path.write_bytes(damaged)
        read_rows(folder)  # refuses what is no loss of power
        with RowStore(folder) as store:
            return Outcome([*map(RunRow.model_dump_json, store.rows.values())], store.loss)

    ends = ends_of(content, b'"key":')
    items = [*map(RunRow.model_dump_json, rows)]
    return Subject("rows", content, [0, *syncs], items, ends, read, in_order=False)


def part_of_an_evaluation(folder: Path) -> Subject:
    """Return a Parquet file with the rows of an evaluation."""
    rows = rows_of_an_evaluation(folder, 4_000).items
    with RowStore(folder) as store:
        store.compact()
    (path,) = (folder / "parts").iterdir()
    content = path.read_bytes()

    def read(damaged: bytes) -> Outcome:
        path.write_bytes(damaged)
        return Outcome([*map(RunRow.model_dump_json, read_rows(folder))], "")

    return Subject("part", content, [len(content)], rows, [len(content)] * len(rows), read)


SUBJECTS = (journal_of_a_mission, plan_with_revisions, rows_of_an_evaluation, part_of_an_evaluation)


def try_places(subject: Subject, places: int, rng: random.Random) -> None:
    """Damage a file at that many places in each way, and print what became of it."""
    for name, damage in DAMAGES.items():
        counts: Counter[str] = Counter()
        while counts.total() < places:
            damaged = damage(subject.content, rng)
            if damaged != subject.content:
                counts[check_damage(subject, damaged)] += 1
        print(f"{subject.name} {name}: {describe(counts)}")
    if subject.name != "part":
        counts = Counter(check_loss(subject, *lose_power(subject, rng)) for _ in range(places))
        print(f"{subject.name} lost: {describe(counts)}")


def describe(counts: Counter[str]) -> str:
    """Return counts as text, such as `3 complete, 17 told`."""
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign, and return 1 if damage or a loss was not told, else 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--places", type=int, default=1_000, help="places in each way")
    parser.add_argument("--seed", type=int, default=0, help="seed of the places")
    given = parser.parse_args(arguments)
    rng = random.Random(given.seed)
    for make in SUBJECTS:
        with TemporaryDirectory() as name:
            subject = make(Path(name))
            pages = -(-len(subject.content) // PAGE)
            print(f"{subject.name}: {len(subject.items)} items in {pages} pages")
            try:
                try_places(subject, given.places, rng)
            except Failure as failure:
                print(failure)
                return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
