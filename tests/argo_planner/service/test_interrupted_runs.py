"""Runs and their requests after the run's process, or the service, was killed."""

import json
import signal
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_env.files.checked_lines import parse_lines
from argo_planner.service.runs import requests as asked
from argo_planner.service.runs.state import RunMode, RunStatus
from tests.argo_planner.service.served import waiting_messages
from tests.argo_planner.service.test_run_host import (
    ask_and_wait,
    has_ended,
    interrupt,
    open_host,
    order,
    read_record,
    send_signal,
    start_run,
    wait_until,
)

pytestmark = [pytest.mark.long, pytest.mark.anyio]


def damage(folder: Path, run: str) -> None:
    """Change a bit of the last line that is known to be on disk."""
    path = folder / run / "run-0001.journal"
    content = bytearray(path.read_bytes())
    stored = parse_lines(bytes(content))
    content[stored.lines[stored.synced - 1].end - 2] ^= 1
    path.write_bytes(content)


async def test_a_hung_process_delays_no_other_call(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site, speed=1.0, after=0.0)
        send_signal(signal.SIGSTOP)
        accepted: list[str] = []

        async def ask_repeatedly() -> None:
            while True:
                id = f"e{len(accepted)}"
                event = asked.TellEvent(id=id, event="gas_leak", detail="x" * 900)
                await host.send_request(run, event, "ann")
                accepted.append(id)

        with pytest.raises(Unavailable, match="accepts no more messages"):
            await ask_repeatedly()
        with pytest.raises(NotFound):
            host.find_request(run, f"e{len(accepted)}")
        assert [state.id for state in await host.list_runs()] == [run]
        assert (await host.list_entries(run, 0, 1)).entries
        send_signal(signal.SIGCONT)
        await wait_until(lambda: all(host.find_request(run, id).over for id in accepted))
        assert {host.find_request(run, id).progress for id in accepted} == {"confirmed"}
        assert await ask_and_wait(host, asked.PauseRun(id="p")) == "confirmed"


async def test_requests_are_known_after_the_service_was_killed(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        assert await ask_and_wait(host, asked.PauseRun(id="p")) == "confirmed"
        send_signal(signal.SIGSTOP)
        assert (await host.send_request(run, asked.TakeRobot(id="t"), "ann")).progress == "accepted"
    [file] = tmp_path.glob("*/requests")
    with file.open("ab") as opened:
        opened.write(b"00000000 {torn")
    async with open_host(tmp_path) as host:
        run = host.state.id
        known = await host.send_request(run, asked.PauseRun(id="p"), "ann")
        assert known.progress == "confirmed"
        lost = await host.send_request(run, asked.TakeRobot(id="t"), "ann")
        assert lost.progress == "failed"
        assert "the service has ended" in lost.reason
        with pytest.raises(Conflict, match="another request has used the id p"):
            await host.send_request(run, asked.PauseRun(id="p"), "bob")
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        assert host.state.mode is RunMode.PAUSED, "it is still paused"
        assert [(one.id, one.progress) for one in host.state.requests] == [
            ("p", "confirmed"),
            ("t", "failed"),
            ("g", "confirmed"),
        ]
        again = await host.send_request(run, asked.GoOnWithRun(id="g"), "ann")
        assert again.progress == "confirmed"
        assert host.state.mode is RunMode.PAUSED, "a repeated request continues the run only once"
    async with open_host(tmp_path) as host:
        for id, request in (("p", asked.PauseRun(id="p")), ("g", asked.GoOnWithRun(id="g"))):
            again = await host.send_request(host.state.id, request, "ann")
            assert again.progress == "confirmed", id
        assert host.state.status is RunStatus.INTERRUPTED


async def test_a_stored_request_to_stop_is_carried_out_after_a_restart(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        send_signal(signal.SIGSTOP)
        assert (await host.send_request(run, asked.EndRun(id="s"), "ann")).progress == "accepted"
    async with open_host(tmp_path, "go-on") as host:
        await wait_until(has_ended(host))
        await wait_until(lambda: host.find_request(host.state.id, "s").over)
        assert host.find_request(host.state.id, "s").progress == "confirmed"
        assert "stopped by a person" in (await read_record(host)).result.verdict


async def test_an_interrupted_run_accepts_only_requests_to_continue_or_stop(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        await interrupt(host)
        for request in (asked.PauseRun(id="1"), asked.SkipTask(id="2", task="MEASURE 1")):
            with pytest.raises(Conflict, match="only the requests `go_on` and `stop`"):
                await host.send_request(run, request, "ann")
        follower = host.subscribe("1", host.state.entries)
        accepted = await host.send_request(run, asked.EndRun(id="s"), "ann")
        assert accepted.progress == "accepted"
        await wait_until(lambda: host.find_request(run, "s").over)
        assert host.state.status is RunStatus.ENDED
        assert host.state.headline is not None
        steps = [m["request"]["progress"] for m in await waiting_messages(follower, "request")]
        assert steps == ["accepted", "under way", "confirmed"]
        assert "stopped by a person" in (await read_record(host)).result.verdict


async def test_a_run_with_a_damaged_journal_can_be_ended_but_not_continued(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        await interrupt(host)
        damage(tmp_path, run)
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "failed"
        assert "damaged" in host.find_request(run, "g").reason
        assert host.state.status is RunStatus.INTERRUPTED
        assert await ask_and_wait(host, asked.EndRun(id="s")) == "confirmed"
        assert host.state.status is RunStatus.ENDED
        assert "damaged" in host.state.problem
        last = {one.id: one.progress for one in host.state.requests}
        assert last == {"g": "failed", "s": "confirmed"}
        await host.start(order(site), "bob")
        await wait_until(has_ended(host))


async def test_a_process_that_can_not_start_is_reported(tmp_path, site, monkeypatch) -> None:
    def refuse(_: BaseProcess) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    async with open_host(tmp_path) as host:
        await start_run(host, site)
        await interrupt(host)
        with monkeypatch.context() as patched:
            patched.setattr("multiprocessing.process.BaseProcess.start", refuse)
            assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "failed"
            assert host.state.status is RunStatus.INTERRUPTED
            assert await ask_and_wait(host, asked.EndRun(id="s")) == "confirmed"
            assert host.state.status is RunStatus.ENDED
            assert "can't be started: Resource" in host.state.problem
            await host.start(order(site), "bob")
            assert host.state.status is RunStatus.ENDED
        await host.start(order(site), "eve")
        await wait_until(has_ended(host))
        assert host.state.headline is not None


async def test_skipped_tasks_are_known_after_the_process_and_the_service_were_killed(
    tmp_path, site
) -> None:
    measures = [t for t in order(site).mission.tasks if t.action == "MEASURE"]
    first, second = measures[0], measures[1]

    async with open_host(tmp_path) as host:
        await start_run(host, site)
        assert await ask_and_wait(host, asked.TakeRobot(id="t")) == "confirmed"
        assert await ask_and_wait(host, asked.SkipTask(id="1", task=first.name)) == "confirmed"
        assert await ask_and_wait(host, asked.SkipTask(id="2", task=second.name)) == "confirmed"
        await interrupt(host)
        assert await ask_and_wait(host, asked.GoOnWithRun(id="g")) == "confirmed"
        assert host.state.skipped == (first.name, second.name)
    async with open_host(tmp_path) as host:
        assert await ask_and_wait(host, asked.GoOnWithRun(id="h")) == "confirmed"
        assert host.state.skipped == (first.name, second.name)
        assert host.state.mode is RunMode.SUPERVISED
        other = second.model_copy(update={"object_id": first.object_id})
        mission = order(site).mission
        tasks = tuple(other if task.name == second.name else task for task in mission.tasks)
        edited = mission.model_copy(update={"tasks": tasks})
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        request = asked.GoOnEdited(id="e", mission=edited, revision=4)
        assert await ask_and_wait(host, request) == "confirmed"
        assert host.state.revision == 4
        assert host.state.skipped == ()
        await wait_until(has_ended(host))
        counts = {t.task: (t.done, t.by_hand) for t in host.state.tasks}
        assert counts[first.name] == (0, 1)
        assert counts[second.name] == (1, 0), "it is another task with the same name"


async def test_a_run_that_was_killed_before_its_report_names_its_journal(tmp_path, site) -> None:
    async with open_host(tmp_path) as host:
        run = await start_run(host, site)
        with pytest.raises(NotFound, match="it is running"):
            await host.read_report_file(run, "report.html")
        assert await ask_and_wait(host, asked.ChangeSpeed(id="f", speed=None)) == "confirmed"
        await wait_until(has_ended(host))
        await read_record(host)
    [path] = tmp_path.glob("*/run.json")
    as_killed = json.loads(path.read_text())
    del as_killed["checksum"]
    as_killed["state"]["status"] = "running"
    path.write_text(json.dumps(as_killed))
    (path.parent / "report.html").unlink()
    for _ in range(2):
        async with open_host(tmp_path) as host:
            assert host.state.status is RunStatus.ENDED
            assert (await host.list_entries(host.state.id, 0, 5)).count == host.state.entries > 0
            with pytest.raises(NotFound, match=r"argo resume .*run-0001\.journal"):
                await host.read_report_file(host.state.id, "report.html")
