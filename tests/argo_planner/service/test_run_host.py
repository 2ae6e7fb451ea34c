"""Runs in separate processes: requests, messages, and runs whose process was killed."""

import asyncio
import json
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

import pytest

from argo_compiler.base.errors import Conflict, NotFound
from argo_env.planning.opening import OpenedSite
from argo_env.run.log import Entry
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.service.runs import host as hosts
from argo_planner.service.runs import requests as asked
from argo_planner.service.runs.folder import RunFolder
from argo_planner.service.runs.host import AfterRestart, RunHost
from argo_planner.service.runs.requests import RunOrder
from argo_planner.service.runs.state import RunMode, RunStatus
from tests.argo_planner.service.served import waiting_messages
from tests.whole_scripts import import_whole

pytestmark = pytest.mark.anyio

SCRIPT = (
    "Mission Protocol #1\n1. Set the starting point in starting area 1.\n2. Check valve R18.\n"
    "3. Check valve R25.\n4. Return to the docking station in starting area 1.\n"
)


def now() -> datetime:
    return datetime.now(UTC)


def order(site: OpenedSite, **other: object) -> RunOrder:
    mission = import_whole(SCRIPT, site.catalog).mission
    fields = {"drive": "route", "speed": None, "seed": 4} | other
    return RunOrder(
        plan="0" * 12, revision=3, name="Round", mission=mission, site=site.reference, **fields
    )


@asynccontextmanager
async def open_host(folder: Path, after: str = "wait") -> AsyncIterator[RunHost]:
    """Open a host of runs, and close it at the end."""
    host = RunHost(folder, AfterRestart(after), now)
    await host.open()
    try:
        async with asyncio.timeout(120):
            yield host
    finally:
        await host.close()


def send_signal(number: signal.Signals, run: str = "") -> None:
    """Send a signal to the process of a run, by default to that of the only run."""
    name = f"run {run}"
    [process] = [one for one in multiprocessing.active_children() if one.name.startswith(name)]
    assert process.pid is not None
    os.kill(process.pid, number)


async def wait_until(condition: Callable[[], bool]) -> None:
    while not condition():
        await asyncio.sleep(0.01)


async def ask_and_wait(host: RunHost, request: asked.RunRequest, by: str = "ann") -> str:
    """Send a request to the run, and return its final progress."""
    state = host.state
    assert state is not None
    await host.send_request(state.id, request, by)
    await wait_until(lambda: host.find_request(state.id, request.id).over)
    return host.find_request(state.id, request.id).progress


async def start_run(host: RunHost, site: OpenedSite, after: float = 3.0, **other: object) -> str:
    """Start a run, wait until its time exceeds `after` s, and return its id."""
    run = (await host.start(order(site, **({"speed": 20.0} | other)), "ann")).id
    await wait_until(lambda: bool(host.state and host.state.t > after))
    return run


async def interrupt(host: RunHost) -> None:
    """Kill the process of the run, and wait until the host knows it."""
    send_signal(signal.SIGKILL)
    await wait_until(lambda: host.state.status is RunStatus.INTERRUPTED)


def has_ended(host: RunHost) -> Callable[[], bool]:
    return lambda: host.state is not None and host.state.status is RunStatus.ENDED


async def read_record(host: RunHost) -> RunRecord:
    assert host.state is not None
    while True:
        with suppress(NotFound):
            await host.read_report_file(host.state.id, "report.html")
            break
        await asyncio.sleep(0.05)
    return RunRecord.model_validate_json(await host.read_report_file(host.state.id, "report.json"))


async def wait_for_headline(host: RunHost) -> str:
    await wait_until(has_ended(host))
    assert host.state is not None
    assert host.state.headline is not None
    return host.state.headline.word


@pytest.mark.long
async def test_a_run_equals_that_of_the_library(tmp_path, site) -> None:
    requested = order(site)
    spec = RunSpec(mission=requested.mission, site=site.reference, drive="route", seed=4)
    alone = simulate(spec, site)

    async with open_host(tmp_path) as host:
        follower = host.subscribe("1")
        started = await host.start(requested, "ann")
        assert started.status is RunStatus.PREPARING
        await wait_until(has_ended(host))
        state = host.state
        assert state is not None
        assert state.headline == alone.headline
        assert {t.task: t.done for t in state.tasks} == {
            run.task: 1
            for run in alone.tasks
            if run.task in {t.name for t in requested.mission.tasks}
        }
        assert [r.value for r in state.readings] == [r.value for r in alone.readings]
        entries = await waiting_messages(follower, "entry")
        assert [entry["number"] for entry in entries] == [*range(1, state.entries + 1)]
        assert await read_record(host) == alone


@pytest.mark.long
async def test_the_end_of_a_process_does_not_end_the_next_run(tmp_path, site, monkeypatch) -> None:
    original, is_reading, may_continue = (
        RunFolder.load_entries,
        threading.Event(),
        threading.Event(),
    )

    def entries(folder: RunFolder, run: str) -> tuple[Entry, ...]:
        is_reading.set()
        assert may_continue.wait(60)
        return original(folder, run)

    async with open_host(tmp_path) as host:
        await host.start(order(site), "ann")
        await wait_until(has_ended(host))
        # The host reads the entries when the process has ended.
        monkeypatch.setattr(RunFolder, "load_entries", entries)
        await wait_until(is_reading.is_set)
        starting = asyncio.create_task(host.start(order(site, speed=20.0), "bob"))
        await asyncio.sleep(0.1)
        may_continue.set()
        second = await starting
        await wait_until(lambda: host.state.status is not RunStatus.PREPARING)
        assert (host.state.id, host.state.status) == (second.id, RunStatus.RUNNING)
        assert await ask_and_wait(host, asked.EndRun(id="stop")) == "confirmed"


@pytest.mark.long
async def test_a_second_run_is_refused_with_the_name_of_who_has_the_robot(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        await host.start(order(site, speed=1.0), "ann")
        with pytest.raises(Conflict, match="ann has begun run"):
            await host.start(order(site), "bob")
        assert host.state is not None
        await wait_until(lambda: host.state.status is RunStatus.RUNNING)
        assert await ask_and_wait(host, asked.EndRun(id="s")) == "confirmed"
        await wait_until(has_ended(host))
        await host.start(order(site), "bob")
        await wait_until(has_ended(host))
        assert host.state.by == "bob"
        assert [state.by for state in await host.list_runs()] == ["bob", "ann"]


@pytest.mark.long
async def test_a_pause_is_confirmed_only_when_nothing_moves(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        await host.start(order(site, speed=20.0), "ann")
        await wait_until(lambda: bool(host.state and host.state.moving and host.state.t > 5))
        run = host.state.id
        follower = host.subscribe("1", host.state.entries)
        accepted = await host.send_request(run, asked.PauseRun(id="p"), "ann")
        assert accepted.progress == "accepted"
        again = await host.send_request(run, asked.PauseRun(id="p"), "ann")
        assert again.id == "p"
        await wait_until(lambda: host.find_request(run, "p").over)
        steps = [m["request"]["progress"] for m in await waiting_messages(follower, "request")]
        assert steps == ["accepted", "under way", "confirmed"]
        assert host.state.mode is RunMode.PAUSED
        assert not host.state.moving
        with pytest.raises(Conflict, match="id p"):
            await host.send_request(run, asked.TakeRobot(id="p"), "ann")
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        at = host.state.t
        await asyncio.sleep(0.5)
        assert host.state.t < at + 5, "time must not pass quickly while a person is waited for"
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        await wait_until(has_ended(host))
        assert host.state.headline is not None
        assert host.state.headline.word == "Success"
        with pytest.raises(Conflict, match="is over"):
            await host.send_request(run, asked.PauseRun(id="q"), "ann")


async def test_a_person_takes_over_drives_measures_skips_and_gives_back(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        requested = order(site, speed=None)
        await host.start(order(site, speed=20.0), "ann")
        await wait_until(lambda: bool(host.state and host.state.moving and host.state.t > 3))
        refused = [
            asked.SkipTask(id="1", task="MEASURE 1"),
            asked.DoTask(id="2", task="MEASURE 1"),
            asked.StopByHandNow(id="3"),
        ]
        for request in refused:
            assert await ask_and_wait(host, request) == "refused", request
        assert await ask_and_wait(host, asked.TakeRobot(id="t")) == "confirmed"
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        first, second = [t for t in requested.mission.tasks if t.action == "MEASURE"]
        assert await ask_and_wait(host, asked.DoTask(id="4", task="nobody")) == "refused"
        assert await ask_and_wait(host, asked.DoTask(id="5", task=first.name)) == "confirmed"
        assert (
            await ask_and_wait(host, asked.MeasureAt(id="6", checkpoint=second.object_id))
            == "confirmed"
        )
        assert await ask_and_wait(host, asked.SkipTask(id="7", task=second.name)) == "confirmed"
        assert host.state.skipped == (second.name,)
        assert host.state.mode is RunMode.SUPERVISED
        assert len(host.state.readings) == 2
        assert await ask_and_wait(host, asked.GoOnWithRun(id="8")) == "refused"
        assert await ask_and_wait(host, asked.GiveRobotBack(id="9")) == "confirmed"
        await wait_until(has_ended(host))
        assert {t.task: (t.done, t.by_hand) for t in host.state.tasks if t.by_hand} == {
            first.name: (0, 1),
            second.name: (0, 1),
        }
        record = await read_record(host)
        assert sum(run.by_hand for run in record.tasks) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows can't stop processes")
async def test_a_run_whose_process_hangs_is_stopped(tmp_path, site, monkeypatch) -> None:
    async with open_host(tmp_path) as host:
        await start_run(host, site, after=10.0, speed=50.0)
        [hung] = [p for p in multiprocessing.active_children() if p.name.startswith("run")]
        os.kill(hung.pid, signal.SIGSTOP)
        monkeypatch.setattr(hosts, "STOP_TIMEOUT", 0.3)
        assert await ask_and_wait(host, asked.EndRun(id="e")) == "confirmed"
        assert not hung.is_alive()
        assert host.state.status is RunStatus.ENDED


@pytest.mark.long
async def test_a_run_whose_process_was_killed_is_resumed(tmp_path, site) -> None:
    spec = RunSpec(mission=order(site).mission, site=site.reference, drive="route", seed=4)
    alone = simulate(spec, site)

    async with open_host(tmp_path) as host:
        await start_run(host, site, after=10.0, speed=50.0)
        await interrupt(host)
        assert "signal 9" in host.state.problem
        with pytest.raises(Conflict, match="interrupted"):
            await host.send_request(host.state.id, asked.PauseRun(id="p"), "ann")
        with pytest.raises(Conflict, match="ann has begun"):
            await host.start(order(site), "bob")
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        await wait_until(has_ended(host))
        record = await read_record(host)
        assert [(r.task, r.value) for r in record.readings] == [
            (r.task, r.value) for r in alone.readings
        ]
        assert record.resumed


@pytest.mark.long
@pytest.mark.parametrize("after", ["go-on", "wait"])
async def test_a_restarted_service_finds_its_run(tmp_path, site, after: str) -> None:
    async with open_host(tmp_path) as host:
        await start_run(host, site, after=10.0, speed=50.0)
    async with open_host(tmp_path, after) as host:
        state = host.state
        assert state is not None
        if after == "wait":
            assert state.status is RunStatus.INTERRUPTED
            assert "the service has ended" in state.problem
            assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        assert await wait_for_headline(host) == "Success"
        history = await host.list_entries(state.id, 0, 10**6)
        assert history.count == len(history.entries) == host.state.entries
        with pytest.raises(NotFound):
            await host.list_entries("20200101-000000-0000", 0, 1)


@pytest.mark.long
async def test_a_run_that_can_not_start_ends_with_a_reason(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = (await host.start(order(site, drive="flying"), "ann")).id
        await wait_until(has_ended(host))
        assert "no drive `flying`" in host.state.problem
        with pytest.raises(NotFound, match="before anything had happened"):
            await host.read_report_file(run, "report.html")
        await host.start(order(site), "bob")
        await wait_until(has_ended(host))
        assert host.state.problem is None


# Requests while the mission is paused or a person has the robot.


@pytest.mark.long
async def test_a_pause_during_a_pause_changes_nothing(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        await start_run(host, site)
        assert await ask_and_wait(host, asked.PauseRun(id="p")) == "confirmed"
        entries = [e.events for e in (await host.list_entries(host.state.id, 0, 10**6)).entries]
        assert await ask_and_wait(host, asked.PauseRun(id="q")) == "confirmed"
        assert host.state.mode is RunMode.PAUSED
        later = [e.events for e in (await host.list_entries(host.state.id, 0, 10**6)).entries]
        assert [*filter(None, later)] == [*filter(None, entries)]
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        assert await wait_for_headline(host) == "Success"


@pytest.mark.long
async def test_a_person_who_has_the_robot_can_neither_pause_nor_skip_twice(tmp_path, site) -> None:
    name = next(t.name for t in order(site).mission.tasks if t.action == "MEASURE")

    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        assert await ask_and_wait(host, asked.GiveRobotBack(id="1")) == "refused"
        assert "nobody has the robot" in host.find_request(run, "1").reason
        assert await ask_and_wait(host, asked.PauseRun(id="p")) == "confirmed"
        assert await ask_and_wait(host, asked.GiveRobotBack(id="2")) == "refused"
        assert host.state.mode is RunMode.PAUSED
        assert await ask_and_wait(host, asked.TakeRobot(id="t")) == "confirmed"
        assert host.state.mode is RunMode.SUPERVISED
        assert await ask_and_wait(host, asked.PauseRun(id="3")) == "refused"
        assert "until they give it back" in host.find_request(run, "3").reason
        assert await ask_and_wait(host, asked.SkipTask(id="4", task=name)) == "confirmed"
        assert await ask_and_wait(host, asked.SkipTask(id="5", task=name)) == "refused"
        assert "skipped already" in host.find_request(run, "5").reason
        assert host.state.skipped == (name,)
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        assert await ask_and_wait(host, asked.GiveRobotBack(id="b")) == "confirmed"
        assert host.state.mode is not RunMode.PAUSED, (
            "giving the robot back also ends the earlier pause"
        )
        assert await wait_for_headline(host) != "No success"
        assert {t.task: t.by_hand for t in host.state.tasks}[name] == 1


async def test_a_new_state_is_sent_before_the_confirmation_of_its_request(tmp_path, site) -> None:
    name = next(t.name for t in order(site).mission.tasks if t.action == "MEASURE")

    async with open_host(tmp_path) as host:
        await start_run(host, site)
        follower = host.subscribe("1", host.state.entries)
        for request, mode, skipped in (
            (asked.PauseRun(id="p"), "paused", []),
            (asked.TakeRobot(id="t"), "supervised", []),
            (asked.SkipTask(id="s", task=name), "supervised", [name]),
        ):
            assert await ask_and_wait(host, request) == "confirmed"
            messages = []
            while not messages or messages[-1].get("request", {}).get("progress") != "confirmed":
                messages.append(json.loads(await follower.next_message()))
            states = [message["state"] for message in messages if message["kind"] == "state"]
            assert states[-1]["mode"] == mode
            assert states[-1]["skipped"] == skipped
