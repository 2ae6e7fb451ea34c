"""Searches for the best order as jobs: watched, accepted as one command, cancelled."""

import errno
import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from argo_compiler.il import Mission
from argo_env.planning.opening import OpenedSite
from argo_planner.service.jobs import order_searches, retried_storage
from argo_planner.use_cases.importing import ImportedMission
from argo_planner.use_cases.routing import suggest_order
from tests.argo_planner.service.served import Served, require_private, served
from tests.argo_planner.service.test_http import new_resource, problem

SCRIPT = (
    "Mission Protocol #2\nOrder: any\n"
    "1. Set the starting point in starting area 1.\n"
    "2. Check valve R18.\n3. Check pressure gauge 5.\n4. Check valve R25.\n5. Check valve R12.\n"
    "6. Return to the docking station in starting area 1.\n"
)


def import_script(service: Served) -> str:
    return service.imported(SCRIPT, start_area=1)


def start_search(service: Served, id: str, time_limit: float = 5) -> str:
    answer = service.client.post(f"/api/missions/{id}/orders", json={"time_limit": time_limit})
    return new_resource(answer, 202, "/api/jobs")["id"]


def wait_until(service: Served, job: str, condition: Callable[[dict], bool]) -> dict:
    while True:
        read = service.client.get(f"/api/jobs/{job}").json()
        if condition(read):
            return read
        assert read["state"] == "running", read
        time.sleep(0.05)


def wait_for_end(service: Served, job: str) -> dict:
    return wait_until(service, job, lambda read: read["state"] != "running")


def test_an_order_is_found_watched_accepted_and_undone(service: Served, site: OpenedSite) -> None:
    id = import_script(service)
    before = service.mission(id)
    page = service.follow(id)
    job = start_search(service, id)
    states = []
    while "done" not in states:
        message = json.loads(page.recv(timeout=60))
        if message["kind"] == "job":
            states.append(message["job"]["state"])
            assert message["job"]["id"] == job
    done = wait_for_end(service, job)
    found = done["found"]
    same = suggest_order(
        ImportedMission(Mission.model_validate(before), "m", (), ()), site, time_limit=5
    )
    assert found["reordering"] == same.reordering.model_dump(mode="json")
    assert found["reordering"]["proven"]
    last = done["progress"][-1]
    assert last["bound"] <= last["best"] + 1e-6
    at = f"/api/jobs/{job}/accept"
    problem(service.post(at, id="o"), 428, "revision-missing")
    accepted = service.post(at, 1, id="o")
    assert accepted.json()["revision"]["about"] == "a suggested order"
    again = service.post(at, 1, id="o")
    assert again.json()["revision"] == accepted.json()["revision"]
    assert service.mission(id) == same.mission.model_dump(mode="json")
    service.command(id, 2, kind="undo")
    assert service.mission(id) == before


@pytest.mark.long
def test_a_found_order_is_accepted_after_a_restart(tmp_path: Path, site: OpenedSite) -> None:
    with served(tmp_path, site) as first:
        id = import_script(first)
        job = start_search(first, id)
        found = wait_for_end(first, job)
        assert found["found"]["mission"]
        require_private(tmp_path / "orders")
        for file in (tmp_path / "orders").iterdir():
            (tmp_path / "orders" / "0123456789ab.json").write_bytes(file.read_bytes()[:100])
    with served(tmp_path, site) as second:
        assert second.client.get(f"/api/jobs/{job}").json() == found
        assert second.post(f"/api/jobs/{job}/accept", 1, id="o").status_code == 200
        assert second.mission(id) == found["found"]["mission"]
        second.client.delete(f"/api/missions/{id}")
        second.client.delete(f"/api/bin/{id}")
        assert [f.name for f in (tmp_path / "orders").iterdir()] == ["0123456789ab.json"]


@pytest.mark.long
def test_a_damaged_order_is_left_out(
    tmp_path: Path, site: OpenedSite, caplog: pytest.LogCaptureFixture
) -> None:
    with served(tmp_path, site) as service:
        wait_for_end(service, start_search(service, import_script(service)))
    (file,) = (tmp_path / "orders").iterdir()
    file.write_bytes(file.read_bytes().replace(b"ann", b"bob", 1))
    with served(tmp_path, site) as service:
        assert service.client.get("/api/jobs").json()["jobs"] == []
    assert f"{file} is damaged: its content does not fit its checksum" in caplog.text


@pytest.mark.long
def test_an_order_that_can_not_be_stored_says_so_and_is_stored_when_there_is_room(
    tmp_path: Path, site: OpenedSite, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk_is_full = True
    write = order_searches.write_atomically

    def write_if_possible(*arguments: Any, **options: Any) -> None:
        if disk_is_full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(*arguments, **options)

    monkeypatch.setattr(order_searches, "write_atomically", write_if_possible)
    monkeypatch.setattr(retried_storage, "STORING_PERIOD", 0.05)
    with served(tmp_path, site) as service:
        job = start_search(service, import_script(service))
        found = wait_for_end(service, job)
        assert found["state"] == "done"
        assert "can't be stored" in found["problem"]
        assert "No space left on device" in found["problem"]
        assert not (tmp_path / "orders").exists()
        disk_is_full = False
        while service.client.get(f"/api/jobs/{job}").json()["problem"] is not None:
            time.sleep(0.05)
    with served(tmp_path, site) as service:
        assert service.client.get(f"/api/jobs/{job}").json() == found | {
            "problem": None,
            "problem_wording": None,
        }


def test_an_order_of_an_earlier_revision_is_not_accepted(service: Served) -> None:
    id = import_script(service)
    job = start_search(service, id)
    wait_for_end(service, job)
    early = service.post(f"/api/jobs/{job}/accept", 5, id="o")
    assert "made on revision 5" in problem(early, 412, "stale-revision")["detail"]
    edit = {"kind": "set_header", "designation": "other"}
    assert service.command(id, 1, edit).status_code == 200
    for made_on in (1, 2, "*"):
        stale = service.post(f"/api/jobs/{job}/accept", made_on, id="o")
        error = problem(stale, 412, "stale-revision")
        assert error["newest"] == 2
        assert [revision["number"] for revision in error["since"]] == [2]


def test_a_search_is_cancelled(service: Served) -> None:
    id = import_script(service)
    jobs = [start_search(service, id, 600), start_search(service, id, 600)]
    problem(service.client.post(f"/api/missions/{id}/orders", json={}), 409, "conflict")
    for job in jobs:
        cancelled = service.client.delete(f"/api/jobs/{job}")
        if cancelled.status_code == 200:
            assert cancelled.json()["state"] == "cancelled"
        problem(service.client.delete(f"/api/jobs/{job}"), 409, "conflict")
        assert service.client.get(f"/api/jobs/{job}").json()["state"] in ("cancelled", "done")
    assert wait_for_end(service, start_search(service, id))["state"] == "done"


def test_a_mission_that_can_not_be_ordered_gets_a_reason(service: Served) -> None:
    empty = service.create()
    problem(service.client.post(f"/api/missions/{empty}/orders", json={}), 422, "invalid")
    id = import_script(service)
    requirements = {"requirements": {"before": [["MEASURE 14", "nobody"]]}}
    refused = service.client.post(f"/api/missions/{id}/orders", json=requirements)
    assert "nobody" in problem(refused, 422, "invalid")["detail"]
    problem(service.client.get("/api/jobs/000000000000"), 404, "not-found")
