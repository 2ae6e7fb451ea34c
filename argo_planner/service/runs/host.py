"""The one run of the service's robot: begun, asked, followed, gone on with."""

import asyncio
import secrets
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, NotFound
from argo_compiler.base.model import Model
from argo_env.run.log import Entry
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.runs.folder import DiskThread, KeptRun, RunFolder
from argo_planner.service.runs.pipe import BrokenOff, RobotText
from argo_planner.service.runs.present import PresentRun
from argo_planner.service.runs.process import RunProcess
from argo_planner.service.runs.requests import (
    EndRun,
    GoOnWithRun,
    RequestProgress,
    RequestState,
    RunOrder,
    RunRequest,
)
from argo_planner.service.runs.state import EntryList, RequestTold, RunState, RunStatus, StateTold

_REPORT_LOOKS = 50
_REPORT_PAUSE = 0.2
"""s between looks whether a report is there"""


class AfterRestart(StrEnum):
    """What becomes of a run that was under way when the service was killed."""

    GO_ON = "go-on"
    WAIT = "wait"
    """for a person, who asks for it to go on"""


class RobotLine:
    """The connection of the robot, if there is one. Holds the texts that wait for it."""

    def __init__(self) -> None:
        self._mailbox: Mailbox | None = None

    def connect(self) -> Mailbox:
        """A robot has connected: the texts for it. One that was connected before is let go."""
        self.close("the robot has connected again")
        self._mailbox = Mailbox()
        return self._mailbox

    def is_that_of(self, mailbox: Mailbox) -> bool:
        """Whether it is still the connection that came with these texts."""
        return mailbox is self._mailbox

    def post(self, text: str) -> None:
        """A text for the robot, which nobody hears while it is not connected."""
        if self._mailbox is not None:
            self._mailbox.post(text)

    def disconnect(self, mailbox: Mailbox) -> None:
        """A connection has ended."""
        if mailbox is self._mailbox:
            self._mailbox = None

    def close(self, why: str) -> None:
        """Lets the robot go."""
        if self._mailbox is not None:
            self._mailbox.close(MailboxClosed(why))


class RunHost:
    """The run of the service's robot. Holds its process, and the line to a robot elsewhere."""

    def __init__(
        self,
        folder: Path,
        after_restart: AfterRestart,
        clock: Callable[[], datetime],
        foxglove: int | None = None,
    ) -> None:
        """`foxglove`: the port at which runs are shown live on this machine; None: they are not."""
        self._folder = RunFolder(folder)
        self._disk = DiskThread()
        self._after_restart = after_restart
        self._clock = clock
        self._foxglove = foxglove
        self._present = PresentRun(self._folder, self._disk)
        self._worker: RunProcess | None = None
        self._workers: set[RunProcess] = set()
        """this one, and those that still write the report of a run before"""
        self._turn = asyncio.Lock()
        """held while the present run is begun, asked, heard or lost, so that requests are kept and
        passed on in the order in which they come, and the end of one run is not taken for that of
        the next"""
        self.robot = RobotLine()
        self._read: tuple[str, tuple[Entry, ...]] | None = None
        """a run before that was read last, with its entries: who looks at it reads it in parts"""

    @property
    def state(self) -> RunState | None:
        """How the last run stands; None: there was none."""
        return self._present.state

    @property
    def folder(self) -> RunFolder:
        """The runs on disk."""
        return self._folder

    async def open(self) -> None:
        """Finds the last run. One that had not ended goes on, or waits for a person."""
        async with self._turn:
            runs = await self._disk.do(self._folder.all)
            if not runs:
                return
            present, found = self._present, runs[0]
            requests = self._folder.requests(found.state.id)
            present.become(found, await self._disk.do(requests.all))
            await self._lose("the service has ended while it was under way", may_stop=True)
            if self._after_restart is AfterRestart.GO_ON and (
                present.kept.state.status is RunStatus.INTERRUPTED
            ):
                await self._begin()

    async def start(self, order: RunOrder, by: str) -> RunState:
        """Begins a run. Raises Conflict, with who holds the robot, if one is not over yet."""
        async with self._turn:
            state = self.state
            if state is not None and state.status is not RunStatus.ENDED:
                raise Conflict(
                    f"{state.by} has begun run {state.id} of '{state.name}' at "
                    f"{state.begun:%H:%M:%S} UTC, and it is {state.status}: wait for its end, or "
                    "stop it"
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
            kept = KeptRun(order=order, state=first)
            await self._disk.do(self._folder.make, kept)
            self._worker = None  # that of the run before tells nothing any more
            self._present.become(kept)
            await self._begin()
            return first

    async def ask(self, run: str, request: RunRequest, by: str) -> RequestState:
        """Passes a request on, once it is kept; sent again it does nothing twice. What comes of it
        is told.

        Raises NotFound if the run is another one, Conflict if it is over or can't be asked that
        now, Unavailable if the request can't be kept, or the process takes nothing.
        """
        async with self._turn:
            state, worker = self._present.of(run), self._worker
            if (known := self._present.book.known(request, by)) is not None:
                return known
            if state.status is RunStatus.ENDED:
                raise Conflict(f"run {run} is over")
            interrupted = state.status is RunStatus.INTERRUPTED
            if interrupted and not isinstance(request, GoOnWithRun | EndRun):
                raise Conflict(
                    f"run {run} is interrupted ({state.problem}): it can be asked for `go_on` or "
                    "`stop` only"
                )
            if worker is not None:
                worker.require_room()
            elif not interrupted:
                raise Conflict(f"run {run} is {state.status}: ask again in a moment")
            accepted = RequestState(
                id=request.id, kind=request.kind, by=by, progress=RequestProgress.ACCEPTED
            )
            await self._present.accept(accepted)
            if interrupted:
                await self._begin((request, by))
            elif worker is not None:
                worker.send((request, by))
            return accepted

    def request(self, run: str, id: str) -> RequestState:
        """How far a request is. Raises NotFound."""
        self._present.of(run)
        return self._present.book.of(id)

    def of(self, run: str) -> RunState:
        """How the present run stands. Raises NotFound if that is another one."""
        return self._present.of(run)

    # ---- looking

    async def all(self) -> list[RunState]:
        """The present run, and those before it."""
        runs = [kept.state for kept in await self._disk.do(self._folder.all)]
        state = self.state
        return runs if state is None else [state, *(one for one in runs if one.id != state.id)]

    async def read(self, run: str) -> RunState:
        """How a run stands, or how it ended. Raises NotFound."""
        if self._is_present(run):
            return self._present.kept.state
        return (await self._disk.do(self._folder.kept, run)).state

    async def history(self, run: str, since: int, most: int) -> EntryList:
        """What has happened in a run after the first `since` entries. Raises NotFound."""
        if self._is_present(run):
            return self._present.entries(since, most)
        if self._read is None or self._read[0] != run:
            self._read = run, await self._disk.do(self._folder.entries, run)
        entries = self._read[1]
        return EntryList(count=len(entries), entries=entries[since : since + most])

    async def report(self, run: str, file: str) -> bytes:
        """A file of the report of a run; of one that has just ended, once it is made. Raises
        NotFound, with why it is not there and what there is instead."""
        for _ in range(_REPORT_LOOKS):
            if (content := await self._disk.do(self._folder.report, run, file)) is not None:
                return content
            making = any(worker.run == run for worker in self._workers)
            if not making or (await self.read(run)).status is not RunStatus.ENDED:
                break
            await asyncio.sleep(_REPORT_PAUSE)
        journal = await self._disk.do(self._folder.last_journal, run)
        raise _missing_report(await self.read(run), file, journal, making)

    def follow(self, client: str, since: int | None = None) -> Mailbox:
        """Somebody follows the robot's runs: first how it stands, then the entries after that
        number of the present run, then all that happens."""
        return self._present.follow(client, since)

    def leave(self, client: str) -> None:
        """Somebody has gone."""
        self._present.leave(client)

    def hear_robot(self, line: Mailbox, text: str) -> None:
        """The robot on that line tells something. While no run is under way nobody hears it."""
        if self._worker is not None and self.robot.is_that_of(line):
            self._worker.send_text(text)

    async def close(self) -> None:
        """Ends the process; the journal stays, and the run can go on from it."""
        async with self._turn:
            self._worker = None
        while self._workers:
            await asyncio.to_thread(next(iter(self._workers)).end)
        await asyncio.to_thread(self._disk.close)
        self._present.close("the service ends")
        self.robot.close("the service ends")

    def _is_present(self, run: str) -> bool:
        return self.state is not None and self.state.id == run

    # ---- the process

    async def _begin(self, asked: tuple[RunRequest, str] | None = None) -> None:
        """Begins the process of the run, which goes on from its journal if there is one. It is told
        what was `asked` for while the run was interrupted."""
        order, state = self._present.kept.order, self._present.kept.state
        requests = self._present.book.told()
        update = {"status": RunStatus.PREPARING, "problem": None, "requests": requests}
        first = state.model_copy(update=update)
        await self._present.take([StateTold(state=first)])
        path = self._folder.path(first.id)
        loop = asyncio.get_running_loop()
        try:
            worker = await asyncio.to_thread(RunProcess, path, order, first, self._foxglove, asked)
        except OSError as error:
            await self._lose(f"its process can't begin: {error.strerror}", may_stop=False)
            return
        self._worker = worker
        self._workers.add(worker)
        worker.read(
            lambda messages: asyncio.run_coroutine_threadsafe(
                self._hear(worker, messages), loop
            ).result(),
            lambda: asyncio.run_coroutine_threadsafe(self._died(worker), loop).result(),
        )

    async def _hear(self, worker: RunProcess, messages: Sequence[Model]) -> None:
        """The process tells something; one of a run before is not listened to."""
        for message in messages:
            match message:
                case BrokenOff(problem=problem):
                    worker.problem = problem
                case RobotText(text=text) if worker is self._worker:
                    self.robot.post(text)
        async with self._turn:
            if worker is self._worker:
                await self._present.take(messages)

    async def _died(self, worker: RunProcess) -> None:
        """The process has ended: with the run, or before."""
        try:
            async with self._turn:
                if worker is self._worker:
                    self._worker = None
                    problem = worker.problem or f"its process has ended ({worker.how_it_ended()})"
                    await self._lose(problem, may_stop=not worker.for_stop)
        finally:
            self._workers.discard(worker)

    async def _lose(self, problem: str, may_stop: bool) -> None:
        """The run has no process: see `_left_behind`."""
        present, ended = self._present, False
        run = present.kept.state.id
        damaged = False
        try:
            await present.read_entries()
            ended = await self._disk.do(self._folder.has_ended, run)
        except ArgoError as error:
            damaged = True
            if str(error) not in problem:
                problem = f"{problem}; {error}"
        left = _left_behind(
            present.kept.state,
            present.book.pending,
            problem,
            begun=damaged or present.count > 0,
            ended=ended,
            may_stop=may_stop,
        )
        state = left.state.model_copy(update={"requests": present.book.told(left.settled)})
        settled = [RequestTold(run=run, request=request) for request in left.settled]
        await present.take([StateTold(state=state), *settled])
        if left.stop is not None:
            await self._begin((EndRun(id=left.stop.id), left.stop.by))


@dataclass(frozen=True)
class _LeftBehind:
    """How a run stands without its process, and what came of what was asked of it."""

    state: RunState
    settled: tuple[RequestState, ...]
    stop: RequestState | None
    """somebody has asked for it to stop, and another process is to do that"""


def _left_behind(
    state: RunState,
    pending: Sequence[RequestState],
    problem: str,
    *,
    begun: bool,
    ended: bool,
    may_stop: bool,
) -> _LeftBehind:
    """`problem` is why the process is gone; whether the run had `begun`, and `ended`, is what its
    journals say. Another process may be begun to stop it, unless that was tried (`may_stop`)."""
    stop = next((one for one in pending if one.kind == "stop"), None)
    if ended or state.status is RunStatus.ENDED:
        status, why = RunStatus.ENDED, state.problem
    elif not begun or (stop is not None and not may_stop):
        status, why = RunStatus.ENDED, problem
    else:
        status, why = RunStatus.INTERRUPTED, problem
    over = status is RunStatus.ENDED
    settled = []
    for one in pending:
        if one.kind == "stop" and over:
            done = {"progress": RequestProgress.CONFIRMED, "reason": why}
        else:
            done = {"progress": RequestProgress.FAILED, "reason": why or "the run has ended before"}
        if over or one is not stop:
            settled.append(one.model_copy(update=done))
    update = {"status": status, "problem": why, "moving": False, "task": None, "by_hand": False}
    return _LeftBehind(state.model_copy(update=update), tuple(settled), None if over else stop)


def _missing_report(state: RunState, file: str, journal: Path | None, making: bool) -> NotFound:
    """Says it. `journal` is the last one of the run; `making`: its process is still there."""
    entries = f"what has happened is in /api/runs/{state.id}/entries"
    if state.status is not RunStatus.ENDED:
        why = f"it is {state.status}, and the report is made when it has ended; {entries} so far"
    elif making:
        why = "it has just ended, and the report is being made: ask again in a moment"
    elif journal is None or state.entries == 0:
        why = f"it ended before anything had happened ({state.problem}): begin another one"
    else:
        why = (
            f"its process ended before the report was made, or it was deleted; {entries}, and "
            f"`argo resume {journal} --report FOLDER`, on the machine of the service, makes it"
        )
    return NotFound(f"run {state.id} has no {file}: {why}")
