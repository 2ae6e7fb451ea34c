"""Missions of a robot in another process, which sometimes loses its connection."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from websockets.exceptions import InvalidStatus

from tests.argo_planner.service.served import ALL, SECRETS, Served
from tests.argo_planner.service.test_run_host import SCRIPT, send_signal
from tests.argo_planner.service.test_runs import ask, start, state, wait_for
from tests.processes import ROOT

FAKE = "tests.argo_planner.service.fake_robot"


def start_remote_run(service: Served) -> str:
    """Import a mission, start a run of it by the remote robot, and return the run's id."""
    return start(service, service.imported(SCRIPT, start_area=1), drive="remote")["id"]


@contextmanager
def remote_robot(service: Served) -> Iterator[subprocess.Popen[bytes]]:
    dock = service.client.get("/api/world").json()["docks"][0]["pose"]
    pose = [str(dock[axis]) for axis in ("x", "y", "z", "yaw")]
    command = [sys.executable, "-m", FAKE, service.address, ALL, "1", *pose]
    robot = subprocess.Popen(command, cwd=ROOT)
    try:
        yield robot
    finally:
        robot.kill()
        robot.wait()


@pytest.mark.long
def test_a_remote_robot_carries_out_a_mission(service: Served) -> None:
    with remote_robot(service) as robot:
        run = start_remote_run(service)
        wait_for(service, run, moving=True)
        assert ask(service, run, "take_over")["progress"] == "confirmed"
        assert not state(service, run)["moving"]
        assert ask(service, run, "measure", checkpoint="1")["progress"] == "confirmed"
        assert ask(service, run, "give_back")["progress"] == "confirmed"
        ended = wait_for(service, run, status="ended")
        counts = {t["task"]: t["done"] + t["by_hand"] for t in ended["tasks"]}
        tasks = service.mission(ended["plan"])["tasks"]
        assert counts == {t["name"]: 1 for t in tasks if t["action"] != "START"}
        assert ended["headline"]["word"] in ("Success", "Done, 1 finding", "Done, 2 findings")
        assert robot.poll() is None


@pytest.mark.long
def test_an_interrupted_run_can_be_stopped_without_its_robot(service: Served) -> None:
    with remote_robot(service):
        run = start_remote_run(service)
        wait_for(service, run, moving=True)
        send_signal(signal.SIGKILL, run)
        while state(service, run)["status"] != "interrupted":
            time.sleep(0.05)
    assert ask(service, run, "go_on")["progress"] == "failed"
    run_state = state(service, run)
    assert run_state["status"] == "interrupted"
    assert "robot" in run_state["problem"]
    assert ask(service, run, "stop")["progress"] == "confirmed"
    run_state = state(service, run)
    assert run_state["status"] == "ended"
    assert run_state["headline"]["word"] == "No success"
    assert "the robot was not told that the run is over" in run_state["problem"]
    path = f"/api/runs/{run}/report/report.html"
    while (report := service.client.get(path)).status_code == 404:
        assert "try again in a moment" in report.json()["detail"]
        time.sleep(0.1)


@pytest.mark.long
def test_a_run_without_a_robot_ends_with_a_reason(service: Served) -> None:
    run = start_remote_run(service)
    while (run_state := state(service, run))["status"] == "preparing":
        time.sleep(0.05)
    assert run_state["status"] == "ended"
    assert "robot" in run_state["problem"]


def test_only_an_operator_may_connect_a_robot(service: Served) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        service.socket("/api/robot/link", {"authorization": f"Bearer {SECRETS['plan']}"})
