"""A robot in another process carries a mission out, and loses its connection now and then."""

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
from tests.argo_planner.service.test_runs import ask, start, state, wait
from tests.processes import ROOT

FAKE = "tests.argo_planner.service.fake_robot"


def begin(service: Served) -> str:
    """Begins a run of a mission of its own."""
    return start(service, service.imported(SCRIPT, start_area=1), drive="remote")["id"]


@contextmanager
def a_robot(service: Served) -> Iterator[subprocess.Popen[bytes]]:
    dock = service.client.get("/api/world").json()["docks"][0]["pose"]
    place = [str(dock[axis]) for axis in ("x", "y", "z", "yaw")]
    command = [sys.executable, "-m", FAKE, service.address, ALL, "1", *place]
    robot = subprocess.Popen(command, cwd=ROOT)
    try:
        yield robot
    finally:
        robot.kill()
        robot.wait()


@pytest.mark.long
def test_a_robot_somewhere_else_carries_a_mission_out(service: Served) -> None:
    with a_robot(service) as robot:
        run = begin(service)
        wait(service, run, moving=True)
        assert ask(service, run, "take_over")["progress"] == "confirmed"
        assert not state(service, run)["moving"]
        assert ask(service, run, "measure", checkpoint="1")["progress"] == "confirmed"
        assert ask(service, run, "give_back")["progress"] == "confirmed"
        ended = wait(service, run, status="ended")
        counts = {t["task"]: t["done"] + t["by_hand"] for t in ended["tasks"]}
        tasks = service.mission(ended["plan"])["tasks"]
        assert counts == {t["name"]: 1 for t in tasks if t["action"] != "START"}
        assert ended["headline"]["word"] in ("Success", "Done, 1 finding", "Done, 2 findings")
        assert robot.poll() is None


@pytest.mark.long
def test_an_interrupted_run_stops_without_its_robot(service: Served) -> None:
    with a_robot(service):
        run = begin(service)
        wait(service, run, moving=True)
        send_signal(signal.SIGKILL, run)
        while state(service, run)["status"] != "interrupted":
            time.sleep(0.05)
    assert ask(service, run, "go_on")["progress"] == "failed"
    found = state(service, run)
    assert found["status"] == "interrupted"
    assert "robot" in found["problem"]
    assert ask(service, run, "stop")["progress"] == "confirmed"
    found = state(service, run)
    assert found["status"] == "ended"
    assert found["headline"]["word"] == "No success"
    assert "the robot was not told that the run is over" in found["problem"]
    path = f"/api/runs/{run}/report/report.html"
    while (report := service.client.get(path)).status_code == 404:
        assert "ask again in a moment" in report.json()["detail"]
        time.sleep(0.1)


@pytest.mark.long
def test_without_a_robot_it_is_said(service: Served) -> None:
    run = begin(service)
    while (found := state(service, run))["status"] == "preparing":
        time.sleep(0.05)
    assert found["status"] == "ended"
    assert "robot" in found["problem"]


def test_only_who_operates_may_be_the_robot(service: Served) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        service.socket("/api/robot/link", {"authorization": f"Bearer {SECRETS['plan']}"})
