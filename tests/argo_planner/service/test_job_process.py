"""Jobs in separate processes: started without blocking, and ended at any time."""

import asyncio
import errno
import threading
from collections.abc import Callable, Coroutine
from importlib.util import find_spec

import pytest

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.limited_process import CallLimits
from argo_compiler.il import Mission
from argo_env.planning.opening import OpenedSite
from argo_env.worker_processes import NEEDED_TO_DRIVE
from argo_planner.service.jobs.analysis import AnalysisFound, Analyst
from argo_planner.service.processes.context import CONTEXT, LOADED
from argo_planner.service.processes.job_process import JobProcess, ReportProgress


def double(number: int, report: ReportProgress) -> int:
    report("half of it")
    return 2 * number


def never(_: ReportProgress) -> None:
    threading.Event().wait()


@pytest.fixture
def slow_start(monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """Event that must be set before any process starts."""
    may_start, start = threading.Event(), CONTEXT.Process.start

    def wait_and_start(process: object) -> None:
        assert may_start.wait(30)
        start(process)  # type: ignore[arg-type]

    monkeypatch.setattr(CONTEXT.Process, "start", wait_and_start)
    return may_start


@pytest.fixture
def no_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """No process can start."""

    def refuse(_: object) -> None:
        raise ChildProcessError(errno.ECHILD, "too little memory")

    monkeypatch.setattr(CONTEXT.Process, "start", refuse)


async def ticks(times: int) -> int:
    for _ in range(times):
        await asyncio.sleep(0.01)
    return times


def test_work_returns_its_result_and_reports_progress() -> None:
    progress: list[str] = []
    assert asyncio.run(JobProcess[int](double, 21).start_and_wait(progress.append)) == 42
    assert progress == ["half of it"]


async def work(_: OpenedSite) -> object:
    return await JobProcess[int](double, 21).start_and_wait(lambda _: None)


async def analysis(site: OpenedSite) -> AnalysisFound:
    analyst = Analyst(site)
    try:
        return await analyst.analyse_revision(Mission(tasks=()), 1)
    finally:
        analyst.close()


@pytest.mark.parametrize("begin", [work, analysis])
def test_nothing_else_waits_while_a_process_starts(
    begin: Callable[[OpenedSite], Coroutine[None, None, object]],
    site: OpenedSite,
    slow_start: threading.Event,
) -> None:
    async def check() -> None:
        task = asyncio.ensure_future(begin(site))
        assert await ticks(10) == 10
        assert not task.done()
        slow_start.set()
        assert await task

    asyncio.run(check())


def test_work_is_ended_while_it_starts_and_while_it_runs(slow_start: threading.Event) -> None:
    async def end(at_once: bool) -> None:
        endless = JobProcess[None](never)
        task = asyncio.ensure_future(endless.start_and_wait(lambda _: None))
        await ticks(2)
        if not at_once:
            slow_start.set()
            await ticks(20)
        task.cancel()
        ending = asyncio.ensure_future(endless.end())
        await ticks(2)
        slow_start.set()
        await ending
        assert endless._process.exitcode is not None

    for at_once in (True, False):
        slow_start.clear()
        asyncio.run(end(at_once))


def report_and_wait(report: ReportProgress) -> None:
    report("started")
    threading.Event().wait()


def test_work_with_limits_that_is_ended_has_not_exceeded_them() -> None:
    async def end() -> None:
        endless = JobProcess[None](report_and_wait, limits=CallLimits(60.0, 400_000_000))
        started = asyncio.Event()
        task = asyncio.ensure_future(endless.start_and_wait(lambda _: started.set()))
        await started.wait()
        await endless.end()
        with pytest.raises(Unavailable, match="the process of this job has died"):
            await task

    asyncio.run(end())


def test_work_that_nobody_awaits_is_ended_before_it_has_started() -> None:
    endless = JobProcess[None](never)
    asyncio.run(endless.end())
    assert endless._process.pid is None


@pytest.mark.usefixtures("no_start")
def test_a_process_that_can_not_start_is_reported(site: OpenedSite) -> None:
    with pytest.raises(Unavailable, match="can't start: too little memory; try again"):
        asyncio.run(work(site))
    assert (
        asyncio.run(analysis(site)).problem == "the analysis process can't start: too little memory"
    )


def test_missions_are_analysed_again_after_their_process_is_killed(site: OpenedSite) -> None:
    async def killed() -> None:
        analyst = Analyst(site)
        try:
            first = await analyst.analyse_revision(Mission(tasks=()), 1)
            (process,) = analyst._pool._processes.values()
            process.kill()
            together = (analyst.analyse_revision(Mission(tasks=()), 1) for _ in range(5))
            assert await asyncio.gather(*together) == [first] * 5
        finally:
            analyst.close()

    asyncio.run(killed())


def test_missions_sent_while_the_process_dies_are_analysed_again(site: OpenedSite) -> None:
    async def killed() -> None:
        analyst = Analyst(site)
        try:
            first = await analyst.analyse_revision(Mission(tasks=()), 1)
            for milliseconds in range(5):
                (process,) = analyst._pool._processes.values()
                process.kill()
                for _ in range(3):
                    await asyncio.sleep(milliseconds / 1000)
                    assert await analyst.analyse_revision(Mission(tasks=()), 1) == first
        finally:
            analyst.close()

    asyncio.run(asyncio.wait_for(killed(), 60))


@pytest.mark.parametrize("module", [*LOADED, *NEEDED_TO_DRIVE])
def test_the_modules_that_processes_load_exist(module: str) -> None:
    """A wrong name would raise no error: processes would only start more slowly."""
    assert find_spec(module)
