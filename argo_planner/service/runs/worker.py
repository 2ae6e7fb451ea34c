"""The process of a run, on the side of the worker: site, simulations, journals and the report."""

import os
import re
import time
from collections.abc import Sequence
from contextlib import ExitStack
from multiprocessing.connection import Connection
from pathlib import Path
from uuid import uuid4

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_compiler.base.extensions import naming_packages
from argo_compiler.base.message import Message
from argo_compiler.files.atomic_write import write_atomically
from argo_env.planning.opening import OpenedSite, open_site
from argo_env.recording.live import LiveWriter, serve_live
from argo_env.remote.channel import Channel
from argo_env.remote.robot import RemoteRobot
from argo_env.run.drives_and_sensors import REMOTE, ROUTE
from argo_env.run.initial_state import make_machine
from argo_env.run.journal import Header, Journal, create_journal, open_journal
from argo_env.run.log import Entry
from argo_env.run.observer import Observer
from argo_env.run.record import RunRecord
from argo_env.run.run_commands import StopRun
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from argo_env.worker_processes import ignore_sigint_and_end_with_parent
from argo_planner.service.runs.driver import EntryReporter, RunDriver
from argo_planner.service.runs.pictures import PictureWriter
from argo_planner.service.runs.pipe import WorkerFailed, WorkerPipe
from argo_planner.service.runs.requests import EndRun, RequestState, RunOrder, RunRequest
from argo_planner.service.runs.state import RunState, StateTold
from argo_planner.service.world.obstacles import with_obstacles
from argo_planner.use_cases.reporting import report_files

ACK_TIMEOUT = 10.0
"""s in which a remote robot must acknowledge the end of the run"""
_JOURNAL = re.compile(r"run-(\d{4})\.journal")


def journal_paths(folder: Path) -> list[Path]:
    """Return the paths of a run's journals in order: the first one, then one per edited plan.

    Raises Unavailable if one before the last is missing, or one is a link, which is not followed.
    """
    paths = sorted(folder / name for name in os.listdir(folder) if _JOURNAL.fullmatch(name))
    for number, path in enumerate(paths, 1):
        expected = folder / f"run-{number:04d}.journal"
        if path != expected or os.path.islink(path):
            why = (
                Message("is missing")
                if path != expected
                else Message("is a link, and links are not followed")
            )
            raise Unavailable(
                Message("{expected} {why}: restore it from a copy", expected=expected, why=why)
            )
    return paths


def load_entries(folder: Path) -> tuple[Entry, ...]:
    """Return the log of a run whose process has ended, from all its journals.

    Raises ArgoError if a journal is missing or can't be read.
    """
    entries: list[Entry] = []
    for path in journal_paths(folder):
        with open_journal(path) as journal:
            entries += journal.entries
    return tuple(entries)


def run_worker(
    pipe: Connection,
    folder: Path,
    order: RunOrder,
    first: RunState,
    foxglove: int | None = None,
    first_request: tuple[RunRequest, str] | None = None,
) -> None:
    """Carry out a run, or resume it from the last journal in its folder, and write its report.

    An error that ends the run early is sent as `WorkerFailed`.

    Args:
        pipe: Pipe to the service: it brings requests with their authors, and takes messages.
        folder: Folder of the run.
        order: Order of the run.
        first: State of the run before this process.
        foxglove: Port at which the run is shown live; None: it is not.
        first_request: Request to an interrupted run, with its author; None: there is none.
    """
    ignore_sigint_and_end_with_parent()
    os.umask(0o077)
    try:
        site = with_obstacles(open_site(order.site).prepare(), order.obstacles)
        with naming_packages(), ExitStack() as stack:
            live = None if foxglove is None else stack.enter_context(serve_live(foxglove))
            worker = _RunWorker(WorkerPipe(pipe), folder, order, first, site, live, first_request)
            record = worker.run()
    except ArgoError as error:
        pipe.send(WorkerFailed(problem=str(error)))
        return
    for name, content in report_files(record, site.site, site.robot).items():
        write_atomically(folder / name, content)


class _RunWorker:
    """A run as a series of simulations: each edited plan starts another one, with a new journal."""

    def __init__(
        self,
        pipe: WorkerPipe,
        folder: Path,
        order: RunOrder,
        first: RunState,
        site: OpenedSite,
        live: LiveWriter | None,
        first_request: tuple[RunRequest, str] | None,
    ) -> None:
        self._pipe = pipe
        self._folder = folder
        self._order = order
        self._state = first
        self._site = site
        self._live = live
        self._first_request = first_request
        self._reporter = EntryReporter(first.id, pipe.send_to_service, load_entries(folder))
        self._robot = None if order.drive != REMOTE else self._connect_robot()

    def run(self) -> RunRecord:
        """Carry out the run until its end, and return the record of the last simulation."""
        with ExitStack() as stack:
            journal = self._open_journal(stack)
            driver, simulation = self._begin(journal, stack, self._state.requests)
            if self._first_request is not None:
                driver.handle_resume_or_stop(*self._first_request)
            while not driver.over:
                self._pipe.wait_for_message(driver.step_if_due())
                for request, by in self._pipe.take_requests():
                    driver.handle_request(request, by)
                    if driver.continuation is not None:
                        driver, simulation = self._continue(driver, simulation, stack)
            driver.send_state()
            if self._robot is not None and not self._robot.wait_acknowledged(ACK_TIMEOUT):
                problem = Message("the robot has not acknowledged yet that the run is over")
                state = driver.run_state().model_copy(update={"problem": problem})
                self._pipe.send_to_service(StateTold(state=state))
            return simulation.record()

    @property
    def _only_stops(self) -> bool:
        """True if an interrupted run is resumed only to stop it.

        It is then stopped even if the site has changed or the robot is not connected.
        """
        return self._first_request is not None and isinstance(self._first_request[0], EndRun)

    def _connect_robot(self) -> RemoteRobot | None:
        """Return the remote robot, after its first pose; for runs with a remote robot only.

        If the robot sends no pose in time, return None if the run only stops, else raise
        Unavailable.
        """
        channel = Channel(self._pipe, uuid4().hex, time.time)
        navigator = self._site.navigator
        try:
            return RemoteRobot(navigator, channel, self._state.id, time.time, time.sleep)
        except Unavailable as error:
            if not self._only_stops:
                raise
            problem = Message("the robot was not told that the run is over: {error}", error=error)
            self._state = self._state.model_copy(update={"problem": problem})
            return None

    def _open_journal(self, stack: ExitStack) -> Journal:
        """Open the last journal of the run, or create the first one."""
        if paths := journal_paths(self._folder):
            journal = stack.enter_context(open_journal(paths[-1]))
            if not self._only_stops:
                journal.require_inputs_unchanged(self._site)
            if journal.loss:
                self._state = self._state.model_copy(update={"problem": journal.loss})
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
        return self._create_journal(spec, stack)

    def _create_journal(self, spec: RunSpec, stack: ExitStack) -> Journal:
        name = f"run-{len(journal_paths(self._folder)) + 1:04d}.journal"
        journal = create_journal(self._folder / name, Header.from_run(self._site, spec))
        return stack.enter_context(journal)

    def _begin(
        self, journal: Journal, stack: ExitStack, requests: Sequence[RequestState]
    ) -> tuple[RunDriver, Simulation]:
        spec, send = journal.header.spec, self._pipe.send_to_service
        simulation = Simulation(
            make_machine(spec.mission, spec.beginning),
            self._site,
            spec,
            past=journal.entries,
            observers=[journal, self._reporter, *self._viewers(), PictureWriter(self._folder)],
            robot=self._robot,
        )
        stack.enter_context(simulation)
        driver = RunDriver(simulation, self._state, self._reporter, send, time.monotonic, requests)
        driver.send_state()
        return driver, simulation

    def _viewers(self) -> list[Observer]:
        if self._live is None:
            return []
        from argo_env.recording.run_recorder import RunRecorder  # needs an extra

        return [RunRecorder(self._live)]

    def _continue(
        self, driver: RunDriver, simulation: Simulation, stack: ExitStack
    ) -> tuple[RunDriver, Simulation]:
        """End the simulation and continue with the edited plan in a new one.

        The new journal is created before the old one ends, so that a run that is killed in between
        can be resumed from one of them.
        """
        assert driver.continuation is not None
        spec, revision = driver.continuation
        journal = self._create_journal(spec, stack)
        simulation.handle(StopRun(Message("it continues with an edited plan")))
        simulation.close()
        limit = spec.mission.max_duration
        update = {"revision": revision, "max_duration": limit, "speed": driver.speed, "skipped": ()}
        self._state = self._state.model_copy(update=update)
        new_driver, new_simulation = self._begin(journal, stack, driver.pending_and_latest_requests)
        new_driver.confirm_requests_to_continue()
        return new_driver, new_simulation
