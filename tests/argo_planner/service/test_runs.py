"""Runs over HTTP and WebSockets, from their start to their report."""

import json
import time

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from tests.argo_planner.service.served import ALL, SECRETS, Served, require_private
from tests.argo_planner.service.test_http import new_resource, problem
from tests.argo_planner.service.test_run_host import SCRIPT


@pytest.fixture(scope="module")
def id(service: Served) -> str:
    return service.imported(SCRIPT, start_area=1)


def start(service: Served, id: str, **other: object) -> dict:
    return new_resource(
        service.run(id, 1, **({"drive": "route", "seed": 4} | other)), 201, "/api/runs"
    )


def state(service: Served, run: str) -> dict:
    return service.client.get(f"/api/runs/{run}").json()


def wait_for(service: Served, run: str, **wanted: object) -> dict:
    while True:
        run_state = state(service, run)
        if all(run_state[name] == value for name, value in wanted.items()):
            return run_state
        assert run_state["status"] != "interrupted", run_state
        time.sleep(0.05)


def ask(service: Served, run: str, kind: str, **fields: object) -> dict:
    """Send a request to a run, and return its final state."""
    request = {"kind": kind, "id": f"{kind}-{time.monotonic_ns()}"} | fields
    return wait_for_answer(service, service.client.post(f"/api/runs/{run}/requests", json=request))


def wait_for_answer(service: Served, accepted: httpx.Response) -> dict:
    """Wait until an accepted request is completed, and return its final state."""
    assert accepted.status_code == 202, accepted.text
    while True:
        request_state = service.client.get(accepted.headers["location"]).json()
        if request_state["progress"] not in ("accepted", "under way"):
            return request_state
        time.sleep(0.02)


def test_a_run_is_started_followed_controlled_and_reported(service: Served, id: str) -> None:
    live = service.socket("/api/robot/live", {"authorization": f"Bearer {ALL}"})
    assert json.loads(live.recv())["kind"] == "state"
    run = start(service, id, speed=20.0)["id"]
    refused = service.run(id, client=service.as_("bob"), drive="route")
    assert "ann has begun run" in problem(refused, 409, "conflict")["detail"]
    wait_for(service, run, moving=True)
    assert ask(service, run, "pause")["progress"] == "confirmed"
    paused = state(service, run)
    assert (paused["mode"], paused["moving"]) == ("paused", False)
    assert ask(service, run, "take_over")["progress"] == "confirmed"
    wrong = ask(service, run, "measure", checkpoint="99")
    assert wrong["progress"] == "refused"
    assert "99" in wrong["reason"]
    assert wrong["subject"] == "99"
    assert ask(service, run, "give_back")["progress"] == "confirmed"
    assert ask(service, run, "speed", speed=None)["progress"] == "confirmed"
    ended = wait_for(service, run, status="ended")
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
    messages = [json.loads(late.recv(timeout=30)) for _ in range(4)]
    assert [message.get("number") for message in messages] == [None, *numbers[-3:]]
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
    require_private(service.folder / "runs")
    for name in ("report.html", "report.json"):
        path = service.folder / "runs" / run / name
        content = path.read_bytes()
        path.write_bytes(content.replace(b"Success", b"Failure", 1))
        damaged = service.client.get(f"/api/runs/{run}/report/{name}")
        says = f"runs/{run}/{name} is damaged: its content does not fit its checksum"
        assert says in problem(damaged, 503, "unavailable")["detail"]
        path.write_bytes(content)
    live.close()
    late.close()


def auth() -> dict[str, str]:
    return {"authorization": f"Bearer {ALL}"}


def test_unknown_drives_sensors_and_checkpoints_are_refused_at_once(
    service: Served, id: str
) -> None:
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


def test_the_kinds_of_faults_are_listed_and_those_that_do_not_fit_are_refused_at_once(
    service: Served, id: str
) -> None:
    kinds = {one["kind"]: one for one in service.client.get("/api/faults").json()["kinds"]}
    place = next(field for field in kinds["gas_leak"]["fields"] if field["name"] == "place")
    assert place["unit"] == "m"
    outside = [limits["most"] + 1 for limits in place["numbers"]]
    before = service.client.get("/api/runs").json()["runs"]
    good = {"kind": "emergency_stop", "at": 5, "until": 6}
    for faults, named in (
        ([good, {"kind": "gas_leak", "place": outside}], "faults[1] (gas_leak): there is no"),
        ([good, {"kind": "abnormal_value", "checkpoint": 99}], "faults[1] (abnormal_value)"),
        ([{"kind": "gas_leak"}], "choose another drive"),
    ):
        refused = service.run(id, drive="route", faults=faults)
        assert named in problem(refused, 422, "invalid")["detail"]
    assert service.client.get("/api/runs").json()["runs"] == before
    for fault in (
        {"kind": "gas_leak", "place": [3.0, 1.5, "high"]},
        {"kind": "brick", "size": [0.3, 0.2, 2.0]},
        {"kind": "missing_plate", "floor": 2, "rect": [1.0, 1.0, 0.0, 2.0]},
    ):
        assert service.run(id, faults=[fault]).status_code == 422
    too_large = service.run(id, faults=[{"kind": "gas_leak", "rate": 2.0}])
    assert too_large.status_code == 422
    assert "rate" in too_large.text


@pytest.mark.physics
def test_faults_have_places_sizes_and_times(service: Served, id: str) -> None:
    faults = [
        {"kind": "gas_leak", "place": [9.0, 3.5, 0.8], "at": 20.0, "until": 110.0},
        {"kind": "brick", "floor": 1, "place": [7.25, 1.55], "size": [0.2, 0.2, 0.1], "yaw": 0.0},
        {"kind": "connection_loss", "floor": 3, "rect": [0.0, 0.0, 2.0, 2.0]},
        {"kind": "abnormal_pump", "pump": "pump P-301", "defect": "bearing"},
        {"kind": "displaced_checkpoint", "checkpoint": 2, "offset": [0.0, 0.05, 0.0]},
    ]
    run = start(service, id, drive="kinematic", faults=faults)["id"]
    wait_for(service, run, status="running")
    assert ask(service, run, "stop")["progress"] == "confirmed"
    report = f"/api/runs/{run}/report/report.json"
    while (answer := service.client.get(report)).status_code == 404:
        time.sleep(0.1)
    stored = answer.json()["faults"]
    for given, found in zip(faults, stored, strict=True):
        assert found.items() >= given.items()


def test_a_missing_report_is_explained(service: Served, id: str) -> None:
    run = start(service, id, speed=1.0)["id"]
    missing = service.client.get(f"/api/runs/{run}/report/report.html")
    detail = problem(missing, 404, "not-found")["detail"]
    assert "when it has ended" in detail
    assert f"/api/runs/{run}/entries" in detail
    wait_for(service, run, status="running")
    assert ask(service, run, "stop")["progress"] == "confirmed"
    assert state(service, run)["status"] == "ended", (
        "the run must have ended before the request is confirmed"
    )


@pytest.mark.long
def test_a_run_continues_without_followers(service: Served, id: str) -> None:
    live = service.socket("/api/robot/live", auth())
    run = start(service, id, speed=None)["id"]
    live.close()
    wait_for(service, run, status="ended")


def test_only_operators_control_runs(service: Served, id: str) -> None:
    planner = service.as_("x", SECRETS["plan"])
    problem(service.run(id, client=planner), 403, "access-denied")
    asked = planner.post(
        "/api/runs/20200101-000000-0000/requests", json={"kind": "stop", "id": "x"}
    )
    problem(asked, 403, "access-denied")
    assert planner.get("/api/runs").status_code == 200


def test_unknown_runs_and_missions_that_can_not_run_are_refused(service: Served, id: str) -> None:
    client = service.client
    problem(client.get("/api/runs/20200101-000000-0000"), 404, "not-found")
    problem(client.get("/api/runs/20200101-000000-0000/entries"), 404, "not-found")
    problem(client.get("/api/runs/..%2f..%2fetc/report/report.json"), 404, "not-found")
    problem(service.run(id, 7), 412, "stale-revision")
    problem(service.run(service.create()), 422, "invalid")
    with pytest.raises(InvalidStatus, match="401"):
        service.socket("/api/robot/live", {})
