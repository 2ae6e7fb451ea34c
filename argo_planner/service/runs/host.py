"""The runs of the service's robot: starting, resuming, requests and followers."""

import asyncio
import logging
import secrets
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_env.run.log import Entry
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.runs.current_run import CurrentRun
from argo_planner.service.runs.folder import DiskThread, RunFolder, StoredRun
from argo_planner.service.runs.pipe import RobotText, WorkerFailed
from argo_planner.service.runs.process import RunProcess
from argo_planner.service.runs.requests import (
    EndRun,
    GoOnWithRun,
    RequestProgress,
    RequestState,
    RunOrder,
    RunRequest,
    request_subject,
)
from argo_planner.service.runs.state import (
    EntryList,
    LatestRuns,
    RequestTold,
    RunState,
    RunStatus,
    RunSummary,
    StateTold,
)

_log = logging.getLogger(__name__)
_REPORT_ATTEMPTS = 50
"""number of times that a report which is being written is looked for"""
_REPORT_PAUSE = 0.2
"""s between these attempts"""
STOP_TIMEOUT = 30.0
"""s after which a process that carries out no stop is killed, and another one stops the run"""
REPORT_TIMEOUT = 300.0
"""s after which a process that only stops a run or writes its report is killed"""


class AfterRestart(StrEnum):
    """Handling of a run that was under way when the service was killed."""

    GO_ON = "go-on"
    """the run is resumed"""
    WAIT = "wait"
    """the run waits until a person resumes or stops it"""


class RobotConnection:
    """Connection to the remote robot, if one is connected, with the messages that wait for it."""

    def __init__(self) -> None:
        self._mailbox: Mailbox | None = None

    def replace_connection(self) -> Mailbox:
        """Begin a new connection, close an earlier one, and return the mailbox of the new one."""
        self.close(Message("the robot has connected again"))
        self._mailbox = Mailbox()
        return self._mailbox

    def has_mailbox(self, mailbox: Mailbox) -> bool:
        """Return True if this is the mailbox of the present connection."""
        return mailbox is self._mailbox

    def queue_if_connected(self, message: str) -> None:
        """Queue a message for the robot; it is dropped if no robot is connected."""
        if self._mailbox is not None:
            self._mailbox.post(message)

    def disconnect(self, mailbox: Mailbox) -> None:
        """End the present connection, if this is its mailbox."""
        if mailbox is self._mailbox:
            self._mailbox = None

    def close(self, why: str) -> None:
        """Close the mailbox of the present connection; `why` is the reason that is sent."""
        if self._mailbox is not None:
            self._mailbox.close(MailboxClosed(why))


class RunHost:
    """The runs of the service's robot, the current run's process, and the robot's connection."""

    def __init__(
        self,
        folder: Path,
        after_restart: AfterRestart,
        clock: Callable[[], datetime],
        foxglove: int | None = None,
    ) -> None:
        """Create the host; `open` must be called before anything else.

        Args:
            folder: Folder of all runs.
            after_restart: Handling of a run that was under way when the service was killed.
            clock: Function that returns the time at which a run starts.
            foxglove: Port of this machine at which runs are shown live; None: they are not.
        """
        self._folder = RunFolder(folder)
        self._disk = DiskThread()
        self._after_restart = after_restart
        self._clock = clock
        self._foxglove = foxglove
        self._current = CurrentRun(self._folder, self._disk)
        self._worker: RunProcess | None = None
        """process of the current run; None: it has none"""
        self._workers: set[RunProcess] = set()
        """this process, and those that are still writing the report of an earlier run"""
        self._timers: dict[RunProcess, asyncio.TimerHandle] = {}
        """for the processes that are killed if they do not end in time"""
        self._lock = asyncio.Lock()
        """held while the current run is started, gets a request or messages, or loses its process

        Requests are thus stored and passed on in the order in which they come, and the end of one
        run is not taken for the end of the next one.
        """
        self.robot = RobotConnection()
        self._last_log: tuple[str, tuple[Entry, ...]] | None = None
        """id and log of the earlier run that was read last, as clients read a log in parts"""

    @property
    def state(self) -> RunState | None:
        """State of the current run; None: no run was ever started."""
        return self._current.state

    @property
    def folder(self) -> RunFolder:
        """Folder of the runs on disk."""
        return self._folder

    async def open(self) -> None:
        """Load the newest run, if there is one.

        If it had not ended, it is stopped if a person had requested to stop it. Otherwise it is
        resumed, or waits for a person, as `after_restart` states.
        """
        async with self._lock:
            runs = await self._disk.run(self._folder.load_runs_newest_first)
            if not runs:
                return
            current, last = self._current, runs[0]
            file = self._folder.request_file(last.state.id)
            try:
                requests = await self._disk.run(file.load_requests)
            except ArgoError as error:
                _log.error("%s; the requests to run %s are not known", error, last.state.id)
                requests = []
            current.replace_run_silently(last, requests)
            await self._handle_loss(Message("the service has ended during the run"), may_stop=True)
            if self._after_restart is AfterRestart.GO_ON and (
                current.stored.state.status is RunStatus.INTERRUPTED
            ):
                await self._start_process()

    async def start(self, order: RunOrder, by: str) -> RunState:
        """Start a run, and return its state while its process is starting.

        Raises Conflict, which names the author of the current run, if that is not over yet;
        Unavailable if the run can't be stored.
        """
        async with self._lock:
            state = self.state
            if state is not None and state.status is not RunStatus.ENDED:
                raise Conflict(
                    Message(
                        "{by} has begun run {id} of '{state}' at {begun} UTC, and it is "
                        "{status}: wait until it ends, or stop it",
                        by=state.by,
                        id=state.id,
                        state=state.name,
                        begun=f"{state.begun:%H:%M:%S}",
                        status=state.status,
                    )
                )
            now = self._clock()
            first = RunState(
                id=f"{now:%Y%m%d-%H%M%S}-{secrets.token_hex(2)}",
                plan=order.plan,
                revision=order.revision,
                name=order.name,
                by=by,
                begun=now,
                status=RunStatus.PREPARING,
                drive=order.drive,
                sensor=order.sensor,
                seed=order.seed,
                speed=order.speed,
                max_duration=order.mission.max_duration,
            )
            stored = StoredRun(order=order, state=first)
            await self._disk.run(self._folder.create_run, stored)
            self._worker = None  # the process of the earlier run sends nothing that matters now
            self._current.replace_run_silently(stored)
            await self._start_process()
            return first

    async def send_request(self, run: str, request: RunRequest, by: str) -> RequestState:
        """Store a request and pass it on to the run; return its state.

        Followers get the further states of the request. A request that is sent again has no further
        effect: its present state is returned.

        Raises:
            NotFound: The run is not the current one.
            Conflict: The run is over or can't take this request now, or another request has its id.
            Unavailable: The request can't be stored, or too many messages wait for the process.
        """
        async with self._lock:
            state, worker = self._current.require_run(run), self._worker
            if (known := self._current.book.find_repeated(request, by)) is not None:
                return known
            if state.status is RunStatus.ENDED:
                raise Conflict(Message("run {run} is over", run=run))
            interrupted = state.status is RunStatus.INTERRUPTED
            if interrupted and not isinstance(request, GoOnWithRun | EndRun):
                raise Conflict(
                    Message(
                        "run {run} is interrupted ({problem}): only the requests `go_on` and "
                        "`stop` are possible",
                        run=run,
                        problem=state.problem,
                    )
                )
            if worker is not None:
                worker.require_queue_space()
            elif not interrupted:
                raise Conflict(
                    Message(
                        "run {run} is {status}: try again in a moment", run=run, status=state.status
                    )
                )
            accepted = RequestState(
                id=request.id,
                kind=request.kind,
                by=by,
                subject=request_subject(request),
                progress=RequestProgress.ACCEPTED,
            )
            await self._current.accept_request(accepted)
            if interrupted:
                await self._start_process((request, by))
            elif worker is not None:
                worker.send((request, by))
                if request.kind == "stop":
                    self._kill_after(worker, STOP_TIMEOUT)
            return accepted

    def find_request(self, run: str, id: str) -> RequestState:
        """Return the state of a request to the current run.

        Raises NotFound if the run is not the current one, or has no such request.
        """
        self._current.require_run(run)
        return self._current.book.find(id)

    def require_current(self, run: str) -> RunState:
        """Return the state of the run `run`; raises NotFound unless it is the current run."""
        return self._current.require_run(run)

    # ---- states, logs and reports

    async def list_runs(self) -> list[RunState]:
        """Return the states of all runs, the newest first."""
        runs = [run.state for run in await self._disk.run(self._folder.load_runs_newest_first)]
        state = self.state
        return runs if state is None else [state, *(run for run in runs if run.id != state.id)]

    async def list_latest(self, most: int) -> LatestRuns:
        """Return the `most` newest runs of all missions, and the last run of each mission."""
        runs = await self._disk.run(self._folder.list_summaries)
        if (state := self.state) is not None:  # newer than on disk
            runs = [RunSummary.from_state(state), *(run for run in runs if run.id != state.id)]
        last: dict[str, RunSummary] = {}
        for run in runs:
            last.setdefault(run.plan, run)
        return LatestRuns(latest=tuple(runs[:most]), by_mission=tuple(last.values()))

    async def read_state(self, run: str) -> RunState:
        """Return the state of the current or an earlier run; raises NotFound if there is none."""
        if self._is_current(run):
            return self._current.stored.state
        return (await self._disk.run(self._folder.load_run, run)).state

    async def list_entries(self, run: str, after_first: int, most: int) -> EntryList:
        """Return at most `most` entries of a run's log after the first `after_first` ones.

        Raises NotFound if there is no such run, ArgoError if a journal of an earlier run can't be
        read.
        """
        if self._is_current(run) and (
            self._current.entry_count or self._current.stored.state.status is not RunStatus.ENDED
        ):
            return self._current.list_entries(after_first, most)
        if self._last_log is None or self._last_log[0] != run:
            self._last_log = run, await self._disk.run(self._folder.load_entries, run)
        entries = self._last_log[1]
        return EntryList(count=len(entries), entries=entries[after_first : after_first + most])

    async def read_report_file(self, run: str, file: str) -> bytes:
        """Return the content of a file of a run's report; wait if the report is being written.

        Raises NotFound, with the reason and a remedy, if there is no such file or the report is
        not written within 10 s.
        """
        for _ in range(_REPORT_ATTEMPTS):
            content = await self._disk.run(self._folder.read_report_file, run, file)
            if content is not None:
                return content
            is_writing = any(worker.run == run for worker in self._workers)
            if not is_writing or (await self.read_state(run)).status is not RunStatus.ENDED:
                break
            await asyncio.sleep(_REPORT_PAUSE)
        journal = await self._disk.run(self._folder.last_journal, run)
        raise _missing_report_error(await self.read_state(run), file, journal, is_writing)

    def subscribe(self, client: str, skip_first: int | None = None) -> Mailbox:
        """Add a follower of the robot's runs with the id `client`, and return its mailbox.

        The mailbox gets the state of the current run, its entries without the first `skip_first`
        ones (None: all entries), then all further messages.
        """
        return self._current.subscribe(client, skip_first)

    def unsubscribe(self, client: str) -> None:
        """Remove the follower with this id, if there is one."""
        self._current.unsubscribe(client)

    def receive_from_robot(self, mailbox: Mailbox, message: str) -> None:
        """Pass a message of the remote robot on to the run's process.

        It is dropped if the run has no process, the process has many messages to read, or the robot
        has meanwhile connected again, so that `mailbox` is not that of its present connection.
        """
        if self._worker is not None and self.robot.has_mailbox(mailbox):
            self._worker.queue_unless_half_full(message)

    async def close(self) -> None:
        """Kill all processes and end all connections; the run can be resumed from its journal."""
        async with self._lock:
            self._worker = None
        while self._workers:
            await asyncio.to_thread(next(iter(self._workers)).kill_and_wait)
        await asyncio.to_thread(self._disk.close)
        self._current.close(Message("the service ends"))
        self.robot.close(Message("the service ends"))

    def _is_current(self, run: str) -> bool:
        return self.state is not None and self.state.id == run

    # ---- the process

    async def _start_process(self, request: tuple[RunRequest, str] | None = None) -> None:
        """Start the process of the current run, which resumes from its journal if there is one.

        `request` came while the run was interrupted, with its author.
        """
        order, state = self._current.stored.order, self._current.stored.state
        requests = self._current.book.pending_and_latest()
        update = {"status": RunStatus.PREPARING, "problem": None, "requests": requests}
        first = state.model_copy(update=update)
        await self._current.apply_messages([StateTold(state=first)])
        path = self._folder.run_path(first.id)
        loop = asyncio.get_running_loop()
        arguments = path, order, first, self._foxglove, request
        try:
            worker = await asyncio.to_thread(RunProcess, *arguments)
        except OSError as error:
            problem = Message("its process can't be started: {reason}", reason=reason_text(error))
            await self._handle_loss(problem, may_stop=False)
            return
        self._worker = worker
        self._workers.add(worker)
        if worker.for_stop:
            self._kill_after(worker, REPORT_TIMEOUT)
        worker.start_reading(
            lambda messages: asyncio.run_coroutine_threadsafe(
                self._handle_messages(worker, messages), loop
            ).result(),
            lambda: asyncio.run_coroutine_threadsafe(self._handle_exit(worker), loop).result(),
        )

    async def _handle_messages(self, worker: RunProcess, messages: Sequence[Model]) -> None:
        """Apply messages of a process; of an earlier run's process, only set `worker.problem`."""
        for message in messages:
            match message:
                case WorkerFailed(problem=problem):
                    worker.problem = problem
                case RobotText(text=text) if worker is self._worker:
                    self.robot.queue_if_connected(text)
        async with self._lock:
            if worker is self._worker:
                await self._current.apply_messages(messages)
                if self._current.stored.state.status is RunStatus.ENDED:
                    self._kill_after(worker, REPORT_TIMEOUT)

    def _kill_after(self, worker: RunProcess, delay: float) -> None:
        """Kill a process after `delay` s, unless it ends before; replaces an earlier time."""
        if worker in self._timers:
            self._timers[worker].cancel()
        loop = asyncio.get_running_loop()
        self._timers[worker] = loop.call_later(delay, worker.kill)

    async def _handle_exit(self, worker: RunProcess) -> None:
        """Handle the end of a process, with the run or before the run's end."""
        try:
            async with self._lock:
                if worker is self._worker:
                    self._worker = None
                    problem = worker.problem or Message(
                        "its process has ended ({exit_reason})", exit_reason=worker.exit_reason()
                    )
                    await self._handle_loss(problem, may_stop=not worker.for_stop)
        finally:
            self._workers.discard(worker)
            if (timer := self._timers.pop(worker, None)) is not None:
                timer.cancel()

    async def _handle_loss(self, problem: str, may_stop: bool) -> None:
        """Set and publish the state of the current run after its process is gone.

        `_settle_loss` computes this state. If a person has asked for the run to stop, and
        `may_stop` is True, another process is started that stops it.
        """
        current, ended = self._current, False
        run = current.stored.state.id
        damage = None
        try:
            await current.load_missing_entries()
            ended = await self._disk.run(self._folder.has_ended, run)
        except ArgoError as error:
            damage = str(error)
            if str(error) not in problem:
                problem = f"{problem}; {error}"
        loss = _settle_loss(
            current.stored.state,
            current.book.pending,
            problem,
            begun=damage is not None or current.entry_count > 0,
            ended=ended,
            may_stop=may_stop,
        )
        requests = current.book.pending_and_latest(loss.settled)
        update = {"requests": requests, "problem": loss.state.problem or damage}
        state = loss.state.model_copy(update=update)
        settled = [RequestTold(run=run, request=request) for request in loss.settled]
        await current.apply_messages([StateTold(state=state), *settled])
        if loss.stop is not None:
            await self._start_process((EndRun(id=loss.stop.id), loss.stop.by))


@dataclass(frozen=True)
class _LossOutcome:
    """The state of a run after the loss of its process."""

    state: RunState
    settled: tuple[RequestState, ...]
    """requests that are over"""
    stop: RequestState | None
    """request to stop the run that another process is to carry out; None: there is none"""


def _settle_loss(
    state: RunState,
    pending: Sequence[RequestState],
    problem: str,
    *,
    begun: bool,
    ended: bool,
    may_stop: bool,
) -> _LossOutcome:
    """Return the state of a run after the loss of its process, and the requests settled by that.

    Args:
        state: State of the run before.
        pending: Requests that are not over.
        problem: Why the process is gone.
        begun: Whether the journals have an entry, or can't be read.
        ended: Whether the run has ended, by its journals.
        may_stop: Whether another process may be started to stop the run, as none has tried yet.
    """
    stop = next((request for request in pending if request.kind == "stop"), None)
    if ended or state.status is RunStatus.ENDED:
        status, why = RunStatus.ENDED, state.problem
    elif not begun or (stop is not None and not may_stop):
        status, why = RunStatus.ENDED, problem
    else:
        status, why = RunStatus.INTERRUPTED, problem
    over = status is RunStatus.ENDED
    settled = []
    for request in pending:
        if request.kind == "stop" and over:
            outcome = {"progress": RequestProgress.CONFIRMED, "reason": why}
        else:
            outcome = {
                "progress": RequestProgress.FAILED,
                "reason": why or Message("the run ended first"),
            }
        if over or request is not stop:
            settled.append(request.model_copy(update=outcome))
    update = {"status": status, "problem": why, "moving": False, "task": None, "by_hand": False}
    return _LossOutcome(state.model_copy(update=update), tuple(settled), None if over else stop)


def _missing_report_error(
    state: RunState, file: str, journal: Path | None, is_writing: bool
) -> NotFound:
    """Return the error for a report file that does not exist, with the reason and a way out.

    `journal` is the last one of the run; `is_writing` is True if the run's process still exists.
    """
    entries = Message("its log is in /api/runs/{id}/entries", id=state.id)
    if state.status is not RunStatus.ENDED:
        why = Message(
            "it is {status}, and the report is written when it has ended; {entries}",
            status=state.status,
            entries=entries,
        )
    elif is_writing:
        why = Message("it has just ended, and the report is being written: try again in a moment")
    elif journal is None or state.entries == 0:
        why = Message(
            "it ended before anything had happened ({problem}): start another run",
            problem=state.problem,
        )
    else:
        why = Message(
            "its process ended before the report was written, or the report was "
            "deleted; {entries}, and `argo resume {journal} --report FOLDER`, on the "
            "machine of the service, writes the report",
            entries=entries,
            journal=journal,
        )
    return NotFound(Message("run {id} has no {file}: {why}", id=state.id, file=file, why=why))
