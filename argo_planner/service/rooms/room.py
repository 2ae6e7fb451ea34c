"""One open plan: its file, those who have it open, and the one way to change it."""

import asyncio
from collections.abc import Callable, Coroutine
from datetime import datetime
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Conflict
from argo_compiler.base.model import Model
from argo_compiler.checks import check
from argo_planner.service.core.commands import PlanCommand, ReplaceFrom, Revision
from argo_planner.service.core.document import PlanDocument, PlanRecord, VersionDropped
from argo_planner.service.jobs.analysis import AnalysisFound, Analyst
from argo_planner.service.jobs.job import Job
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.rooms.messages import (
    AnalysisTold,
    CommandDone,
    DeletedTold,
    Findings,
    JobTold,
    Member,
    MembersTold,
    NameTold,
    PlanState,
    ResumedTold,
    RevisionTold,
    SnapshotTold,
    VersionsTold,
    VersionSummary,
    WorldTold,
)
from argo_planner.service.storage.plan_file import PlanFile

P = ParamSpec("P")
T = TypeVar("T")
ANALYSED_AFTER = 0.3
"""s without another command"""


def _to_the_end(
    work: Callable[P, Coroutine[Any, Any, T]],
) -> Callable[P, Coroutine[Any, Any, T]]:
    """Does the work to its end, even where whoever asked for it does not wait any longer."""

    @wraps(work)
    async def done(*arguments: P.args, **named: P.kwargs) -> T:
        return await asyncio.shield(asyncio.create_task(work(*arguments, **named)))

    return done


class PlanRoom:
    """One open plan. Holds its file; what it does is done one after the other."""

    def __init__(
        self,
        file: PlanFile,
        catalog: Catalog,
        analyst: Analyst | None,
        clock: Callable[[], datetime],
    ) -> None:
        self._file = file
        self._document = file.document
        self._catalog = catalog
        self._analyst = analyst
        self._clock = clock
        self._turn = asyncio.Lock()
        self._members: dict[str, tuple[Member, Mailbox]] = {}
        self._findings = self._found()
        self._analysis: AnalysisFound | None = None
        self._analysing: asyncio.Task[None] | None = None
        self._closed = False
        self._analyse_soon()

    @property
    def document(self) -> PlanDocument:
        """The plan as all who are there have been told."""
        return self._document

    @property
    def empty(self) -> bool:
        """Whether nobody has the plan open, and nothing is being done to it."""
        return not self._members and not self._turn.locked()

    @property
    def analysis(self) -> AnalysisFound | None:
        """The last one; it may be of an earlier revision."""
        return self._analysis

    def state(self, author: str) -> PlanState:
        """The plan as it stands, for an author."""
        lost = self._file.recovery
        return PlanState.of(
            self.document, self._findings, author, self._analysis, lost.message if lost else None
        )

    def repeated(self, asked: ReplaceFrom, author: str) -> CommandDone | None:
        """The answer to a command that has been carried out before. Raises CommandIdTaken."""
        known = self.document.plan.revision_for(asked, author)
        return None if known is None else self._done(known, author)

    @_to_the_end
    async def carry_out(
        self,
        command: PlanCommand,
        author: str,
        made_on: int | None,
        asked: ReplaceFrom | None = None,
    ) -> CommandDone:
        """Carries out a command that was made on a revision; None: on whichever there is. When
        this returns, it is on disk, and all who are there are being told. It is known by what was
        `asked`, where that stands for it.

        Raises what `MissionPlan.carried_out` raises, or Unavailable where it can't be written.
        """
        async with self._turn:
            self._require_open()
            plan = self.document.plan
            known = plan.revision_for(asked or command, author)
            if known is not None:
                return self._done(known, author)
            changed, record = self.document.with_plan(
                plan.execute(command, author, made_on, self._clock(), asked)
            )
            await self._write(changed, record)
            before, self._findings = self._findings, self._found()
            findings = None if self._findings == before else self._findings
            self._tell(RevisionTold.model_construct(revision=record.revision, findings=findings))
            self._analyse_soon()
            return self._done(record.revision, author)

    @_to_the_end
    async def rename(self, name: str, author: str) -> None:
        """Gives the plan another name. Raises Invalid, Unavailable."""
        async with self._turn:
            self._require_open()
            record = self.document.make_rename_record(name, author, self._clock())
            await self._write(self.document.apply(record), record)
            self._tell(NameTold(name=name))

    @_to_the_end
    async def keep_version(self, name: str, author: str, made_on: int | None) -> VersionSummary:
        """Keeps the present mission under a name. Raises StaleRevision, Invalid, Conflict,
        Unavailable."""
        async with self._turn:
            self._require_open()
            self.document.plan.require_newest(made_on)
            record = self.document.make_version_record(name, author, self._clock())
            await self._write(self.document.apply(record), record)
            self._tell_versions()
            return VersionSummary.of(record.version)

    @_to_the_end
    async def drop_version(self, number: int) -> None:
        """Keeps a version no longer. Raises NotFound, Unavailable."""
        async with self._turn:
            self._require_open()
            record = VersionDropped(number=self.document.version(number).number)
            await self._write(self.document.apply(record), record)
            self._tell_versions()

    # ---- those who have it open

    def join(self, client: str, author: str, since: int | None = None) -> Mailbox:
        """Somebody opens the plan. Their first message is the whole state, or, where the revision
        that they know is known here, what happened since then."""
        self._require_open()
        member = Member(client=client, author=author)
        members = (*self._present(), member)
        missed = None if since is None else self.document.plan.since(since)
        past: list[Model] = []
        if since is None or missed is None:
            state = self.state(author)
            told = SnapshotTold.model_construct(client=client, state=state, members=members)
            past.append(told)
        else:
            past.append(
                ResumedTold.model_construct(
                    client=client,
                    revision=since,
                    name=self.document.name,
                    versions=self._versions(),
                    members=members,
                )
            )
            past += [RevisionTold.model_construct(revision=revision) for revision in missed]
            if missed:
                newest = RevisionTold.model_construct(revision=missed[-1], findings=self._findings)
                past[-1] = newest
            if self._analysis is not None:
                past.append(AnalysisTold.model_construct(analysis=self._analysis))
        mailbox = Mailbox(told.model_dump_json() for told in past)
        self._tell(MembersTold(members=members))
        self._members[client] = (member, mailbox)
        return mailbox

    def select(self, client: str, names: tuple[str, ...]) -> None:
        """Somebody has selected these tasks and groups."""
        member, mailbox = self._members[client]
        if member.selection != names:
            self._members[client] = (member.model_copy(update={"selection": names}), mailbox)
            self._tell(MembersTold(members=self._present()), but=client)

    def tell_of(self, job: Job) -> None:
        """How far a job is is told to all who are there."""
        text = JobTold.model_construct(job=job.told()).model_dump_json()
        for _, mailbox in self._members.values():
            mailbox.post_newest(job.id, text)

    def tell_of_world(self, revision: int) -> None:
        """That the obstacles on the site have changed is told to all who are there."""
        self._tell(WorldTold(revision=revision))

    def leave(self, client: str) -> None:
        """Somebody has gone."""
        if self._members.pop(client, None) is not None:
            self._tell(MembersTold(members=self._present()))

    async def close(self, deleting: Callable[[], None] | None = None) -> None:
        """Lets everybody go, and closes the file once nothing is being done. `deleting` moves the
        file away before; raises what it raises, and goes on as before then."""
        async with self._turn:
            if self._closed:
                return
            if deleting is not None:
                await asyncio.to_thread(deleting)
                self._tell(DeletedTold())
            self.close_idle()

    def close_idle(self) -> None:
        """Closes the file, while nothing is being done."""
        self._closed = True
        if self._analysing is not None:
            self._analysing.cancel()
        for _, mailbox in self._members.values():
            mailbox.close(MailboxClosed("the mission is closed"))
        self._file.close()

    def _present(self) -> tuple[Member, ...]:
        return tuple(member for member, _ in self._members.values())

    def _tell(self, message: Model, but: str | None = None) -> None:
        if not self._members:
            return
        text = message.model_dump_json()
        for client, (_, mailbox) in self._members.items():
            if client != but:
                mailbox.post(text)

    def _tell_versions(self) -> None:
        self._tell(VersionsTold(versions=self._versions()))

    def _versions(self) -> tuple[VersionSummary, ...]:
        return tuple(map(VersionSummary.of, self.document.versions))

    # ---- what is found out

    async def _write(self, document: PlanDocument, record: PlanRecord) -> None:
        await asyncio.to_thread(self._file.append, document, record)
        # Not before, so that whoever joins meanwhile is told of it like all others.
        self._document = document

    def _done(self, revision: Revision, author: str) -> CommandDone:
        plan = self.document.plan
        return CommandDone.model_construct(
            revision=revision,
            newest=plan.revision,
            findings=self._findings,
            undoable=plan.undoable.get(author, ()),
            redoable=plan.redoable.get(author, ()),
        )

    def _require_open(self) -> None:
        if self._closed:
            raise Conflict("the mission was closed or deleted meanwhile: open it again")

    def _found(self) -> Findings:
        return Findings.of(check(self.document.plan.mission, self._catalog))

    def _analyse_soon(self) -> None:
        if self._analyst is None:
            return
        if self._analysing is not None:
            self._analysing.cancel()
        self._analysing = asyncio.get_running_loop().create_task(self._analyse(self._analyst))

    async def _analyse(self, analyst: Analyst) -> None:
        await asyncio.sleep(ANALYSED_AFTER)
        plan = self.document.plan
        self._analysis = await analyst.analyse(plan.mission, plan.revision)
        self._tell(AnalysisTold.model_construct(analysis=self._analysis))
