"""The one run of the service's robot: begun, asked, followed, gone on with."""

import asyncio
import secrets
from collections.abc import Callable
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import Any

from argo_compiler.errors import ArgoError, Conflict, NotFound
from argo_compiler.model import Model
from argo_env.run.log import Entry
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.runs.folder import KeptRun, RunFolder
from argo_planner.service.runs.pipe import RobotText
from argo_planner.service.runs.process import RunProcess
from argo_planner.service.runs.requests import (
    EndRun,
    GoOnWithRun,
    RequestProgress,
    RequestState,
    RunOrder,
    RunRequest,
)
from argo_planner.service.runs.state import (
    EntryList,
    EntryTold,
    PoseTold,
    RequestTold,
    RunState,
    RunStatus,
    StateTold,
)


class AfterRestart(StrEnum):
    """What becomes of a run that was under way when the service was killed."""

    GO_ON = "go-on"
    WAIT = "wait"
    """for a person, who asks for it to go on"""


class RunHost:
    """The run of the service's robot. Holds its process and those who follow it."""

    def __init__(
        self,
        folder: Path,
        after_restart: AfterRestart,
        clock: Callable[[], datetime],
        foxglove: int | None = None,
    ) -> None:
        """`foxglove`: the port at which runs are shown live on this machine; None: they are not."""
        self._folder = RunFolder(folder)
        self._after_restart = after_restart
        self._clock = clock
        self._foxglove = foxglove
        self._kept: KeptRun | None = None
        self._worker: RunProcess | None = None
        self._workers: set[RunProcess] = set()
        """this one, and those that still write the report of a run before"""
        self._entries: list[str] = []
        self._read: tuple[str, tuple[Entry, ...]] | None = None
        """a run before that was read last, with its entries: who looks at it reads it in parts"""
        self._requests: dict[str, RequestState] = {}
        self._followers: dict[str, Mailbox] = {}
        self._robot: Mailbox | None = None
        self._ended = asyncio.Event()

    @property
    def state(self) -> RunState | None:
        """How the last run stands; None: there was none."""
        return self._kept.state if self._kept else None

    @property
    def folder(self) -> RunFolder:
        """The runs on disk."""
        return self._folder

    async def open(self) -> None:
        """Finds the last run. One that had not ended goes on, or waits for a person."""
        runs = await asyncio.to_thread(self._folder.all)
        if not runs:
            return
        kept = runs[0]
        if kept.state.status is not RunStatus.ENDED:
            problem = "the service has ended while it was under way"
            kept = await self._found_interrupted(kept, problem)
        self._kept = kept
        if kept.state.status is RunStatus.INTERRUPTED and (
            self._after_restart is AfterRestart.GO_ON
        ):
            self._begin()

    async def start(self, order: RunOrder, by: str) -> RunState:
        """Begins a run. Raises Conflict, with who holds the robot, if one is not over yet."""
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
        self._kept = KeptRun(order=order, state=first)
        self._entries, self._requests = [], {}
        try:
            await asyncio.to_thread(self._folder.make, self._kept)
        except ArgoError:
            self._kept = KeptRun(
                order=order, state=first.model_copy(update={"status": RunStatus.ENDED})
            )
            raise
        self._begin()
        return first

    async def ask(self, run: str, request: RunRequest, by: str) -> RequestState:
        """Passes a request on; sent again it does nothing twice. What comes of it is told.

        Raises NotFound if the run is another one, Conflict if it is over.
        """
        state = self.of(run)
        if (known := self._requests.get(request.id)) is not None:
            if (known.kind, known.by) != (request.kind, by):
                raise Conflict(f"another request has had the id {request.id}: give each its own")
            return known
        if state.status is RunStatus.ENDED:
            raise Conflict(f"run {run} is over")
        accepted = RequestState(
            id=request.id, kind=request.kind, by=by, progress=RequestProgress.ACCEPTED
        )
        if state.status is RunStatus.INTERRUPTED:
            return await self._ask_interrupted(request, accepted)
        if self._worker is None:
            raise Conflict(f"run {run} is {state.status}: ask again in a moment")
        self._hear(RequestTold(run=run, request=accepted))
        self._worker.send((request, by))
        return accepted

    def request(self, run: str, id: str) -> RequestState:
        """How far a request is. Raises NotFound."""
        self.of(run)
        if id not in self._requests:
            raise NotFound(f"run {run} has had no request {id[:64]!r}")
        return self._requests[id]

    def entries(self, run: str, since: int) -> tuple[int, list[str]]:
        """How many entries there are, and those after the first `since`, as JSON."""
        self.of(run)
        return len(self._entries), self._entries[since:]

    async def history(self, run: str, since: int, most: int) -> EntryList:
        """What has happened in a run after the first `since` entries. Raises NotFound."""
        state = self.state
        if state is not None and state.id == run:
            told = [EntryTold.model_validate_json(t) for t in self._entries[since : since + most]]
            return EntryList(count=len(self._entries), entries=tuple(one.entry for one in told))
        if self._read is None or self._read[0] != run:
            self._read = run, await asyncio.to_thread(self._folder.entries, run)
        entries = self._read[1]
        return EntryList(count=len(entries), entries=entries[since : since + most])

    def follow(self, client: str, since: int | None = None) -> Mailbox:
        """Somebody follows the robot's runs: first how it stands, then the entries after that
        number of the present run, then all that happens."""
        state = StateTold.model_construct(state=self.state).model_dump_json()
        mailbox = Mailbox([state, *self._entries[since or 0 :]])
        self._followers[client] = mailbox
        return mailbox

    def connect_robot(self) -> Mailbox:
        """A robot that is somewhere else has connected: the texts for it. One that was connected
        before is let go."""
        if self._robot is not None:
            self._robot.close(MailboxClosed("the robot has connected again"))
        self._robot = Mailbox()
        return self._robot

    def hear_robot(self, line: Mailbox, text: str) -> None:
        """The robot on that line tells something. While no run is under way nobody hears it."""
        if line is self._robot and self._worker is not None:
            self._worker.send(RobotText(text=text))

    def disconnect_robot(self, line: Mailbox) -> None:
        """The robot's connection has ended."""
        if line is self._robot:
            self._robot = None

    def leave(self, client: str) -> None:
        """Somebody has gone."""
        self._followers.pop(client, None)

    async def close(self) -> None:
        """Ends the process; the journal stays, and the run can go on from it."""
        self._worker = None
        for worker in [*self._workers]:
            await asyncio.to_thread(worker.end)
        for mailbox in (*self._followers.values(), *([self._robot] if self._robot else [])):
            mailbox.close(MailboxClosed("the service ends"))

    # ---- the process

    def _begin(self) -> None:
        """Begins the process of the run, which goes on from its journal if there is one."""
        assert self._kept is not None
        first = self._kept.state.model_copy(
            update={"status": RunStatus.PREPARING, "problem": None, "requests": ()}
        )
        self._kept = self._kept.model_copy(update={"state": first})
        loop = asyncio.get_running_loop()
        worker = RunProcess(self._folder.path(first.id), self._kept.order, first, self._foxglove)
        self._worker = worker
        self._workers.add(worker)
        self._tell_state()
        worker.read(
            lambda message: loop.call_soon_threadsafe(self._hear_of, worker, message),
            lambda: loop.call_soon_threadsafe(self._died, worker),
        )

    def _hear_of(self, worker: "RunProcess", message: Model) -> None:
        if worker is self._worker:
            self._hear(message)

    def _hear(self, message: Model) -> None:
        """Something is told of the run."""
        assert self._kept is not None
        match message:
            case StateTold(state=state) if state is not None:
                self._take_state(state)
                return
            case RobotText(text=text):
                if self._robot is not None:
                    self._robot.post(text)
                return
            case PoseTold():
                text = message.model_dump_json()
                for mailbox in self._followers.values():
                    mailbox.post_newest("pose", text)
                return
            case EntryTold(number=number):
                if number <= len(self._entries):
                    return
                self._entries.append(text := message.model_dump_json())
            case RequestTold(request=request):
                self._requests[request.id] = request
                text = message.model_dump_json()
            case _:
                return
        for mailbox in self._followers.values():
            mailbox.post(text)

    def _take_state(self, state: RunState) -> None:
        assert self._kept is not None
        before = self._kept.state.status
        self._kept = self._kept.model_copy(update={"state": state})
        self._tell_state()
        if state.status is not before:
            self._folder.keep(self._kept)

    def _tell_state(self) -> None:
        text = StateTold.model_construct(state=self.state).model_dump_json()
        for mailbox in self._followers.values():
            mailbox.post_newest("state", text)

    def _died(self, worker: "RunProcess") -> None:
        """The process has ended: with the run, or before."""
        self._workers.discard(worker)
        if worker is not self._worker:
            return
        self._worker = None
        assert self._kept is not None
        state = self._kept.state
        if state.status is not RunStatus.ENDED:
            problem = state.problem or f"its process has ended ({worker.how_it_ended()})"
            broken = {"status": RunStatus.INTERRUPTED, "problem": problem, "moving": False}
            self._take_state(state.model_copy(update=broken))
        for request in [*self._requests.values()]:
            if not request.over:
                failed = {"progress": RequestProgress.FAILED, "reason": "the process has ended"}
                told = RequestTold(run=state.id, request=request.model_copy(update=failed))
                self._hear(told)

    async def _found_interrupted(self, kept: KeptRun, problem: str) -> KeptRun:
        """A run whose process is gone, with what its journal says of it."""
        ended = False
        try:
            entries = await asyncio.to_thread(self._folder.entries, kept.state.id)
            ended = await asyncio.to_thread(self._folder.has_ended, kept.state.id)
        except ArgoError as error:
            entries, problem = (), f"{problem}; its journal can't be read: {error}"
        self._entries = [
            EntryTold.model_construct(
                run=kept.state.id, number=number, entry=entry
            ).model_dump_json()
            for number, entry in enumerate(entries, start=1)
        ]
        update: dict[str, Any] = {"entries": len(entries), "moving": False, "requests": ()}
        if ended:
            update |= {"status": RunStatus.ENDED, "t": entries[-1].t}
        else:
            update |= {"status": RunStatus.INTERRUPTED, "problem": problem}
        kept = kept.model_copy(update={"state": kept.state.model_copy(update=update)})
        await asyncio.to_thread(self._folder.keep, kept)
        return kept

    async def _ask_interrupted(self, request: RunRequest, accepted: RequestState) -> RequestState:
        """An interrupted run can only go on, or be given up."""
        assert self._kept is not None
        state = self._kept.state
        match request:
            case GoOnWithRun():
                self._begin()
            case EndRun():
                self._take_state(state.model_copy(update={"status": RunStatus.ENDED}))
            case _:
                raise Conflict(
                    f"run {state.id} is interrupted ({state.problem}): let it go on, or stop it"
                )
        done = accepted.model_copy(update={"progress": RequestProgress.CONFIRMED})
        self._hear(RequestTold(run=state.id, request=done))
        return done

    def of(self, run: str) -> RunState:
        """How the present run stands. Raises NotFound if that is another one."""
        state = self.state
        if state is None or state.id != run:
            raise NotFound(f"run {run[:40]!r} is not the present one")
        return state
