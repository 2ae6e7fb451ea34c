"""Runs over HTTP and WebSockets, from their beginning to their report."""

import json
import time

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from tests.argo_planner.service.served import ALL, SECRETS, Served
from tests.argo_planner.service.test_http import begun, problem
from tests.argo_planner.service.test_run_host import SCRIPT


@pytest.fixture(scope="module")
def id(service: Served) -> str:
    return service.imported(SCRIPT, start_area=1)


def start(service: Served, id: str, **other: object) -> dict:
    return begun(service.run(id, 1, **({"drive": "route", "seed": 4} | other)), 201, "/api/runs")


def state(service: Served, run: str) -> dict:
    return service.client.get(f"/api/runs/{run}").json()


def wait(service: Served, run: str, **wanted: object) -> dict:
    while True:
        found = state(service, run)
        if all(found[name] == value for name, value in wanted.items()):
            return found
        assert found["status"] != "interrupted", found
        time.sleep(0.05)


def ask(service: Served, run: str, kind: str, **fields: object) -> dict:
    """Asks for something and waits for how it ends."""
    request = {"kind": kind, "id": f"{kind}-{time.monotonic_ns()}"} | fields
    return settled(service, service.client.post(f"/api/runs/{run}/requests", json=request))


def settled(service: Served, accepted: httpx.Response) -> dict:
    """Waits for how what was asked for ends."""
    assert accepted.status_code == 202, accepted.text
    while True:
        found = service.client.get(accepted.headers["location"]).json()
        if found["progress"] not in ("accepted", "under way"):
            return found
        time.sleep(0.02)


def test_a_run_is_begun_followed_steered_and_reported(service: Served, id: str) -> None:
    live = service.socket("/api/robot/live", {"authorization": f"Bearer {ALL}"})
    assert json.loads(live.recv())["kind"] == "state"
    run = start(service, id, speed=20.0)["id"]
    refused = service.run(id, client=service.as_("bob"))
    assert "ann has begun run" in problem(refused, 409, "conflict")["detail"]
    wait(service, run, moving=True)
    assert ask(service, run, "pause")["progress"] == "confirmed"
    paused = state(service, run)
    assert (paused["mode"], paused["moving"]) == ("paused", False)
    assert ask(service, run, "take_over")["progress"] == "confirmed"
    wrong = ask(service, run, "measure", checkpoint="99")
    assert wrong["progress"] == "refused"
    assert "99" in wrong["reason"]
    assert ask(service, run, "give_back")["progress"] == "confirmed"
    assert ask(service, run, "speed", speed=None)["progress"] == "confirmed"
    ended = wait(service, run, status="ended")
    assert ended["headline"]["word"] == "Success"
    kinds = set()
    numbers: list[int] = []
    while len(numbers) < ended["entries"]:
        message = json.loads(live.recv(timeout=30))
        kinds.add(message["kind"])
        if message["kind"] == "entry":
            numbers.append(message["number"])
    assert numbers == [*range(1, ended["entries"] + 1)]
    assert kinds >= {"state", "pose", "entry", "request"}
    late = service.socket(f"/api/robot/live?since={ended['entries'] - 3}", auth())
    heard = [json.loads(late.recv(timeout=30)) for _ in range(4)]
    assert [message.get("number") for message in heard] == [None, *numbers[-3:]]
    entries = service.client.get(f"/api/runs/{run}/entries", params={"since": 2, "most": 3}).json()
    assert entries["count"] == ended["entries"]
    assert len(entries["entries"]) == 3
    while (page := service.client.get(f"/api/runs/{run}/report/report.html")).status_code == 404:
        time.sleep(0.1)
    assert page.headers["content-type"].startswith("text/html")
    assert service.client.get(f"/api/runs/{run}/report/report.json").json()["seed"] == 4
    problem(service.client.get(f"/api/runs/{run}/report/run.journal"), 404, "not-found")
    over = service.client.post(f"/api/runs/{run}/requests", json={"kind": "pause", "id": "late"})
    problem(over, 409, "conflict")
    listed = service.client.get("/api/runs").json()["runs"]
    assert [one["id"] for one in listed].count(run) == 1
    live.close()
    late.close()


def auth() -> dict[str, str]:
    return {"authorization": f"Bearer {ALL}"}


def test_what_there_is_not_is_said_before_anything_begins(service: Served, id: str) -> None:
    before = service.client.get("/api/runs").json()["runs"]
    for wrong, named, known in (
        ({"drive": "flying"}, "`flying`", "kinematic"),
        ({"sensor": "nose"}, "`nose`", "ideal"),
        ({"values": {"99": 1.0, "1": 2.0, "98": 0.0}}, "checkpoint `99`, `98`", " 14,"),
    ):
        detail = problem(service.run(id, **wrong), 422, "invalid")["detail"]
        assert named in detail
        assert known in detail
    assert service.client.get("/api/runs").json()["runs"] == before


def test_why_there_is_no_report_yet_is_said(service: Served, id: str) -> None:
    run = start(service, id, speed=1.0)["id"]
    missing = service.client.get(f"/api/runs/{run}/report/report.html")
    detail = problem(missing, 404, "not-found")["detail"]
    assert "when it has ended" in detail
    assert f"/api/runs/{run}/entries" in detail
    wait(service, run, status="running")
    assert ask(service, run, "stop")["progress"] == "confirmed"
    assert state(service, run)["status"] == "ended", "known before it is confirmed"


@pytest.mark.long
def test_the_run_goes_on_when_nobody_looks(service: Served, id: str) -> None:
    live = service.socket("/api/robot/live", auth())
    run = start(service, id, speed=None)["id"]
    live.close()
    wait(service, run, status="ended")


def test_only_operators_steer(service: Served, id: str) -> None:
    planner = service.as_("x", SECRETS["plan"])
    problem(service.run(id, client=planner), 403, "access-denied")
    asked = planner.post(
        "/api/runs/20200101-000000-0000/requests", json={"kind": "stop", "id": "x"}
    )
    problem(asked, 403, "access-denied")
    assert planner.get("/api/runs").status_code == 200


def test_what_is_no_run_is_said(service: Served, id: str) -> None:
    client = service.client
    problem(client.get("/api/runs/20200101-000000-0000"), 404, "not-found")
    problem(client.get("/api/runs/20200101-000000-0000/entries"), 404, "not-found")
    problem(client.get("/api/runs/..%2f..%2fetc/report/report.json"), 404, "not-found")
    problem(service.run(id, 7), 412, "stale-revision")
    problem(service.run(service.create()), 422, "invalid")
    with pytest.raises(InvalidStatus, match="401"):
        service.socket("/api/robot/live", {})
