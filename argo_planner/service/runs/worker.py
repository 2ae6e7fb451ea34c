"""The process of a run: opens the site, drives the simulation, keeps its journal."""

import os
import re
import time
from collections.abc import Sequence
from contextlib import ExitStack
from multiprocessing.connection import Connection
from pathlib import Path
from uuid import uuid4

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_compiler.files.atomic_write import write_atomically
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.recording.live import LiveWriter, serve_live
from argo_env.remote.channel import Channel
from argo_env.remote.robot import RemoteRobot
from argo_env.run.drives_and_sensors import ROUTE
from argo_env.run.initial_state import make_machine
from argo_env.run.journal import Header, Journal, create_journal, open_journal
from argo_env.run.log import Entry
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.run_commands import StopRun
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import end_with_parent
from argo_planner.service.runs.driver import RunDriver, RunTeller
from argo_planner.service.runs.pictures import PictureKeeper
from argo_planner.service.runs.pipe import BrokenOff, WorkerPipe
from argo_planner.service.runs.requests import EndRun, RequestState, RunOrder, RunRequest
from argo_planner.service.runs.state import RunState, StateTold
from argo_planner.service.world.obstacles import with_obstacles
from argo_planner.use_cases.reporting import report_files

REMOTE = "remote"
"""the drive of a run that a robot somewhere else carries out"""
SETTLED = 10.0
"""s that it has to acknowledge that the run is over"""
_JOURNAL = re.compile(r"run-(\d{4})\.journal")


def journals(folder: Path) -> list[Path]:
    """The journals of a run in their order: one for each plan that it went on with."""
    return sorted(folder / name for name in os.listdir(folder) if _JOURNAL.fullmatch(name))


def entries_of(folder: Path) -> tuple[Entry, ...]:
    """What has happened in a run whose process has ended, of all its plans. Raises ArgoError if a
    journal can't be read."""
    entries: list[Entry] = []
    for path in journals(folder):
        with open_journal(path) as journal:
            entries += journal.entries
    return tuple(entries)


def carry_out(
    pipe: Connection,
    folder: Path,
    order: RunOrder,
    first: RunState,
    foxglove: int | None = None,
    asked: tuple[RunRequest, str] | None = None,
) -> None:
    """Carries a run out, or goes on with the last journal in its folder. Through the pipe come
    requests with who sends them, and go all that is to be told. At the port `foxglove`, if there is
    one, the run is shown live. The first request, `asked`, came while the run was interrupted."""
    end_with_parent()
    try:
        site = with_obstacles(open_site(order.site).prepare(), order.obstacles)
        with ExitStack() as stack:
            live = None if foxglove is None else stack.enter_context(serve_live(foxglove))
            process = _Segments(WorkerPipe(pipe), folder, order, first, site, live, asked)
            record = process.carry_out()
    except ArgoError as error:
        pipe.send(BrokenOff(problem=str(error)))
        return
    for name, content in report_files(record, site.site, site.robot).items():
        write_atomically(folder / name, content)


class _Segments:
    """A run, one simulation after the other: each time that it goes on with an edited plan, there
    is another one with a journal of its own."""

    def __init__(
        self,
        pipe: WorkerPipe,
        folder: Path,
        order: RunOrder,
        first: RunState,
        site: OpenedSite,
        live: LiveWriter | None,
        asked: tuple[RunRequest, str] | None,
    ) -> None:
        self._pipe = pipe
        self._folder = folder
        self._order = order
        self._state = first
        self._site = site
        self._live = live
        self._asked = asked
        self._teller = RunTeller(first.id, pipe.tell, entries_of(folder))
        self._robot = None if order.drive != REMOTE else self._remote_robot()

    def carry_out(self) -> RunRecord:
        """The record of the last simulation."""
        with ExitStack() as stack:
            driver, simulation = self._begin(self._journal(stack), stack, self._state.requests)
            if self._asked is not None:
                driver.take_up(*self._asked)
            while not driver.over:
                self._pipe.wait(driver.turn())
                for request, by in self._pipe.requests():
                    driver.ask(request, by)
                    if driver.following is not None:
                        driver, simulation = self._exchange(driver, simulation, stack)
            driver.tell_state()
            if self._robot is not None and not self._robot.wait_acknowledged(SETTLED):
                unheard = "the robot has not acknowledged yet that the run is over"
                self._pipe.tell(
                    StateTold(state=driver.state().model_copy(update={"problem": unheard}))
                )
            return simulation.record()

    @property
    def _only_stops(self) -> bool:
        """Whether the run goes on for no other reason than to be stopped: that is done whatever has
        changed, and without the robot."""
        return self._asked is not None and isinstance(self._asked[0], EndRun)

    def _remote_robot(self) -> RemoteRobot | None:
        """None if the run is to stop, and the robot does not tell where it is; else that raises
        Unavailable."""
        channel = Channel(self._pipe, uuid4().hex, time.time)
        navigator = self._site.navigator
        try:
            return RemoteRobot(navigator, channel, self._state.id, time.time, time.sleep)
        except Unavailable as error:
            if not self._only_stops:
                raise
            problem = f"the robot was not told that the run is over: {error}"
            self._state = self._state.model_copy(update={"problem": problem})
            return None

    def _journal(self, stack: ExitStack) -> Journal:
        """The last journal that there is, or a first one."""
        if known := journals(self._folder):
            journal = stack.enter_context(open_journal(known[-1]))
            if not self._only_stops:
                journal.require_unchanged(self._site)
            return journal
        order = self._order
        spec = RunSpec(
            mission=order.mission,
            site=order.site,
            drive=ROUTE if order.drive == REMOTE else order.drive,
            sensor=order.sensor,
            seed=order.seed,
            values=order.values,
            faults=order.faults,
        )
        return self._new_journal(spec, stack)

    def _new_journal(self, spec: RunSpec, stack: ExitStack) -> Journal:
        name = f"run-{len(journals(self._folder)) + 1:04d}.journal"
        journal = create_journal(self._folder / name, Header.from_run(self._site, spec))
        return stack.enter_context(journal)

    def _begin(
        self, journal: Journal, stack: ExitStack, requests: Sequence[RequestState]
    ) -> tuple[RunDriver, Simulation]:
        spec, tell = journal.header.spec, self._pipe.tell
        simulation = Simulation(
            make_machine(spec.mission, spec.beginning),
            self._site,
            spec,
            past=journal.entries,
            observers=[journal, self._teller, *self._viewers(), PictureKeeper(self._folder)],
            robot=self._robot,
        )
        stack.enter_context(simulation)
        driver = RunDriver(simulation, self._state, self._teller, tell, time.monotonic, requests)
        driver.tell_state()
        return driver, simulation

    def _viewers(self) -> list[Observer]:
        if self._live is None:
            return []
        from argo_env.recording.run_recorder import RunRecorder  # brings an extra

        return [RunRecorder(self._live)]

    def _exchange(
        self, driver: RunDriver, simulation: Simulation, stack: ExitStack
    ) -> tuple[RunDriver, Simulation]:
        """Goes on with an edited plan. Its journal is there before the one before ends, so that a
        run that is killed in between goes on with one of them."""
        assert driver.following is not None
        spec, revision = driver.following
        journal = self._new_journal(spec, stack)
        simulation.handle(StopRun("it goes on with an edited plan"))
        simulation.close()
        limit = spec.mission.max_duration
        update = {"revision": revision, "max_duration": limit, "speed": driver.speed, "skipped": ()}
        self._state = self._state.model_copy(update=update)
        following, begun = self._begin(journal, stack, driver.requests)
        following.confirm_following()
        return following, begun
