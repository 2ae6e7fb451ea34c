"""Mission plans on disk: written changes survive damage of the file and a killed process."""

import os
import random
import re
import subprocess
import sys
import textwrap
import threading
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from itertools import count, pairwise
from pathlib import Path

import pytest

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.editing import commands as edits
from argo_compiler.il import Mission
from argo_env.files.checked_lines import checked_line, checked_object
from argo_planner.service.core.commands import EditPlan, UndoEdit
from argo_planner.service.core.document import PlanDocument
from argo_planner.service.core.refusals import PlanTooLarge
from argo_planner.service.storage import plan_file
from argo_planner.service.storage.folder import PlanFolder
from argo_planner.service.storage.plan_file import (
    KEPT_RECORDS,
    MOST_RECORDS,
    PlanFile,
    open_plan_file,
)
from tests.argo_planner.service.test_plan import mission

AT = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)
NUMBERS = count(1)


def next_id() -> str:
    return f"{next(NUMBERS):012x}"


@pytest.fixture
def folder(tmp_path):
    with PlanFolder(tmp_path / "plans", next_id) as opened:
        yield opened


def execute(file: PlanFile, command: EditPlan | UndoEdit) -> None:
    document = file.document
    plan = document.plan.execute(command, "ann", document.plan.revision, AT)
    file.append(*document.with_plan(plan))


def edit(file: PlanFile, id: str, velocity: float) -> None:
    change = edits.ChangeTask(name="a", velocity=velocity)
    execute(file, EditPlan(id=id, edits=(change,)))


def create_plan(folder: PlanFolder, revisions: int = 6) -> tuple[str, PlanDocument]:
    with folder.create("Round", mission("a", "b"), AT) as file:
        for k in range(revisions):
            edit(file, f"c{k}", 0.1 + k / 1000)
        return file.document.id, file.document


def plan_path(folder: PlanFolder, id: str) -> Path:
    return folder.path / f"{id}.plan"


def test_a_written_plan_is_read_back(folder):
    with folder.create("Round", mission("a", "b"), AT) as file:
        edit(file, "c1", 0.2)
        document = file.document
        file.append(document.apply(r := document.make_rename_record("Tour", "ann", AT)), r)
        document = file.document
        file.append(document.apply(r := document.make_version_record("first", "ann", AT)), r)
        edit(file, "c2", 0.3)
        execute(file, UndoEdit(id="u"))
        written = file.document
    with folder.open(written.id) as again:
        assert again.document == written
        assert again.recovery is None
        assert again.document.version(1).mission.tasks[0].velocity == 0.2
        with pytest.raises(NotFound, match="it has: 1 \\('first'\\)"):
            again.document.version(2)
        with pytest.raises(Conflict, match="already"):
            again.document.make_version_record("first", "bob", AT)
    (summary,) = folder.list_plans()
    assert (summary.name, summary.revision, summary.tasks) == ("Tour", 4, 2)


def test_an_incomplete_last_line_is_cut_off(folder):
    id, document = create_plan(folder)
    path = plan_path(folder, id)
    content = path.read_bytes()
    content = content[: content.rindex(b"\n", 0, -1) + 1]  # without the mark at the end
    last = content.rindex(b"\n", 0, -1) + 1
    for length in {*random.Random(1).sample(range(last + 1, len(content)), 20)}:
        path.write_bytes(content[:length])
        with folder.open(id) as file:
            assert file.recovery is None
            assert file.document.plan.revision == document.plan.revision - 1
            edit(file, "c5", 0.1 + 5 / 1000)
            assert file.document == document


def test_the_last_valid_state_of_a_damaged_file_is_opened(folder):
    id, document = create_plan(folder)
    path = plan_path(folder, id)
    content = path.read_bytes()
    rng = random.Random(2)
    for _ in range(30):
        at = rng.randrange(content.index(b"\n") + 1, len(content) - 1)
        damaged = bytearray(content)
        damaged[at] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged)
        complete = content[:at].split(b"\n")[:-1]
        revision = 1 + sum(b'"kind":"revision"' in line for line in complete)
        with folder.open(id) as file:
            assert file.document.plan.revision == revision
            assert file.document.plan.history == document.plan.history[: revision - 1]
            assert file.recovery is not None
            assert f"revision {revision}" in file.recovery.message
            damaged_path = path.with_name(file.recovery.damaged_name)
            assert damaged_path.read_bytes() == damaged
        with folder.open(id) as file:
            assert file.recovery is None


@pytest.mark.parametrize("tail", [b"0 {}\n", bytes(4096), b"\0"])
def test_what_a_loss_of_power_leaves_after_the_last_change_is_told(folder, tail):
    id, document = create_plan(folder)
    path = plan_path(folder, id)
    path.write_bytes(path.read_bytes() + tail)
    with folder.open(id) as file:
        assert file.document == document
        assert file.recovery is not None
        said = file.recovery.message
        assert re.search(r"the loss is at least 1 line after the first \d+, as by a loss of", said)


def test_a_last_change_that_was_on_disk_is_not_taken_for_a_loss_of_power(folder):
    id, document = create_plan(folder)
    path = plan_path(folder, id)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[-2] = bytes(len(lines[-2]) - 1) + b"\n"
    path.write_bytes(b"".join(lines))
    with folder.open(id) as file:
        assert file.document.plan.revision == document.plan.revision - 1
        assert file.recovery is not None
        assert "loss of power" not in file.recovery.message


def test_a_plan_without_marks_is_read(folder):
    """Plans had no marks."""
    id, document = create_plan(folder)
    path = plan_path(folder, id)
    objects = [checked_object(line) for line in path.read_bytes().splitlines()]
    old = [data for data in objects if data and set(data) != {"n"}]
    path.write_bytes(b"".join(checked_line(data | {"n": n}) for n, data in enumerate(old)))
    with folder.open(id) as file:
        assert (file.document, file.recovery) == (document, None)
        edit(file, "later", 0.5)
        later = file.document
    with folder.open(id) as file:
        assert (file.document, file.recovery) == (later, None)


def test_the_previous_file_is_opened_if_the_first_line_is_damaged(folder):
    id, _ = create_plan(folder, MOST_RECORDS + 3)
    path = plan_path(folder, id)
    content = path.read_bytes()
    path.write_bytes(b"x" + content[1:])
    with folder.open(id) as file:
        assert file.recovery is not None
        assert "first line" in file.recovery.message
        assert file.document.plan.revision == MOST_RECORDS + 1
    path.write_bytes(b"x" + content[1:])
    for other in path.parent.glob("*.before"):
        other.unlink()
    with pytest.raises(Invalid, match="from its first line on"):
        folder.open(id)
    (summary,) = folder.list_plans()
    assert summary.problem is not None
    assert "damaged" in summary.problem


def test_the_last_revisions_of_a_rewritten_file_can_be_undone(folder):
    id, document = create_plan(folder, MOST_RECORDS + 1)
    lines = plan_path(folder, id).read_bytes().count(b"\n")
    assert lines < MOST_RECORDS
    with folder.open(id) as file:
        plan = file.document.plan
        assert plan.mission == document.plan.mission
        assert plan.revision == document.plan.revision
        assert len(plan.history) >= KEPT_RECORDS
        assert plan.history == document.plan.history[-len(plan.history) :]
        undone = plan.execute(UndoEdit(id="u"), "ann", plan.revision, AT)
        assert undone.mission == document.plan.missions[-1]


def test_plans_are_moved_to_the_bin_and_restored(folder):
    id, document = create_plan(folder)
    folder.delete(id)
    assert folder.list_plans() == []
    assert [plan.id for plan in folder.list_deleted()] == [id]
    with pytest.raises(NotFound, match="no mission"):
        folder.open(id)
    folder.restore(id)
    with folder.open(id) as file:
        assert file.document == document
    folder.delete(id)
    folder.delete_from_bin(id)
    assert folder.list_deleted() == []
    with pytest.raises(NotFound):
        folder.restore(id)


def test_no_file_outside_the_folder_is_opened(folder, tmp_path):
    id, _ = create_plan(folder)
    elsewhere = tmp_path / "elsewhere.plan"
    plan_path(folder, id).rename(elsewhere)
    plan_path(folder, id).symlink_to(elsewhere)
    assert folder.list_plans() == []
    for wrong in (id, "../elsewhere", "..", "", "a" * 12 + "/", "A" * 12, "\0" * 12):
        for act in (folder.open, folder.delete, folder.restore, folder.delete_from_bin):
            with pytest.raises(NotFound):
                act(wrong)
    assert elsewhere.exists()


def test_only_one_service_at_a_time_uses_a_folder(folder):
    with pytest.raises(Conflict, match="another service"):
        PlanFolder(folder.path, next_id)


def test_names_are_texts_with_visible_characters(folder):
    for name in ("", "  ", "x" * 201, "a\0b", "a\u202eb", "\ud800"):
        with pytest.raises(Invalid):
            folder.create(name, Mission(tasks=()), AT)
    for name in ("../x", "<img src=x onerror=alert(1)>", "גשר", "数", "."):
        folder.create(name, Mission(tasks=()), AT).close()
    assert {plan.name for plan in folder.list_plans()} == {
        "../x", "<img src=x onerror=alert(1)>", "גשר", "数", ".",
    }  # fmt: skip


def test_the_newest_plans_come_first(folder):
    for k in (2, 1, 3):
        folder.create(str(k), Mission(tasks=()), AT + timedelta(hours=k)).close()
    assert [plan.name for plan in folder.list_plans()] == ["3", "2", "1"]


WRITER = textwrap.dedent(
    """
    import sys
    from pathlib import Path
    from argo_planner.service.storage.plan_file import open_plan_file
    from tests.argo_planner.service.test_storage import edit

    with open_plan_file(Path(sys.argv[1])) as file:
        while True:
            number = file.document.plan.revision
            edit(file, f"k{number}", 0.1 + number / 1e5)
            print(number + 1, flush=True)
    """
)


@pytest.mark.long
def test_acknowledged_changes_survive_a_kill(folder):
    with folder.create("Round", mission("a", "b"), AT) as file:
        path = file.path
    rng = random.Random(3)
    acknowledged = 1
    for _ in range(6):
        writer = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path)],
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
        )
        assert writer.stdout is not None
        for _ in range(rng.randint(1, 250)):
            acknowledged = int(writer.stdout.readline())
        writer.kill()
        rest = writer.stdout.read().split(b"\n")[:-1]
        acknowledged = int(rest[-1]) if rest else acknowledged
        writer.wait()
        writer.stdout.close()
        with open_plan_file(path) as file:
            assert file.recovery is None
            assert acknowledged <= file.document.plan.revision <= acknowledged + 1
            acknowledged = file.document.plan.revision
            assert len({r.id for r in file.document.plan.history}) == len(
                file.document.plan.history
            )


def add_large_revision(file: PlanFile, k: int, characters: int) -> None:
    change = edits.SetHeader(anomaly_specification=f"{k}" + "x" * characters)
    execute(file, EditPlan(id=f"m{k}", edits=(change,)))


def test_a_file_of_few_large_records_stays_small_however_often_it_is_opened(folder, monkeypatch):
    monkeypatch.setattr(plan_file, "MAX_GROWTH", 100_000)
    with folder.create("Round", mission("a", "b"), AT) as file:
        id = file.document.id
    sizes = []
    for k in range(60):
        with folder.open(id) as file:
            add_large_revision(file, k, 9_000)
        sizes.append(plan_path(folder, id).stat().st_size)
    assert max(sizes) < 150_000
    assert sum(later < size for size, later in pairwise(sizes)) < 20
    with folder.open(id) as file:
        plan = file.document.plan
        assert plan.revision == 61
        assert plan.execute(UndoEdit(id="u"), "ann", 61, AT).mission == plan.missions[-1]


def test_a_change_that_would_make_the_file_too_large_is_refused(folder, monkeypatch):
    monkeypatch.setattr(plan_file, "MAX_BYTES", 50_000)
    with folder.create("Round", mission("a", "b"), AT) as file:
        id = file.document.id
        for k in range(2):
            add_large_revision(file, k, 9_000)
        written = file.document
        with pytest.raises(PlanTooLarge, match="delete some of its versions"):
            add_large_revision(file, 4, 19_900)
    with folder.open(id) as file:
        assert file.document == written


def test_a_plan_of_another_format_version_is_listed_with_the_problem(folder):
    id, _ = create_plan(folder)
    path = plan_path(folder, id)
    base = checked_object(path.read_bytes().split(b"\n")[0])
    assert base is not None
    path.write_bytes(checked_line(base | {"version": 99}))
    (summary,) = folder.list_plans()
    assert summary.problem is not None
    assert "version 99" in summary.problem
    with pytest.raises(Invalid, match="version 99"):
        folder.open(id)


def test_plans_are_moved_while_they_are_listed(folder):
    ids = [create_plan(folder, 1)[0] for _ in range(20)]
    finished = threading.Event()

    def move() -> None:
        while not finished.is_set():
            for id in ids:
                folder.delete(id)
            for id in ids:
                folder.restore(id)

    with ThreadPoolExecutor(1) as thread:
        moving = thread.submit(move)
        try:
            for _ in range(300):
                assert not [plan.problem for plan in folder.list_plans() if plan.problem]
                folder.list_deleted()
        finally:
            finished.set()
        moving.result()
