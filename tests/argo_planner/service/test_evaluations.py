"""Evaluations over HTTP: begun, watched, cancelled, gone on with, replayed, reported."""

import json
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event

import pytest

from argo_compiler.il import Mission
from argo_env.evaluation.evaluation import Evaluation
from argo_env.evaluation.store import read_rows
from argo_env.faults.robot import LowBattery
from argo_env.planning.opening import OpenedSite
from argo_planner.service.evaluations.evaluations import EvaluationFolder
from argo_planner.service.jobs.job import EvaluationJob
from argo_planner.service.web.access import AccessRole
from tests.argo_planner.service.served import SECRETS, Served, served
from tests.argo_planner.service.test_http import begun, problem
from tests.argo_planner.service.test_jobs import imported, over, until

FAULTS = [{"kind": "low_battery", "charge": 0.01}]


@pytest.fixture(scope="module")
def id(service: Served) -> str:
    return imported(service)


def asked(service: Served, id: str, revision: int | str = "*", **said: object):
    return service.post(f"/api/missions/{id}/evaluations", revision, **said)


def begin(service: Served, id: str, **said: object) -> str:
    return begun(asked(service, id, **said), 202, "/api/jobs")["id"]


@pytest.mark.long
def test_it_is_watched_says_what_the_library_says_and_its_runs_are_replayed(
    service: Served, id: str, site: OpenedSite
) -> None:
    heard = []
    with service.follow(id) as page:
        job = begin(service, id, worlds=12, faults=FAULTS, require=["success >= 0.9"])
        while not heard or heard[-1]["state"] == "running":
            message = json.loads(page.recv(timeout=600))
            if message["kind"] == "job":
                assert message["job"]["id"] == job
                heard.append(message["job"])
    done = over(service, job)
    assert done["state"] == "done", done["problem"]
    assert heard[-1] == done
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
    one = standing["failing"][0]
    replay = service.client.get(f"/api/jobs/{job}/runs/{one['key']}").json()
    state, entries = replay["state"], replay["entries"]
    assert (state["id"], state["plan"], state["seed"]) == (one["key"], id, one["seed"])
    assert state["headline"]["word"] == "No success"
    assert state["entries"] == len(entries)
    assert entries[-1]["ended"]
    assert entries[-1]["t"] == pytest.approx(one["duration"], abs=0.1)
    report = service.client.get(f"/api/jobs/{job}/report")
    assert report.headers["content-type"].startswith("text/html")
    assert "default-src 'none'" in report.headers["content-security-policy"]
    assert one["key"] in report.text
    summary = service.client.get("/api/jobs").json()["jobs"][0]
    assert (summary["id"], summary["standing"]) == (job, None)


@pytest.mark.long
def test_one_at_a_time_and_what_was_cancelled_goes_on(service: Served, id: str) -> None:
    job = begin(service, id, worlds=10_000)
    until(service, job, lambda read: read["standing"] is not None)
    told = problem(asked(service, id, worlds=1), 409, "conflict")
    assert "mission 'm' is being evaluated, begun by ann" in told["detail"]
    problem(service.client.delete(f"/api/evaluations/{job}"), 409, "conflict")
    cancelled = service.client.delete(f"/api/jobs/{job}").json()
    assert cancelled["state"] == "cancelled"
    before = cancelled["standing"]["done"]
    assert cancelled["standing"]["most"] == cancelled["standing"]["planned"] == 10_000
    with service.follow(id) as page:
        assert service.client.get(f"/api/jobs/{job}/report").status_code == 200
        gone_on = service.client.post(f"/api/jobs/{job}/go_on")
        assert gone_on.status_code == 202, gone_on.text
        problem(service.client.get(f"/api/jobs/{job}/report"), 404, "not-found")
        problem(service.client.post(f"/api/jobs/{job}/go_on"), 409, "conflict")
        # What was known is counted before anything is told.
        while True:
            message = json.loads(page.recv(timeout=600))
            if message["kind"] != "job":
                continue
            assert message["job"]["standing"]["done"] >= before
            if message["job"]["standing"]["done"] > before:
                break
    assert service.client.delete(f"/api/jobs/{job}").status_code == 200


@pytest.mark.long
def test_what_was_ended_by_hand_is_told_so_that_it_holds_and_has_a_report(
    service: Served, id: str
) -> None:
    job = begin(service, id, worlds=10_000, faults=FAULTS)
    until(service, job, lambda read: (read["standing"] or {}).get("done", 0) > 8)
    standing = service.client.delete(f"/api/jobs/{job}").json()["standing"]
    assert standing["rate"]["method"] == "confidence sequence"
    assert {one["rate"]["method"] for one in standing["by_faults"]} == {"confidence sequence"}
    assert sum(standing["outcomes"].values()) == standing["done"] >= standing["rate"]["runs"]
    assert standing["rate"]["runs"] % 2 == 0, "of whole worlds"
    report = service.client.get(f"/api/jobs/{job}/report")
    assert report.status_code == 200
    assert "The evaluation was ended early" in report.text
    assert service.client.delete(f"/api/evaluations/{job}").status_code == 204
    problem(service.client.get(f"/api/jobs/{job}"), 404, "not-found")
    assert job not in {one["id"] for one in service.client.get("/api/jobs").json()["jobs"]}


@pytest.mark.long
def test_the_evaluation_of_a_mission_that_is_deleted_ends(service: Served) -> None:
    id = imported(service)
    job = begin(service, id, worlds=10_000)
    until(service, job, lambda read: read["standing"] is not None)
    assert service.client.delete(f"/api/missions/{id}").status_code == 204
    assert service.client.get(f"/api/jobs/{job}").json()["state"] == "cancelled"
    assert service.client.delete(f"/api/bin/{id}").status_code == 204
    problem(service.client.get(f"/api/jobs/{job}"), 404, "not-found")


@pytest.mark.long
def test_one_that_goes_on_while_its_end_is_kept_is_under_way(
    service: Served, id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    as_before, reads, go_on = EvaluationFolder.cut_short, Event(), Event()

    def cut_short(folder: EvaluationFolder, job: EvaluationJob) -> EvaluationJob:
        if not reads.is_set():
            reads.set()
            assert go_on.wait(60)
        return as_before(folder, job)

    monkeypatch.setattr(EvaluationFolder, "cut_short", cut_short)
    job = begin(service, id, worlds=10_000)
    until(service, job, lambda read: read["standing"] is not None)
    with ThreadPoolExecutor() as people:
        cancelled = people.submit(service.client.delete, f"/api/jobs/{job}")
        assert reads.wait(60)
        gone_on = people.submit(service.client.post, f"/api/jobs/{job}/go_on")
        time.sleep(0.2)
        go_on.set()
        assert gone_on.result().status_code == 202
        assert cancelled.result().status_code == 200
    assert service.client.get(f"/api/jobs/{job}").json()["state"] == "running"
    service.client.delete(f"/api/jobs/{job}")


@pytest.mark.long
def test_of_several_that_begin_at_once_only_one_does(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as service:
        id = imported(service)
        with ThreadPoolExecutor(8) as people:
            answers = [*people.map(lambda _: asked(service, id, worlds=10_000), range(8))]
        assert sorted(one.status_code for one in answers) == [202, *[409] * 7]
        assert len(list((tmp_path / "evaluations").iterdir())) == 1


@pytest.mark.long
def test_it_outlives_the_service(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as first:
        id = imported(first)
        done = begin(first, id, worlds=3)
        assert over(first, done)["state"] == "done"
        cut_short = begin(first, id, worlds=150)
        known = until(first, cut_short, lambda read: read["standing"] is not None)["standing"]
    with served(tmp_path, site) as second:
        states = {job["id"]: job["state"] for job in second.client.get("/api/jobs").json()["jobs"]}
        assert states == {done: "done", cut_short: "interrupted"}
        standing = second.client.get(f"/api/jobs/{cut_short}").json()["standing"]
        assert standing["done"] >= known["done"]
        assert standing["rate"]["method"] == "confidence sequence"
        assert second.client.get(f"/api/jobs/{done}").json()["standing"]["done"] == 3
        assert second.client.get(f"/api/jobs/{done}/report").status_code == 200
        assert second.client.post(f"/api/jobs/{cut_short}/go_on").status_code == 202
        whole = over(second, cut_short)
        assert (whole["state"], whole["standing"]["done"]) == ("done", 150)
        assert len(read_rows(tmp_path / "evaluations" / cut_short)) == 150


@pytest.mark.long
def test_obstacles_stand_in_the_worlds(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as service:
        id = imported(service)
        before = over(service, begin(service, id, worlds=2))
        free = before["standing"]
        start = service.mission(id)["tasks"][0]["pose"]
        crate = {
            "id": "crate",
            "name": "the crate",
            "pose": start | {"x": start["x"] + 2.0},
            "size": [0.5, 6.0, 1.0],
        }
        put = service.put_obstacles(crate)
        assert put.status_code == 200, put.text
        job = over(service, begin(service, id, worlds=2))
        assert job["standing"]["times"] != free["times"] or job["standing"]["failing"]
        assert "the crate" in service.client.get(f"/api/jobs/{job['id']}/report").text
        keys = [
            {row.key for row in read_rows(tmp_path / "evaluations" / one["id"])}
            for one in (before, job)
        ]
        assert len(keys[0]) == len(keys[1]) == 2
        assert not keys[0] & keys[1], "runs among other obstacles are other runs"


def test_what_makes_no_sense_is_refused_before_anything_runs(service: Served, id: str) -> None:
    for said, why in (
        ({"require": ["good >= 1"]}, "no quantity `good`"),
        ({"without_faults": False}, "nothing is to be run"),
        ({"worlds": 10_000, "faults": FAULTS * 20}, "too many"),
        ({"drive": "boat"}, "no drive `boat`"),
        ({"sensor": "camera"}, "choose the sensor `ideal` or another drive"),
        ({"faults": [{"kind": "brick"}]}, "choose another drive"),
        ({"variation": {"speed": [0.9, 0.5]}}, "give the smaller value first"),
        ({"variation": {"values": {"999": {"drift": [0, 1]}}}}, "no checkpoint 999"),
        ({"variation": {"values": {"1": {"start": [1, 1e300]}}}}, "checkpoint 1"),
    ):
        assert why in problem(asked(service, id, **said), 422, "invalid")["detail"], said
    problem(asked(service, id, revision=77), 412, "stale-revision")
    empty = service.create()
    problem(asked(service, empty), 422, "invalid")
    viewer = service.as_("eve", SECRETS[AccessRole.VIEW])
    refused = viewer.post(f"/api/missions/{id}/evaluations", json={}, headers={"if-match": "*"})
    assert refused.status_code == 403


@pytest.mark.long
def test_searches_are_no_evaluations(service: Served, id: str) -> None:
    order = service.client.post(f"/api/missions/{id}/orders", json={"time_limit": 1}).json()["id"]
    for answer in (
        service.client.post(f"/api/jobs/{order}/go_on"),
        service.client.get(f"/api/jobs/{order}/report"),
        service.client.get(f"/api/jobs/{order}/runs/{'0' * 24}"),
    ):
        assert "is no evaluation" in problem(answer, 404, "not-found")["detail"]
    evaluation = begin(service, id, worlds=1)
    assert over(service, evaluation)["state"] == "done"
    refused = service.client.get(f"/api/jobs/{evaluation}/preview")
    assert "is no search" in problem(refused, 404, "not-found")["detail"]
    unknown = service.client.get(f"/api/jobs/{evaluation}/runs/{'0' * 24}")
    assert "has no run" in problem(unknown, 404, "not-found")["detail"]
