"""Room of one open mission plan: its file, its members, and all changes of the plan."""

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from functools import partial, wraps
from typing import Any, ParamSpec, TypeVar

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Conflict
from argo_compiler.base.message import Message
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
from argo_planner.service.storage.folder import summarize_plan
from argo_planner.service.storage.outline import PlanSummary
from argo_planner.service.storage.plan_file import PlanFile

P = ParamSpec("P")
T = TypeVar("T")
ANALYSED_AFTER = 0.3
"""s without a further command"""


def _shielded(
    work: Callable[P, Coroutine[Any, Any, T]],
) -> Callable[P, Coroutine[Any, Any, T]]:
    """Return a function that completes the work even if its caller is cancelled."""

    @wraps(work)
    async def run(*arguments: P.args, **named: P.kwargs) -> T:
        return await asyncio.shield(asyncio.create_task(work(*arguments, **named)))

    return run


class PlanRoom:
    """Room of one open mission plan. Owns its file; executes changes one after the other."""

    def __init__(
        self,
        file: PlanFile,
        catalog: Catalog,
        analyst: Analyst | None,
        clock: Callable[[], datetime],
        threads: ThreadPoolExecutor,
    ) -> None:
        """Open the room of a plan; `threads` do its work on the disk."""
        self._file = file
        self._threads = threads
        self._document = file.document
        self._catalog = catalog
        self._analyst = analyst
        self._clock = clock
        self._turn = asyncio.Lock()
        self._members: dict[str, tuple[Member, Mailbox]] = {}
        self._findings = self._check()
        self._analysis: AnalysisFound | None = None
        self._analysing: asyncio.Task[None] | None = None
        self._closed = False
        self._schedule_analysis()

    @property
    def document(self) -> PlanDocument:
        """The mission plan, with all changes that are on disk."""
        return self._document

    @property
    def is_idle(self) -> bool:
        """True if the room has no members and no change is under way."""
        return not self._members and not self._turn.locked()

    @property
    def last_analysis(self) -> AnalysisFound | None:
        """The last analysis, which may be of an earlier revision; None if there is none yet."""
        return self._analysis

    def summary(self) -> PlanSummary:
        """Return the summary of the plan, with its times if its present state is analysed."""
        summary = summarize_plan(self.document)
        found = self._analysis
        if found is None or found.revision != summary.revision or found.analysis is None:
            return summary
        if (bounds := found.analysis.duration) is None:
            return summary
        times = {"least_time": bounds.least.value, "most_time": bounds.most.value}
        return summary.model_copy(update=times)

    def plan_state(self, author: str) -> PlanState:
        """Return the present state of the plan, with what this author can undo and redo."""
        lost = self._file.recovery
        return PlanState.from_document(
            self.document, self._findings, author, self._analysis, lost.message if lost else None
        )

    def earlier_answer(self, request: ReplaceFrom, author: str) -> CommandDone | None:
        """Return the same answer as before to a request that was executed before.

        Returns None if the history does not have the request: it is new, or very old. Raises
        CommandIdTaken if another command has used its id.
        """
        known = self.document.plan.find_revision_made_by(request, author)
        return None if known is None else self._command_done(known, author)

    @_shielded
    async def execute(
        self,
        command: PlanCommand,
        author: str,
        made_on: int | None,
        request: ReplaceFrom | None = None,
    ) -> CommandDone:
        """Execute a command that was made on a revision; None allows any revision.

        On return, the change is on disk, and its message is queued for all members. A command that
        was made from a `request` is recognized by that request when it is sent again.

        Raises the errors of `MissionPlan.execute`, or Unavailable if the file can't be written.
        """
        async with self._turn:
            self._require_open()
            plan = self.document.plan
            known = plan.find_revision_made_by(request or command, author)
            if known is not None:
                return self._command_done(known, author)
            changed, record = self.document.with_plan(
                plan.execute(command, author, made_on, self._clock(), request)
            )
            await self._write(changed, record)
            previous, self._findings = self._findings, self._check()
            findings = None if self._findings == previous else self._findings
            self._broadcast(
                RevisionTold.model_construct(revision=record.revision, findings=findings)
            )
            self._schedule_analysis()
            return self._command_done(record.revision, author)

    @_shielded
    async def rename(self, name: str, author: str) -> None:
        """Rename the plan, and tell the members.

        Raises Invalid if the text can't be a name, Unavailable if the file can't be written.
        """
        async with self._turn:
            self._require_open()
            record = self.document.make_rename_record(name, author, self._clock())
            await self._write(self.document.apply(record), record)
            self._broadcast(NameTold(name=name))

    @_shielded
    async def move_to_folder(self, folder: str, seen: str | None, author: str) -> None:
        """Move the plan to a folder of the list of missions.

        Raises the errors of `PlanDocument.make_folder_record`, Unavailable if the file can't be
        written.
        """
        async with self._turn:
            self._require_open()
            record = self.document.make_folder_record(folder, seen, author, self._clock())
            await self._write(self.document.apply(record), record)

    @_shielded
    async def store_version(self, name: str, author: str, made_on: int | None) -> VersionSummary:
        """Store the present mission as a version with this name, and tell the members.

        Raises:
            StaleRevision: The plan is at another revision than `made_on`; None allows any.
            Invalid: The text can't be a name.
            Conflict: The name is taken, or there are too many versions.
            Unavailable: The file can't be written.
        """
        async with self._turn:
            self._require_open()
            self.document.plan.require_newest(made_on)
            record = self.document.make_version_record(name, author, self._clock())
            await self._write(self.document.apply(record), record)
            self._broadcast_versions()
            return VersionSummary.from_version(record.version)

    @_shielded
    async def delete_version(self, number: int) -> None:
        """Delete the version with this number, and tell the members.

        Raises NotFound if there is none, Unavailable if the file can't be written.
        """
        async with self._turn:
            self._require_open()
            record = VersionDropped(number=self.document.version(number).number)
            await self._write(self.document.apply(record), record)
            self._broadcast_versions()

    # ---- members

    def join(self, client: str, author: str, since: int | None = None) -> Mailbox:
        """Add a client as a member of the room, and return the mailbox with its messages.

        The first message is the whole state of the plan, with the last analysis. If the client
        knows the revision `since` already, and the history still has all later revisions, the first
        messages are instead a `resumed` message, one for each revision after `since`, and one with
        the last analysis if there is one.
        """
        self._require_open()
        member = Member(client=client, author=author)
        members = (*self._member_list(), member)
        missed = None if since is None else self.document.plan.revisions_after(since)
        messages: list[Model] = []
        if since is None or missed is None:
            state = self.plan_state(author)
            snapshot = SnapshotTold.model_construct(client=client, state=state, members=members)
            messages.append(snapshot)
        else:
            messages.append(
                ResumedTold.model_construct(
                    client=client,
                    revision=since,
                    name=self.document.name,
                    versions=self._versions(),
                    members=members,
                )
            )
            messages += [RevisionTold.model_construct(revision=revision) for revision in missed]
            if missed:
                newest = RevisionTold.model_construct(revision=missed[-1], findings=self._findings)
                messages[-1] = newest
            if self._analysis is not None:
                messages.append(AnalysisTold.model_construct(analysis=self._analysis))
        mailbox = Mailbox(message.model_dump_json() for message in messages)
        self._broadcast(MembersTold(members=members))
        self._members[client] = (member, mailbox)
        return mailbox

    def set_selection(self, client: str, names: tuple[str, ...]) -> None:
        """Set the names of the tasks and groups that a member has selected; tell the others."""
        member, mailbox = self._members[client]
        if member.selection != names:
            self._members[client] = (member.model_copy(update={"selection": names}), mailbox)
            self._broadcast(MembersTold(members=self._member_list()), except_for=client)

    def publish_job(self, job: Job) -> None:
        """Send a job to all members; it replaces an earlier state of the job that still waits."""
        text = JobTold.model_construct(job=job.without_new_mission()).model_dump_json()
        for _, mailbox in self._members.values():
            mailbox.post_newest(job.id, text)

    def publish_world(self, revision: int) -> None:
        """Tell all members that the obstacles on the site have changed to this revision."""
        self._broadcast(WorldTold(revision=revision))

    def leave(self, client: str) -> None:
        """Remove a member, if the client is one, and tell the others."""
        if self._members.pop(client, None) is not None:
            self._broadcast(MembersTold(members=self._member_list()))

    async def close(self, move_file_first: Callable[[], None] | None = None) -> None:
        """Wait for the change under way, then disconnect all members and close the file.

        `move_file_first`, if given, is called after the wait and before all else, to move the file
        away. If it raises an error, the room stays open and the error is passed on.
        """
        async with self._turn:
            if self._closed:
                return
            if move_file_first is not None:
                await self._on_disk(move_file_first)
                self._broadcast(DeletedTold())
            self.close_at_once()

    def close_at_once(self) -> None:
        """Disconnect all members and close the file, without waiting for a change under way.

        The caller makes sure that there is none; this does not check it.
        """
        self._closed = True
        if self._analysing is not None:
            self._analysing.cancel()
        for _, mailbox in self._members.values():
            mailbox.close(MailboxClosed(Message("the mission is closed")))
        self._file.close()

    def _member_list(self) -> tuple[Member, ...]:
        return tuple(member for member, _ in self._members.values())

    def _broadcast(self, message: Model, except_for: str | None = None) -> None:
        if not self._members:
            return
        text = message.model_dump_json()
        for client, (_, mailbox) in self._members.items():
            if client != except_for:
                mailbox.post(text)

    def _broadcast_versions(self) -> None:
        self._broadcast(VersionsTold(versions=self._versions()))

    def _versions(self) -> tuple[VersionSummary, ...]:
        return tuple(map(VersionSummary.from_version, self.document.versions))

    # ---- the file, checks and analysis

    async def _write(self, document: PlanDocument, record: PlanRecord) -> None:
        await self._on_disk(self._file.append, document, record)
        # After the file: a client that joins in the meantime gets this change as a message.
        self._document = document

    async def _on_disk(self, work: Callable[..., object], *arguments: object) -> None:
        await asyncio.get_running_loop().run_in_executor(self._threads, partial(work, *arguments))

    def _command_done(self, revision: Revision, author: str) -> CommandDone:
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
            raise Conflict("the mission was closed or deleted in the meantime: open it again")

    def _check(self) -> Findings:
        return Findings.from_first_diagnostics(check(self.document.plan.mission, self._catalog))

    def _schedule_analysis(self) -> None:
        if self._analyst is None:
            return
        if self._analysing is not None:
            self._analysing.cancel()
        self._analysing = asyncio.get_running_loop().create_task(self._analyse(self._analyst))

    async def _analyse(self, analyst: Analyst) -> None:
        await asyncio.sleep(ANALYSED_AFTER)
        plan = self.document.plan
        self._analysis = await analyst.analyse_revision(plan.mission, plan.revision)
        self._broadcast(AnalysisTold.model_construct(analysis=self._analysis))
