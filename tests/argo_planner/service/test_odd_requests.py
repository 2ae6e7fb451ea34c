"""Unusual requests: each gets one clear answer, and nothing is lost."""

import json
import math
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from websockets.exceptions import InvalidStatus

from argo_env.files.checked_lines import checked_line, checked_object
from argo_planner.service.rooms import mailbox
from argo_planner.service.storage import folder, plan_file
from tests.argo_planner.service.served import ALL, Served
from tests.argo_planner.service.test_http import problem

TASK = {"name": "a", "action": "WAYPOINT", "pose": {"x": 3.05, "y": 1.55, "z": 0.0}}
CHANGE = {"kind": "change_task", "name": "a", "retries": 3}
ADD = {"kind": "add_task", "task": TASK}


@pytest.fixture
def plan(service: Served) -> str:
    id = service.create("Round")
    assert service.command(id, 1, ADD).status_code == 200
    return id


def test_a_client_resumes_although_it_missed_more_messages_than_may_wait(
    service, plan, monkeypatch
) -> None:
    for k in range(2, 14):
        edit = {"kind": "change_task", "name": "a", "retries": k}
        assert service.command(plan, k, edit).status_code == 200
    monkeypatch.setattr(mailbox, "MOST_MESSAGES", 3)
    monkeypatch.setattr(mailbox, "MOST_CHARACTERS", 100)
    following = service.follow(plan, since=2)
    messages = [following.recv(timeout=10) for _ in range(13)]
    assert '"resumed"' in messages[0]
    assert all('"revision"' in text for text in messages[1:])


def test_listing_missions_writes_no_files(service, plan) -> None:
    folder: Path = service.folder
    (folder / "aaaaaaaaaaaa.plan").write_bytes(b"no plan\n")
    content = (folder / f"{plan}.plan").read_bytes()
    first, _, others = content.partition(b"\n")
    first = checked_line((checked_object(first) or {}) | {"id": "b" * 12})
    (folder / "bbbbbbbbbbbb.plan").write_bytes(first + others[:-20])
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    listed = service.client.get("/api/missions").json()["missions"]
    assert {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} == before
    by_id = {one["id"]: one for one in listed}
    assert "damaged" in by_id["aaaaaaaaaaaa"]["problem"]
    assert by_id[plan]["tasks"] == 1
    assert [one["tasks"] for one in listed if one["revision"] == 1 and not one["problem"]] == [0]


def test_the_list_shows_the_present_name_tasks_and_revision(service, plan) -> None:
    other = {**TASK, "name": "b"}
    assert service.command(plan, 2, {"kind": "add_task", "task": other}).status_code == 200
    assert service.command(plan, 3, {"kind": "remove_task", "name": "a"}).status_code == 200
    renamed = service.client.put(f"/api/missions/{plan}/name", json={"name": "Night"})
    assert renamed.status_code == 200
    service.client.delete(f"/api/missions/{plan}")
    (listed,) = service.client.get("/api/bin").json()["missions"]
    assert (listed["name"], listed["tasks"], listed["revision"]) == ("Night", 1, 4)
    service.client.delete(f"/api/bin/{plan}")


@pytest.mark.parametrize(
    "origin", ["http://[::1", "http://a:99999", "null", "//", "http://ä", "https://example.org"]
)
def test_odd_origins_are_refused(service, origin) -> None:
    answer = service.client.get("/api/service", headers={b"origin": origin.encode()})
    problem(answer, 403, "foreign-origin")


def test_a_body_without_a_stated_size_that_is_too_large_is_refused(service) -> None:
    def parts() -> Iterator[bytes]:
        for _ in range(30):
            yield b" " * 100_000

    headers = {"content-type": "application/json"}
    answer = service.client.post("/api/missions", content=parts(), headers=headers)
    problem(answer, 413, "too-large")


def test_an_error_in_an_edit_names_only_that_kind_of_edit(service, plan) -> None:
    wrong = {"kind": "add_task", "task": {**TASK, "pose": {"x": "1", "y": 0, "z": 0}}}
    detail = service.command(plan, 2, wrong).json()["detail"]
    assert "edits.0.add_task.task.pose.x" in detail
    assert "UndoEdit" not in detail
    at = "/api/runs/20260101-000000-0000/requests"
    request = service.post(at, kind="speed", id="x", speed="1")
    assert request.json()["detail"].startswith("body.speed.speed: ")
    answer = service.post(f"/api/missions/{plan}/commands", "*", kind="edt", id="x")
    assert "'edit', 'undo', 'redo', 'replace'" in answer.json()["detail"]


@pytest.mark.parametrize("since", ["abc", "-1", "", "1.5"])
def test_a_socket_refuses_since_without_a_number(service, plan, since) -> None:
    for path in (f"/api/missions/{plan}/live", "/api/robot/live"):
        with pytest.raises(InvalidStatus) as refused:
            service.socket(f"{path}?since={since}", {"authorization": f"Bearer {ALL}"})
        assert refused.value.response.status_code == 422
        error = json.loads(refused.value.response.body)
        assert error["code"] == "invalid"
        assert error["detail"].startswith("query.since: ")


def test_a_client_that_states_an_unknown_revision_gets_a_snapshot(service, plan) -> None:
    for since in (99, 10**30):
        assert '"snapshot"' in service.follow(plan, since=since).recv(timeout=10)[:30]


def test_a_version_of_an_old_revision_is_refused_with_the_later_revisions(service, plan) -> None:
    url = f"/api/missions/{plan}/versions"
    answer = service.client.post(url, json={"name": "v"}, headers={"if-match": '"1"'})
    error = problem(answer, 412, "stale-revision")
    assert error["newest"] == 2
    assert [revision["number"] for revision in error["since"]] == [2]


def test_a_repeated_restoration_is_answered_although_the_version_was_deleted(service, plan) -> None:
    url = f"/api/missions/{plan}/versions"
    stored = service.client.post(url, json={"name": "v"}, headers={"if-match": "*"}).json()
    assert service.command(plan, 2, CHANGE).status_code == 200
    restore = f"{url}/{stored['number']}/restore"
    body, made_on = {"id": "once-more"}, {"if-match": '"3"'}
    first = service.client.post(restore, json=body, headers=made_on)
    assert first.status_code == 200
    service.client.delete(f"{url}/{stored['number']}")
    again = service.client.post(restore, json=body, headers=made_on)
    assert again.status_code == 200
    assert again.json()["revision"] == first.json()["revision"]
    other = service.client.post(restore, json={"id": "another"}, headers=made_on)
    assert other.status_code == 404
    taken = service.client.post(f"{url}/7/restore", json=body, headers=made_on)
    problem(taken, 409, "command-id-taken")
    assert service.command(plan, 4, {**CHANGE, "retries": 9}).status_code == 200
    second = service.client.post(url, json={"name": "w"}, headers={"if-match": "*"}).json()
    assert second["number"] == stored["number"]
    again = service.client.post(restore, json=body, headers=made_on)
    assert again.json()["revision"] == first.json()["revision"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"name": "\u200b\u200b"},
            "name: Value error, the obstacle needs a name with visible characters",
        ),
        ({"name": "  "}, "visible characters"),
        ({"name": "a\nb"}, "U+000A"),
        ({"id": "\u200b"}, "id: Value error"),
        ({"pose": {"x": 1e9, "y": 0, "z": 0}}, "pose: Value error, the obstacle is more than"),
        (
            {"pose": {"x": 0, "y": 0, "z": 0, "yaw": 1e9}},
            "pose: Value error, the obstacle has a yaw",
        ),
        ({"pose": {"x": math.nan, "y": 0, "z": 0}}, "pose.x: Input should be a finite number"),
        ({"size": [1, math.inf, 1]}, "size.1: Input should be a finite number"),
        ({"size": [0, 1, 1]}, "greater than 0"),
        ({"size": [1, 1, 1e6]}, "less than or equal to 20"),
    ],
)
def test_odd_obstacles_are_refused(service, change, message) -> None:
    box = {"id": "1", "name": "box", "pose": {"x": 3, "y": 3, "z": 0}, "size": [1, 1, 1]}
    answer = service.client.put(
        "/api/world/obstacles",
        content=json.dumps({"obstacles": [box | change]}),  # httpx does not send NaN
        headers={"if-match": "*", "content-type": "application/json"},
    )
    detail = problem(answer, 422, "invalid")["detail"]
    assert detail.startswith("body.obstacles.0.")
    assert message in detail


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"start": {"x": 1e9, "y": 0, "z": 0}, "goal": TASK["pose"]}, "the start is more than"),
        ({"goal": {"x": 0, "y": -1e308, "z": 0}}, "the goal is more than"),
        ({"goal": {"x": 3.05, "y": 1.55, "z": 0, "yaw": 1e308}}, "the goal has a yaw"),
        (
            {"task": {**TASK, "pose": {"x": 0, "y": 0, "z": 1e9}}},
            "the pose of task 'a' is more than",
        ),
        ({"task": {"name": "a", "action": "WAYPOINT"}}, "has no pose"),
        (
            {"task": {"name": "a", "action": "START", "pose": TASK["pose"]}},
            "where a mission begins",
        ),
        ({"task": {"name": "a", "action": "MEASURE"}}, "has no object_id"),
        ({"task": {"name": "a", "action": "MEASURE", "object_id": "99999"}}, "99999"),
        ({"task": {"name": "a", "action": "WAIT"}}, "how long"),
    ],
)
def test_a_preview_of_an_invalid_path_is_refused(service, asked, message) -> None:
    answer = service.client.post("/api/world/way", json={"start": TASK["pose"]} | asked)
    assert message in problem(answer, 422, "invalid")["detail"]


def test_a_path_to_a_task_does_not_depend_on_what_follows_it(service) -> None:
    dock = service.client.get("/api/world").json()["docks"][0]["pose"]
    onward = {"transitions": [{"target": "b"}], "on_failure": "branch", "failure_target": "c"}
    for task in (TASK, TASK | onward, TASK | {"group": "g"}):
        way = service.client.post("/api/world/way", json={"start": dock, "task": task})
        assert way.status_code == 200, way.text
        assert way.json()["time"] > 0
    slow = service.post("/api/world/way", start=dock, task=TASK | {"velocity": 1e-320})
    assert slow.status_code == 200
    assert (slow.json()["time"], slow.json()["points"]) == (None, [])
    assert "takes longer than any mission" in slow.json()["problem"]


def test_a_mission_with_poses_outside_the_site_is_previewed(service, plan) -> None:
    for k, pose in enumerate([{"x": 1e308, "y": 0, "z": 0}, {**TASK["pose"], "yaw": 1e308}]):
        far = {**TASK, "name": f"far {k}", "pose": pose}
        assert service.command(plan, "*", {"kind": "add_task", "task": far}).status_code == 200
    preview = service.client.get(f"/api/missions/{plan}/preview")
    assert preview.status_code == 200, preview.text
    assert len(preview.json()["problems"]) == 2


def test_a_path_has_either_a_goal_or_a_task(service) -> None:
    start = TASK["pose"]
    for ends in ({}, {"goal": start, "task": TASK}):
        answer = service.client.post("/api/world/way", json={"start": start, **ends})
        assert "either" in problem(answer, 422, "invalid")["detail"]


@pytest.mark.parametrize(
    "requirements",
    [
        {"mandatory": ["nothing"]},
        {"mandatory": ["a", "nothing"]},
        {"optional": [{"what": "nothing"}]},
        {"windows": [{"what": "nothing", "latest": 60}]},
        {"before": [["a", "nothing"]]},
        {"likelihoods": [{"task": "a", "target": "nothing", "probability": 0.5}]},
    ],
)
def test_requirements_on_unknown_tasks_are_refused_at_once(service, plan, requirements) -> None:
    at = f"/api/missions/{plan}/orders"
    answer = service.post(at, requirements=requirements, time_limit=1)
    assert "'nothing'" in problem(answer, 422, "invalid")["detail"]


def test_the_file_of_a_plan_with_large_records_stays_small(service, plan, monkeypatch) -> None:
    monkeypatch.setattr(plan_file, "MAX_GROWTH", 100_000)
    monkeypatch.setattr(plan_file, "KEPT_RECORDS", 5)
    path = service.folder / f"{plan}.plan"
    sizes = []
    for k in range(60):
        edit = {"kind": "set_header", "anomaly_specification": f"{k}" + "x" * 9_000}
        assert service.command(plan, "*", edit).status_code == 200
        sizes.append(os.path.getsize(path))
    assert max(sizes) < 400_000
    assert service.client.get(f"/api/missions/{plan}").json()["revision"] == 62


def test_a_mission_that_can_not_be_moved_to_the_bin_stays_open(service, plan, monkeypatch) -> None:
    following = service.follow(plan)
    following.recv(timeout=10)
    monkeypatch.setattr(folder, "MOST_PLANS", 0)
    assert service.client.delete(f"/api/missions/{plan}").status_code == 409
    monkeypatch.undo()
    assert service.command(plan, "*", CHANGE).status_code == 200
    message = ""
    while '"revision"' not in message.partition(",")[0]:
        message = following.recv(timeout=10)
    assert service.client.delete(f"/api/missions/{plan}").status_code == 204
