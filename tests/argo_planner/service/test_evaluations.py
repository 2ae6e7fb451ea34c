"""Evaluations over HTTP: started, watched, cancelled, resumed, replayed and reported."""

import asyncio
import json
import os
import re
import time
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from argo_compiler.base.errors import Conflict
from argo_compiler.il import Mission
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.store import read_rows
from argo_env.faults.robot import LowBattery
from argo_env.planning.opening import OpenedSite
from argo_planner.service.evaluations.evaluations import (
    EvaluationFolder,
    Evaluations,
    StoredEvaluation,
)
from argo_planner.service.jobs import retried_storage
from argo_planner.service.jobs.evaluation import EvaluationAsked, EvaluationSpec
from argo_planner.service.jobs.job import EvaluationJob
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.web.access import AccessRole
from argo_planner.use_cases.importing import Upload, import_mission
from tests.argo_planner.service.served import SECRETS, Served, require_private, served, wait_or_fail
from tests.argo_planner.service.test_http import new_resource, problem
from tests.argo_planner.service.test_jobs import SCRIPT, import_script, wait_for_end, wait_until
from tests.disks import fill, small_disk

FAULTS = [{"kind": "low_battery", "charge": 0.01}]
OFF_SITE = {"kind": "brick", "floor": 1, "place": [-3.0, 0.0]}


@pytest.fixture(scope="module")
def id(service: Served) -> str:
    return import_script(service)


def request_evaluation(service: Served, id: str, revision: int | str = "*", **request: object):
    return service.post(f"/api/missions/{id}/evaluations", revision, **request)


def start_evaluation(service: Served, id: str, **request: object) -> str:
    return new_resource(request_evaluation(service, id, **request), 202, "/api/jobs")["id"]


@pytest.mark.long
def test_an_evaluation_is_watched_agrees_with_the_library_and_its_runs_are_replayed(
    service: Served, id: str, site: OpenedSite
) -> None:
    messages = []
    with service.follow(id) as page:
        job = start_evaluation(service, id, worlds=12, faults=FAULTS, require=["success >= 0.9"])
        while not messages or messages[-1]["state"] == "running":
            message = json.loads(page.recv(timeout=600))
            if message["kind"] == "job":
                assert message["job"]["id"] == job
                messages.append(message["job"])
    done = wait_for_end(service, job)
    assert done["state"] == "done", done["problem"]
    assert messages[-1] == done
    standing = done["standing"]
    same = Evaluation(
        {"Protocol #2": Mission.model_validate(service.mission(id))},
        site,
        faults={"none": (), "low_battery": (LowBattery(charge=0.01),)},
        seeds=range(12),
        require=["success >= 0.9"],
    ).run(workers=2)
    (plan,) = same.plan.plans
    rate = same.rate(plan)
    assert standing["done"] == standing["most"] == len(same.rows)
    assert standing["rate"]["runs"] == rate.runs
    assert standing["rate"]["value"] == pytest.approx(rate.value)
    assert standing["rate"]["low"] == pytest.approx(rate.low)
    assert standing["rate"]["method"] == rate.method.value
    by_faults = {group["name"]: group["rate"]["value"] for group in standing["by_faults"]}
    assert by_faults == {"none": 1.0, "low_battery": 0.0}
    assert [one["requirement"] for one in standing["requirements"]] == ["success >= 0.9"]
    failing = [row for row in same.rows if not row.success]
    assert sorted((one["seed"], one["reason"]) for one in standing["failing"]) == sorted(
        (row.seed, row.reason) for row in failing
    )
    failed = standing["failing"][0]
    replay = service.client.get(f"/api/jobs/{job}/runs/{failed['key']}").json()
    state, entries = replay["state"], replay["entries"]
    assert (state["id"], state["plan"], state["seed"]) == (failed["key"], id, failed["seed"])
    assert state["headline"]["word"] == "No success"
    assert state["entries"] == len(entries)
    assert entries[-1]["ended"]
    assert entries[-1]["t"] == pytest.approx(failed["duration"], abs=0.1)
    report = service.client.get(f"/api/jobs/{job}/report")
    assert report.headers["content-type"].startswith("text/html")
    assert "default-src 'none'" in report.headers["content-security-policy"]
    assert failed["key"] in report.text
    summary = service.client.get("/api/jobs").json()["jobs"][0]
    assert (summary["id"], summary["standing"]) == (job, None)


@pytest.mark.long
def test_only_one_evaluation_runs_and_a_cancelled_one_is_resumed(service: Served, id: str) -> None:
    job = start_evaluation(service, id, worlds=10_000)
    wait_until(service, job, lambda read: read["standing"] is not None)
    error = problem(request_evaluation(service, id, worlds=1), 409, "conflict")
    assert "ann has started an evaluation of mission 'm'" in error["detail"]
    problem(service.client.delete(f"/api/evaluations/{job}"), 409, "conflict")
    cancelled = service.client.delete(f"/api/jobs/{job}").json()
    assert cancelled["state"] == "cancelled"
    before = cancelled["standing"]["done"]
    assert cancelled["standing"]["most"] == cancelled["standing"]["planned"] == 10_000
    with service.follow(id) as page:
        assert service.client.get(f"/api/jobs/{job}/report").status_code == 200
        resumed = service.client.post(f"/api/jobs/{job}/go_on")
        assert resumed.status_code == 202, resumed.text
        problem(service.client.get(f"/api/jobs/{job}/report"), 404, "not-found")
        problem(service.client.post(f"/api/jobs/{job}/go_on"), 409, "conflict")
        # Stored runs are counted before the first report.
        while True:
            message = json.loads(page.recv(timeout=600))
            if message["kind"] != "job":
                continue
            assert message["job"]["standing"]["done"] >= before
            if message["job"]["standing"]["done"] > before:
                break
    assert service.client.delete(f"/api/jobs/{job}").status_code == 200


@pytest.mark.long
def test_a_cancelled_evaluation_has_a_valid_interval_and_a_report(service: Served, id: str) -> None:
    job = start_evaluation(service, id, worlds=10_000, faults=FAULTS)
    wait_until(service, job, lambda read: (read["standing"] or {}).get("done", 0) > 8)
    standing = service.client.delete(f"/api/jobs/{job}").json()["standing"]
    assert standing["rate"]["method"] == "confidence sequence"
    assert {one["rate"]["method"] for one in standing["by_faults"]} == {"confidence sequence"}
    assert sum(standing["outcomes"].values()) == standing["done"] >= standing["rate"]["runs"]
    assert standing["rate"]["runs"] % 2 == 0, "only complete worlds count"
    report = service.client.get(f"/api/jobs/{job}/report")
    assert report.status_code == 200
    assert "The evaluation was ended early" in report.text
    assert service.client.delete(f"/api/evaluations/{job}").status_code == 204
    problem(service.client.get(f"/api/jobs/{job}"), 404, "not-found")
    assert job not in {one["id"] for one in service.client.get("/api/jobs").json()["jobs"]}


@pytest.mark.long
def test_the_evaluation_of_a_mission_that_is_deleted_ends(service: Served) -> None:
    id = import_script(service)
    job = start_evaluation(service, id, worlds=10_000)
    wait_until(service, job, lambda read: read["standing"] is not None)
    assert service.client.delete(f"/api/missions/{id}").status_code == 204
    assert service.client.get(f"/api/jobs/{job}").json()["state"] == "cancelled"
    assert service.client.delete(f"/api/bin/{id}").status_code == 204
    problem(service.client.get(f"/api/jobs/{job}"), 404, "not-found")


@pytest.mark.long
def test_an_evaluation_that_is_resumed_while_its_end_is_stored_is_running(
    service: Served, id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    original, is_reading, may_continue = EvaluationFolder.with_stored_results, Event(), Event()

    def with_stored_results(folder: EvaluationFolder, job: EvaluationJob) -> EvaluationJob:
        if not is_reading.is_set():
            is_reading.set()
            assert may_continue.wait(60)
        return original(folder, job)

    monkeypatch.setattr(EvaluationFolder, "with_stored_results", with_stored_results)
    job = start_evaluation(service, id, worlds=10_000)
    wait_until(service, job, lambda read: read["standing"] is not None)
    with ThreadPoolExecutor() as people:
        cancelled = people.submit(service.client.delete, f"/api/jobs/{job}")
        assert is_reading.wait(60)
        resumed = people.submit(service.client.post, f"/api/jobs/{job}/go_on")
        time.sleep(0.2)
        may_continue.set()
        assert resumed.result().status_code == 202
        assert cancelled.result().status_code == 200
    assert service.client.get(f"/api/jobs/{job}").json()["state"] == "running"
    service.client.delete(f"/api/jobs/{job}")


@pytest.mark.long
def test_of_several_simultaneous_starts_only_one_succeeds(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as service:
        id = import_script(service)
        with ThreadPoolExecutor(8) as people:
            answers = [
                *people.map(lambda _: request_evaluation(service, id, worlds=10_000), range(8))
            ]
        assert sorted(one.status_code for one in answers) == [202, *[409] * 7]
        (started,) = [one.json()["id"] for one in answers if one.status_code == 202]
        assert os.listdir(tmp_path / "evaluations") == [started]
    with served(tmp_path, site) as service:
        (job,) = service.client.get("/api/jobs").json()["jobs"]
        assert (job["id"], job["state"]) == (started, "interrupted")


def test_an_evaluation_whose_client_leaves_is_stored_and_runs_or_neither(
    tmp_path: Path, site: OpenedSite, monkeypatch: pytest.MonkeyPatch
) -> None:
    original, is_storing, may_store = EvaluationFolder.store, Event(), Event()

    def store(folder: EvaluationFolder, evaluation: StoredEvaluation) -> None:
        is_storing.set()
        assert may_store.wait(60)
        original(folder, evaluation)

    monkeypatch.setattr(EvaluationFolder, "store", store)

    async def leave() -> None:
        jobs = Jobs(lambda _: None)
        started = Evaluations(tmp_path, jobs, lambda: "0" * 12, lambda: datetime.now(UTC))
        mission = import_mission(Upload("m.txt", SCRIPT.encode()), site, 1, None).mission
        spec = EvaluationSpec(
            name="m", mission=mission, site=site.reference, asked=EvaluationAsked(worlds=1)
        )
        client = asyncio.create_task(started.start("0" * 12, 1, spec, "ann"))
        await asyncio.to_thread(is_storing.wait)
        client.cancel()
        may_store.set()
        with pytest.raises(asyncio.CancelledError):
            await client
        with pytest.raises(Conflict, match="ann has started an evaluation"):
            await started.start("0" * 12, 1, spec, "bob")
        assert os.listdir(tmp_path) == ["0" * 12]
        assert [job.id for job in jobs.all()] == ["0" * 12]
        await jobs.kill_running()

    asyncio.run(leave())


@pytest.mark.small_disk
@pytest.mark.long
def test_an_evaluation_on_a_full_disk(site: OpenedSite, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is refused with nothing left; the end of one that runs is stored when there is room."""
    monkeypatch.setattr(retried_storage, "STORING_PERIOD", 0.1)
    with small_disk(400 * 4096) as disk, served(disk / "missions", site) as service:
        stored = disk / "missions" / "evaluations"
        id = import_script(service)
        filler = fill(disk)
        answer = problem(request_evaluation(service, id, worlds=1), 503, "unavailable")
        assert re.search(
            r"evaluation \w+ can't be stored: .*No space left on device; free disk space, and try",
            answer["detail"],
        )
        assert not (stored.exists() and os.listdir(stored))
        assert service.client.get("/api/jobs").json()["jobs"] == []
        filler.unlink()
        job = start_evaluation(service, id, worlds=10_000)
        filler = fill(disk)
        ended = wait_for_end(service, job)
        assert ended["state"] == "interrupted"
        assert "No space left on device" in ended["problem"]
        path = stored / job / "job.json"
        assert json.loads(path.read_bytes())["job"]["state"] == "running"
        filler.unlink()
        wait_or_fail(lambda: json.loads(path.read_bytes())["job"]["state"] != "running")
        assert "No space left on device" in json.loads(path.read_bytes())["job"]["problem"]
        assert service.client.post(f"/api/jobs/{job}/go_on").status_code == 202
        service.client.delete(f"/api/jobs/{job}")


@pytest.mark.long
def test_damaged_files_of_evaluations_are_named_and_all_are_private(
    tmp_path: Path, site: OpenedSite, caplog: pytest.LogCaptureFixture
) -> None:
    with served(tmp_path, site) as service:
        id = import_script(service)
        job = start_evaluation(service, id, worlds=2)
        assert wait_for_end(service, job)["state"] == "done"
        folder = tmp_path / "evaluations" / job
        wait_or_fail(lambda: "report.html" in os.listdir(folder))
        wait_or_fail(lambda: not any(folder.glob(".argo-*.tmp")))  # its draft
        require_private(tmp_path / "evaluations")
        for name, path in (
            ("report.html", f"/api/jobs/{job}/report"),
            ("evaluation.json", f"/api/jobs/{job}/runs/{'0' * 24}"),
            ("job.json", f"/api/jobs/{job}/runs/{'0' * 24}"),
        ):
            content = (folder / name).read_bytes()
            (folder / name).write_bytes(content.replace(b"mission", b"massion", 1))
            detail = problem(service.client.get(path), 503, "unavailable")["detail"]
            assert re.search(rf"evaluations/{job}/{name} is damaged: its content", detail)
            if name != "job.json":
                (folder / name).write_bytes(content)
    (folder / "job.json").write_bytes((folder / "job.json").read_bytes()[:-300])
    with served(tmp_path, site) as service:
        assert service.client.get("/api/jobs").json()["jobs"] == []
    assert re.search(r"job\.json is damaged: line 1, column \d+: .*is left out", caplog.text)


@pytest.mark.long
def test_evaluations_outlive_the_service(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as first:
        id = import_script(first)
        done = start_evaluation(first, id, worlds=3)
        assert wait_for_end(first, done)["state"] == "done"
        ended_early = start_evaluation(first, id, worlds=60)
        known = wait_until(first, ended_early, lambda read: read["standing"] is not None)[
            "standing"
        ]
    with served(tmp_path, site) as second:
        states = {job["id"]: job["state"] for job in second.client.get("/api/jobs").json()["jobs"]}
        assert states == {done: "done", ended_early: "interrupted"}
        standing = second.client.get(f"/api/jobs/{ended_early}").json()["standing"]
        assert standing["done"] >= known["done"]
        assert standing["rate"]["method"] == "confidence sequence"
        assert second.client.get(f"/api/jobs/{done}").json()["standing"]["done"] == 3
        assert second.client.get(f"/api/jobs/{done}/report").status_code == 200
        assert second.client.post(f"/api/jobs/{ended_early}/go_on").status_code == 202
        complete = wait_for_end(second, ended_early)
        assert (complete["state"], complete["standing"]["done"]) == ("done", 60)
        assert len(read_rows(tmp_path / "evaluations" / ended_early)) == 60


@pytest.mark.long
def test_obstacles_are_in_the_worlds(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as service:
        id = import_script(service)
        without = wait_for_end(service, start_evaluation(service, id, worlds=2))
        free = without["standing"]
        start = service.mission(id)["tasks"][0]["pose"]
        crate = {
            "id": "crate",
            "name": "the crate",
            "pose": start | {"x": start["x"] + 2.0},
            "size": [0.5, 6.0, 1.0],
        }
        put = service.put_obstacles(crate)
        assert put.status_code == 200, put.text
        job = wait_for_end(service, start_evaluation(service, id, worlds=2))
        assert job["standing"]["times"] != free["times"] or job["standing"]["failing"]
        assert "the crate" in service.client.get(f"/api/jobs/{job['id']}/report").text
        keys = [
            {row.key for row in read_rows(tmp_path / "evaluations" / one["id"])}
            for one in (without, job)
        ]
        assert len(keys[0]) == len(keys[1]) == 2
        assert not keys[0] & keys[1], "runs with other obstacles must have other keys"


def test_invalid_requests_are_refused_before_anything_runs(service: Served, id: str) -> None:
    for request, reason in (
        ({"require": ["good >= 1"]}, "no quantity `good`"),
        ({"without_faults": False}, "nothing is to be run"),
        ({"worlds": 10_000, "faults": FAULTS * 20}, "too many"),
        ({"drive": "boat"}, "no drive `boat`"),
        ({"drive": "route", "sensor": "camera"}, "choose the sensor `ideal` or another drive"),
        ({"drive": "route", "faults": [{"kind": "brick"}]}, "choose another drive"),
        ({"faults": [*FAULTS, OFF_SITE]}, "faults[1] (brick): there is no walkway"),
        ({"variation": {"speed": [0.9, 0.5]}}, "give the smaller value first"),
        ({"variation": {"values": {"999": {"drift": [0, 1]}}}}, "no checkpoint 999"),
        ({"variation": {"values": {"1": {"start": [1, 1e300]}}}}, "checkpoint 1"),
    ):
        assert (
            reason in problem(request_evaluation(service, id, **request), 422, "invalid")["detail"]
        ), request
    problem(request_evaluation(service, id, revision=77), 412, "stale-revision")
    empty = service.create()
    problem(request_evaluation(service, empty), 422, "invalid")
    viewer = service.as_("eve", SECRETS[AccessRole.VIEW])
    refused = viewer.post(f"/api/missions/{id}/evaluations", json={}, headers={"if-match": "*"})
    assert refused.status_code == 403


@pytest.mark.parametrize(
    ("asked", "drive"),
    [
        ({}, "route"),
        ({"faults": [{"kind": "low_battery"}]}, "route"),
        ({"faults": [{"kind": "low_battery"}, {"kind": "gas_leak"}]}, "kinematic"),
        ({"sensor": "camera"}, "kinematic"),
        ({"drive": "tracked", "faults": [{"kind": "gas_leak"}]}, "tracked"),
    ],
)
def test_the_drive_that_is_not_given_follows_the_faults(asked: dict[str, Any], drive: str) -> None:
    assert EvaluationAsked.model_validate(asked).used_drive == drive


@pytest.mark.long
def test_a_search_is_not_an_evaluation(service: Served, id: str) -> None:
    order = service.client.post(f"/api/missions/{id}/orders", json={"time_limit": 1}).json()["id"]
    for answer in (
        service.client.post(f"/api/jobs/{order}/go_on"),
        service.client.get(f"/api/jobs/{order}/report"),
        service.client.get(f"/api/jobs/{order}/runs/{'0' * 24}"),
    ):
        assert "is not an evaluation" in problem(answer, 404, "not-found")["detail"]
    evaluation = start_evaluation(service, id, worlds=1)
    assert wait_for_end(service, evaluation)["state"] == "done"
    refused = service.client.get(f"/api/jobs/{evaluation}/preview")
    assert "is not a search" in problem(refused, 404, "not-found")["detail"]
    unknown = service.client.get(f"/api/jobs/{evaluation}/runs/{'0' * 24}")
    assert "has no run" in problem(unknown, 404, "not-found")["detail"]
