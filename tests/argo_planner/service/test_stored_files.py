"""Stored files of a service: each is a regular file under its own id, or is refused by name."""

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

import pytest

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_planner.service.evaluations.evaluations import EvaluationFolder, StoredEvaluation
from argo_planner.service.jobs.evaluation import EvaluationAsked, EvaluationSpec
from argo_planner.service.jobs.job import EvaluationJob, JobState, OrderJob
from argo_planner.service.jobs.order_search import OrderFound
from argo_planner.service.jobs.order_searches import OrderFolder
from argo_planner.service.runs.folder import RunFolder, StoredRun
from argo_planner.service.runs.requests import RunOrder
from argo_planner.service.runs.state import RunState, RunStatus
from argo_planner.service.storage.folder import PlanFolder
from argo_planner.service.storage.import_notes import load_import_notes, store_import_notes
from argo_planner.service.web.access import load_or_make_secret
from argo_planner.service.world.obstacle_store import ObstacleStore
from tests.argo_planner.service.test_plan import mission
from tests.argo_planner.service.test_run_host import open_host
from tests.argo_planner.service.test_storage import edit

AT = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)
ID, OTHER = "0123456789ab", "ba9876543210"
RUN, OTHER_RUN = "20260102-030405-0123", "20260102-030406-3210"
MISSION = mission("a", "b")


def open_plans(root: Path, id: str = ID) -> PlanFolder:
    return PlanFolder(root, lambda: id)


def write_plan(root: Path) -> Path:
    with open_plans(root) as folder:
        folder.create("Round", MISSION, AT).close()
    return root / f"{ID}.plan"


def read_plan(root: Path, id: str) -> str:
    with open_plans(root) as folder, folder.open(id) as file:
        return file.document.id


def write_run(root: Path, entries: int = 0, status: RunStatus = RunStatus.ENDED) -> Path:
    order = RunOrder(plan=ID, revision=1, name="Round", mission=MISSION, site="umad")
    state = RunState(
        id=RUN, plan=ID, revision=1, name="Round", by="ann", begun=AT, status=status,
        drive="route", seed=0, speed=None, entries=entries,
    )  # fmt: skip
    return RunFolder(root / "runs").create_run(StoredRun(order=order, state=state))


def read_run(root: Path, id: str) -> str:
    return RunFolder(root / "runs").load_run(id).state.id


def write_evaluation(root: Path) -> Path:
    asked = EvaluationAsked(worlds=1)
    spec = EvaluationSpec(name="Round", mission=MISSION, site="umad", asked=asked)
    job = EvaluationJob(
        id=ID, mission=OTHER, revision=1, author="ann", begun=AT, state=JobState.DONE, asked=asked
    )
    EvaluationFolder(root / "evaluations").store(StoredEvaluation(order=spec, job=job))
    return root / "evaluations" / ID


def read_evaluation(root: Path, id: str) -> str:
    return EvaluationFolder(root / "evaluations").load_evaluation(id).job.id


def write_order(root: Path) -> Path:
    job = OrderJob(
        id=ID, mission=OTHER, revision=1, author="ann", begun=AT, state=JobState.DONE,
        found=OrderFound(mission=MISSION),
    )  # fmt: skip
    OrderFolder(root / "orders").store(job)
    return root / "orders" / f"{ID}.json"


def list_orders(root: Path) -> list[str]:
    return [job.id for job in OrderFolder(root / "orders").load_orders()]


def list_evaluations(root: Path) -> list[str]:
    return [one.job.id for one in EvaluationFolder(root / "evaluations").load_all()]


def list_runs(root: Path) -> list[str]:
    return [run.state.id for run in RunFolder(root / "runs").load_runs_newest_first()]


def copy(source: Path, target: Path) -> None:
    (shutil.copytree if source.is_dir() else shutil.copy)(source, target)


@pytest.mark.parametrize(
    ("write", "read", "id", "other"),
    [
        (write_plan, read_plan, ID, OTHER),
        (write_run, read_run, RUN, OTHER_RUN),
        (write_evaluation, read_evaluation, ID, OTHER),
    ],
)
@pytest.mark.parametrize("act", [copy, Path.rename])
def test_what_lies_under_another_id_is_refused(
    tmp_path: Path,
    write: Callable[[Path], Path],
    read: Callable[[Path, str], str],
    id: str,
    other: str,
    act: Callable[[Path, Path], object],
) -> None:
    path = write(tmp_path)
    target = path.with_name(path.name.replace(id, other))
    act(path, target)
    with pytest.raises(Unavailable, match=f"{target.name}.*the id in it is {id}: rename it so"):
        read(tmp_path, other)
    if not path.exists():
        target.rename(path)
    assert read(tmp_path, id) == id


@pytest.mark.parametrize(
    ("write", "list_ids", "id", "other"),
    [
        (write_run, list_runs, RUN, OTHER_RUN),
        (write_evaluation, list_evaluations, ID, OTHER),
        (write_order, list_orders, ID, OTHER),
    ],
)
def test_a_list_leaves_out_what_lies_under_another_id_and_the_log_names_it(
    tmp_path: Path,
    write: Callable[[Path], Path],
    list_ids: Callable[[Path], list[str]],
    id: str,
    other: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    path = write(tmp_path)
    target = path.with_name(path.name.replace(id, other))
    copy(path, target)
    assert list_ids(tmp_path) == [id]
    (line,) = caplog.messages
    assert f"{target} was copied or renamed, as the id in it is {id}: rename it so, or" in line


def test_a_copy_of_a_plan_takes_no_edits_and_is_listed_with_the_way_out(tmp_path: Path) -> None:
    path = write_plan(tmp_path)
    copied = tmp_path / f"{OTHER}.plan"
    shutil.copy(path, copied)
    content = copied.read_bytes()
    with open_plans(tmp_path) as folder:
        problems = {plan.id: plan.problem for plan in folder.list_plans()}
        with folder.open(ID) as file:
            edit(file, "c1", 0.2)
        assert problems[ID] is None
        assert f"the id in it is {ID}: rename it so" in (problems[OTHER] or "")
        assert copied.read_bytes() == content
        folder.delete(OTHER)
        with folder.open(ID) as file:
            assert file.document.plan.revision == 2
        with pytest.raises(Unavailable, match="rename it so"):
            folder.restore(OTHER)
        assert [plan.id for plan in folder.list_deleted()] == [OTHER]


def test_swapped_plans_are_both_refused(tmp_path: Path) -> None:
    one = write_plan(tmp_path)
    with open_plans(tmp_path, OTHER) as folder:
        folder.create("Other", mission("c"), AT).close()
    between, two = tmp_path / "between", tmp_path / f"{OTHER}.plan"
    one.rename(between)
    two.rename(one)
    between.rename(two)
    for id in (ID, OTHER):
        with pytest.raises(Unavailable, match="copied or renamed"):
            read_plan(tmp_path, id)


def test_neither_delete_nor_restore_replaces_a_plan(tmp_path: Path) -> None:
    path = write_plan(tmp_path)
    with open_plans(tmp_path) as folder:
        folder.delete(ID)
        shutil.copy(tmp_path / "bin" / path.name, path)
        with folder.open(ID) as file:
            edit(file, "c1", 0.2)
        for act in (folder.restore, folder.delete):
            with pytest.raises(Conflict, match="exists already"):
                act(ID)
        with folder.open(ID) as file:
            assert file.document.plan.revision == 2


def write_notes(root: Path) -> Path:
    store_import_notes(root, ID, 3, ())
    return root / "notes" / f"{ID}.json"


def read_notes(root: Path) -> None:
    if load_import_notes(root, ID)[0] == 0:
        raise Unavailable("the log names it")


def write_obstacles(root: Path) -> Path:
    ObstacleStore(root).replace((), None)
    return root / "obstacles.json"


def write_secret(root: Path) -> Path:
    load_or_make_secret(root)
    return root / ".token"


def list_one_order(root: Path) -> None:
    if not list_orders(root):
        raise Unavailable("the log names it")


def write_requests(root: Path) -> Path:
    path = write_run(root) / "requests"
    path.touch()
    return path


def link(path: Path) -> None:
    """Put a link to a file outside the folder in the place of a file."""
    outside = path.parent / "outside"
    path.rename(outside)
    outside.write_bytes(b"a secret of another file\n")
    path.symlink_to(outside)


@pytest.mark.parametrize("place", [link, os.mkfifo, Path.mkdir])
@pytest.mark.parametrize(
    ("write", "read"),
    [
        (write_plan, lambda root: read_plan(root, ID)),
        (lambda root: write_run(root) / "run.json", lambda root: read_run(root, RUN)),
        (write_requests, lambda root: RunFolder(root / "runs").request_file(RUN).load_requests()),
        (
            lambda root: write_evaluation(root) / "job.json",
            lambda root: read_evaluation(root, ID),
        ),
        (write_order, list_one_order),
        (write_notes, read_notes),
        (write_obstacles, ObstacleStore),
        (write_secret, load_or_make_secret),
    ],
    ids=["plan", "run", "requests", "evaluation", "order", "notes", "obstacles", "secret"],
)
def test_only_regular_files_are_read(
    tmp_path: Path,
    write: Callable[[Path], Path],
    read: Callable[[Path], object],
    place: Callable[[Path], object],
    caplog: pytest.LogCaptureFixture,
) -> None:
    path = write(tmp_path)
    read(tmp_path)
    if place is not link:
        path.unlink()
    place(path)
    with pytest.raises((Unavailable, NotFound)) as refused:
        read(tmp_path)
    said = f"{refused.value} {caplog.text}"
    assert path.name in said or path.stem in said
    assert "secret of" not in said
    assert "pydantic" not in said


@pytest.mark.parametrize("name", ["evaluation.json", "rows.log", "parts/part.parquet", "parts"])
@pytest.mark.parametrize("is_link", [True, False])
def test_an_evaluation_with_links_or_pipes_is_refused(
    tmp_path: Path, name: str, is_link: bool
) -> None:
    path = write_evaluation(tmp_path) / name
    path.parent.mkdir(exist_ok=True)
    if is_link:
        path.symlink_to(tmp_path)
    else:
        os.mkfifo(path)
    with pytest.raises(Unavailable, match=f"{name} is a link, or not a regular file: move it"):
        read_evaluation(tmp_path, ID)


@pytest.mark.parametrize("name", ["bin", "drafts", "evaluations", "notes", "orders", "runs"])
@pytest.mark.parametrize("is_link", [True, False])
def test_the_folders_of_a_service_are_no_links_and_no_files(
    tmp_path: Path, name: str, is_link: bool
) -> None:
    root = tmp_path / "missions"
    root.mkdir()
    if is_link:
        (root / name).symlink_to(tmp_path)
    else:
        (root / name).touch()
    with pytest.raises(Unavailable, match=rf"missions/{name} is not a folder, or a link"):
        open_plans(root)


def test_a_stored_thing_of_another_shape_is_named_without_raw_text(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write_order(tmp_path)
    path.write_bytes(b'{"id": 3}')
    assert list_orders(tmp_path) == []
    (line,) = caplog.messages
    assert f"{path} is damaged: its `id` is not of this version of Argo; delete it" in line
    assert "pydantic" not in line


def test_lost_journals_of_a_run_are_told(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path / "runs")
    path = write_run(tmp_path, entries=12)
    with pytest.raises(Unavailable, match="have 0 of 12 entries: restore the missing journal"):
        folder.load_entries(RUN)
    (path / "run-0002.journal").touch()
    with pytest.raises(Unavailable, match=r"run-0001\.journal is missing: restore it"):
        folder.load_entries(RUN)
    (path / "run-0001.journal").symlink_to(path / "run-0002.journal")
    with pytest.raises(Unavailable, match=r"run-0001\.journal is a link"):
        folder.load_entries(RUN)


def test_a_run_without_entries_has_an_empty_log(tmp_path: Path) -> None:
    write_run(tmp_path)
    assert RunFolder(tmp_path / "runs").load_entries(RUN) == ()


@pytest.mark.anyio
async def test_a_restarted_service_tells_of_the_lost_journals_of_its_last_run(
    tmp_path: Path,
) -> None:
    write_run(tmp_path, entries=12)
    async with open_host(tmp_path / "runs") as host:
        assert host.state is not None
        assert "have 0 of 12 entries" in (host.state.problem or "")
        with pytest.raises(Unavailable, match="have 0 of 12 entries"):
            await host.list_entries(RUN, 0, 100)


def full(*_: object, **__: object) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize(
    ("module", "write"),
    [
        ("runs.folder", write_run),
        ("evaluations.evaluations", write_evaluation),
        ("jobs.order_searches", write_order),
        ("storage.import_notes", write_notes),
    ],
)
def test_nothing_is_left_of_what_a_full_disk_refuses(
    tmp_path: Path,
    module: str,
    write: Callable[[Path], Path],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(f"argo_planner.service.{module}.write_atomically", full)
    with suppress(Unavailable):  # notes are left out
        write(tmp_path)
    assert os.listdir(tmp_path) == []


def test_nothing_is_left_of_obstacles_that_a_full_disk_refuses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = ObstacleStore(tmp_path)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(Unavailable, match="No space left on device"):
        store.replace((), None)
    assert os.listdir(tmp_path) == []
