"""A person has the robot: what can be asked twice, and what only in its time."""

import json

import pytest

from argo_planner.service.runs import requests as asked
from argo_planner.service.runs.host import RunHost
from argo_planner.service.runs.state import RunMode
from tests.argo_planner.service.test_run_host import (
    begun,
    done,
    done_by_itself,
    order,
    play,
)


@pytest.mark.long
def test_a_pause_during_a_pause_changes_nothing(tmp_path, site) -> None:
    async def script(host: RunHost) -> None:
        await begun(host, site)
        assert await done(host, asked.PauseRun(id="p")) == "confirmed"
        entries = [e.events for e in (await host.history(host.state.id, 0, 10**6)).entries]
        assert await done(host, asked.PauseRun(id="q")) == "confirmed"
        assert host.state.mode is RunMode.PAUSED
        later = [e.events for e in (await host.history(host.state.id, 0, 10**6)).entries]
        assert [*filter(None, later)] == [*filter(None, entries)]
        assert await done(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        assert await done(host, asked.GoOnWithRun(id="g")) == "confirmed"
        assert await done_by_itself(host) == "Success"

    play(tmp_path, script)


@pytest.mark.long
def test_who_has_the_robot_neither_pauses_nor_skips_twice(tmp_path, site) -> None:
    name = next(t.name for t in order(site).mission.tasks if t.action == "MEASURE")

    async def script(host: RunHost) -> None:
        run = await begun(host, site)
        assert await done(host, asked.GiveRobotBack(id="1")) == "refused"
        assert "nobody has the robot" in host.request(run, "1").reason
        assert await done(host, asked.PauseRun(id="p")) == "confirmed"
        assert await done(host, asked.GiveRobotBack(id="2")) == "refused"
        assert host.state.mode is RunMode.PAUSED
        assert await done(host, asked.TakeRobot(id="t")) == "confirmed"
        assert host.state.mode is RunMode.SUPERVISED
        assert await done(host, asked.PauseRun(id="3")) == "refused"
        assert "until they give it back" in host.request(run, "3").reason
        assert await done(host, asked.SkipTask(id="4", task=name)) == "confirmed"
        assert await done(host, asked.SkipTask(id="5", task=name)) == "refused"
        assert "skipped already" in host.request(run, "5").reason
        assert host.state.skipped == (name,)
        assert await done(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        assert await done(host, asked.GiveRobotBack(id="b")) == "confirmed"
        assert host.state.mode is not RunMode.PAUSED, "the pause before is over as well"
        assert await done_by_itself(host) != "No success"
        assert {t.task: t.by_hand for t in host.state.tasks}[name] == 1

    play(tmp_path, script)


def test_the_state_is_told_before_what_has_brought_it_about(tmp_path, site) -> None:
    name = next(t.name for t in order(site).mission.tasks if t.action == "MEASURE")

    async def script(host: RunHost) -> None:
        await begun(host, site)
        follower = host.follow("1", host.state.entries)
        for request, mode, skipped in (
            (asked.PauseRun(id="p"), "paused", []),
            (asked.TakeRobot(id="t"), "supervised", []),
            (asked.SkipTask(id="s", task=name), "supervised", [name]),
        ):
            assert await done(host, request) == "confirmed"
            heard = []
            while not heard or heard[-1].get("request", {}).get("progress") != "confirmed":
                heard.append(json.loads(await follower.take()))
            states = [message["state"] for message in heard if message["kind"] == "state"]
            assert states[-1]["mode"] == mode
            assert states[-1]["skipped"] == skipped

    play(tmp_path, script)
