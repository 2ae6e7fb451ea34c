"""The list of missions: folders, what it states of each mission, latest runs, and examples."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from argo_env.planning.opening import OpenedSite
from argo_planner.service.storage.folder import PlanFolder
from tests.argo_planner.service.served import SECRETS, Served, served, wait_or_fail
from tests.argo_planner.service.test_http import problem
from tests.argo_planner.service.test_plan import mission
from tests.argo_planner.service.test_runs import start, wait_for
from tests.argo_planner.service.test_storage import AT, next_id

ROUND = "Start in starting area 1.\nCheck checkpoint #8.\nCheck valve R18.\nCheck checkpoint #8.\n"


def summary(service: Served, id: str) -> Any:
    missions = service.client.get("/api/missions").json()["missions"]
    return next(one for one in missions if one["id"] == id)


def file(service: Served, id: str, folder: str, **seen: str | None) -> Any:
    return service.client.put(f"/api/missions/{id}/folder", json={"folder": folder} | seen)


def test_a_mission_is_moved_to_a_folder_and_back(service: Served) -> None:
    id = service.create("Round")
    before = summary(service, id)
    assert before["folder"] == ""
    assert file(service, id, "Weekly ☀").json()["folder"] == "Weekly ☀"
    assert summary(service, id) == before | {"folder": "Weekly ☀"}
    copy = service.post(f"/api/missions/{id}/duplicate", name="Copy").json()
    assert copy["folder"] == "Weekly ☀"
    assert file(service, id, "").json()["folder"] == ""


def test_a_mission_that_somebody_else_has_moved_stays_there(service: Served) -> None:
    id = service.create("Round")
    file(service, id, "Weekly", seen="")
    refused = problem(file(service, id, "Daily", seen=""), 409, "filed-since")
    assert "in the folder 'Weekly'" in refused["detail"]
    assert summary(service, id)["folder"] == "Weekly"
    assert file(service, id, "Daily", seen="Weekly").status_code == 200


def test_one_of_two_moves_at_once_is_made(service: Served) -> None:
    id = service.create("Round")
    with ThreadPoolExecutor() as threads:
        moves = threads.map(lambda name: file(service, id, name, seen="").status_code, "AB")
        assert sorted(moves) == [200, 409]


@pytest.mark.parametrize("name", [" ", "\t", "a\nb", "x" * 201])
def test_a_folder_needs_a_name_that_can_be_shown(service: Served, name: str) -> None:
    id = service.create("Round")
    assert "the folder" in problem(file(service, id, name), 422, "invalid")["detail"]


def test_viewers_move_nothing(service: Served) -> None:
    id = service.create("Round")
    viewer = service.as_("vera", SECRETS["view"])
    answer = viewer.put(f"/api/missions/{id}/folder", json={"folder": "Weekly"})
    problem(answer, 403, "access-denied")
    answer = viewer.post("/api/examples/protocol_3/mission", json={})
    problem(answer, 403, "access-denied")


def test_folder_and_checkpoints_are_stored_and_read_without_opening(tmp_path) -> None:
    with PlanFolder(tmp_path, next_id) as folder:
        with folder.create("Round", mission("a", "b"), AT, "Weekly") as plan:
            document = plan.document
            record = document.make_folder_record("Daily", "Weekly", "ann", AT)
            plan.append(document.apply(record), record)
            plan._rewrite()  # with the folder in its first line
        (read,) = folder.list_plans()
        assert (read.folder, read.tasks) == ("Daily", 2)
        with folder.open(read.id) as again:
            assert again.document.folder == "Daily"


def test_the_list_states_checkpoints_and_bounds_of_opened_missions(service: Served) -> None:
    id = service.imported(ROUND, start_area=1)
    wait_or_fail(lambda: summary(service, id)["least_time"] is not None)
    found = summary(service, id)
    assert 0 < found["least_time"] <= found["most_time"]
    assert found["checkpoints"][0] == "8"
    assert len(found["checkpoints"]) == 2


def test_latest_runs_and_the_last_one_of_each_mission(service: Served) -> None:
    first, second = service.imported(ROUND), service.imported(ROUND)
    runs = []
    for id in (first, second, first):
        runs.append(start(service, id, speed=None)["id"])
        wait_for(service, runs[-1], status="ended")
    found = service.client.get("/api/runs/latest?most=2").json()
    assert [run["id"] for run in found["latest"]] == [runs[2], runs[1]]
    last = {run["plan"]: run for run in found["by_mission"]}
    assert (last[first]["id"], last[second]["id"]) == (runs[2], runs[1])
    assert (last[first]["ending"], last[first]["tone"]) == ("success", "good")
    assert last[first]["t"] > 0
    assert service.client.get("/api/runs/latest?most=0").status_code == 422


def test_each_example_becomes_a_mission(service: Served) -> None:
    examples = service.client.get("/api/examples").json()["examples"]
    assert {"mission_1", "protocol_3", "rounds_and_windows"} <= {one["name"] for one in examples}
    assert "darmstadt_1" not in {one["name"] for one in examples}
    for one in examples:
        made = service.post(f"/api/examples/{one['name']}/mission")
        assert made.status_code == 201, made.text
        assert made.json()["tasks"] > 0
    named = service.post("/api/examples/protocol_3/mission", name="My round")
    assert named.json()["name"] == "My round"
    refused = problem(service.post("/api/examples/brick/mission"), 404, "not-found")
    assert "protocol_3" in refused["detail"]


def test_runs_are_listed_after_a_restart(tmp_path, site: OpenedSite) -> None:
    with served(tmp_path, site) as service:
        id = service.imported(ROUND)
        run = start(service, id, speed=None)["id"]
        wait_for(service, run, status="ended")
    with served(tmp_path, site) as service:
        (last,) = service.client.get("/api/runs/latest").json()["by_mission"]
        assert (last["id"], last["plan"], last["tone"]) == (run, id, "good")
