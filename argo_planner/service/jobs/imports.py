"""Imports of missions in separate processes, with limits of time and memory."""

import asyncio
import os
from collections import Counter, defaultdict
from collections.abc import AsyncIterable, AsyncIterator, Callable, Mapping
from contextlib import AsyncExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeVar

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable, reason_text
from argo_compiler.base.limited_process import CallLimits, LimitExceeded, limited, limits_for_size
from argo_compiler.base.message import Message
from argo_compiler.base.operating_system import niceness, set_niceness
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.ros.bags import suffix_by_first_bytes
from argo_compiler.ros.recognition import first_bytes_if_readable, is_bag_content
from argo_compiler.script.documents.document import Document
from argo_compiler.script.drafts.draft import (
    Draft,
    IncompleteDraft,
    LineDecision,
    LineState,
)
from argo_compiler.script.drafts.naming_nothing import lines_naming_nothing
from argo_env.files.checked_lines import write_all
from argo_env.planning.opening import OpenedSite, open_site
from argo_planner.service.core.change import mission_change
from argo_planner.service.core.plan_limits import require_within_limits
from argo_planner.service.processes.job_process import JobProcess, ReportProgress
from argo_planner.use_cases.explaining import explain_mission
from argo_planner.use_cases.importing import (
    ImportedMission,
    SourceKind,
    Upload,
    guess_source_kind,
    import_mission,
    load_draft,
    script_in,
)

Result = TypeVar("Result")

MOST_IMPORTS = 2
"""imports that are read at the same time; each visitor has at most one of them"""
MOST_OF_VISITOR = 8
"""imports of one visitor that are read or wait, as each is stored meanwhile"""
_LOWER_PRIORITY = 10
"""niceness that is added, so that edits come first"""


@dataclass(frozen=True)
class DraftReading:
    """A draft, and its mission once it is complete."""

    draft: Draft
    imported: ImportedMission | None = None
    """the mission; None: lines are left, or the mission as a whole has errors"""
    problems: tuple[Diagnostic, ...] = ()
    """errors of the mission as a whole"""
    steps: Mapping[int, tuple[str, ...]] = field(default_factory=dict)
    """the steps of the mission by the line that asks for them, if no line is open"""
    naming_nothing: frozenset[str] = frozenset()
    """labels of the open lines in which nothing of a mission is mentioned"""


@dataclass(frozen=True)
class ReadUpload:
    """The mission in an upload, or the draft of a script that is not complete."""

    imported: ImportedMission | None
    """the mission; None: lines of the draft are left to decide on"""
    script: str | Document | None
    """what the file was read as, if the upload is a script"""
    reading: DraftReading | None = None
    """the draft; None unless lines are left"""

    @property
    def script_text(self) -> str | None:
        """The text of the script; None if the upload is none."""
        return self.script.text if isinstance(self.script, Document) else self.script

    def require_mission(self) -> ImportedMission:
        """Return the mission; raises IncompleteDraft if lines are left."""
        if self.imported is None:
            assert self.reading is not None, "there is a mission or a draft"
            raise IncompleteDraft(self.reading.draft)
        return self.imported


class Imports:
    """Imports of missions for one site. Each is read in its own process, which ends after it."""

    def __init__(self, site: str) -> None:
        """Create the imports for the site that the reference `site` opens."""
        self._site = site
        self._turns = asyncio.Semaphore(MOST_IMPORTS)
        self._visitors: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        """held while an import of the visitor is read, so that others have their turn"""
        self._under_way: Counter[str] = Counter()
        """imports that are read or wait, by visitor"""

    async def import_upload(
        self,
        name: str,
        content: AsyncIterable[bytes],
        visitor: str,
        start_area: int | None = None,
        end_area: int | None = None,
    ) -> ReadUpload:
        """Read and check the mission in an upload, as `import_mission` does.

        Args:
            name: Name of the file.
            content: Its content in parts.
            visitor: Key of who has sent it.
            start_area: Starting area, as for `import_mission`.
            end_area: Area to end in, likewise.

        Raises:
            ArgoError: As `import_mission` does (but for IncompleteDraft), if the mission is too
                large for a plan, if reading it exceeds the limits of time and memory, or if too
                many imports of the visitor are under way.
        """
        arguments = (start_area, end_area)
        return await self._store_and_read(import_file, name, content, visitor, arguments)

    async def read_draft(
        self,
        name: str,
        script: str | Document,
        visitor: str,
        areas: tuple[int | None, int | None],
        decisions: tuple[LineDecision, ...],
    ) -> DraftReading:
        """Read the draft of a script with decisions; raises the errors of `import_upload`."""
        document = script if isinstance(script, Document) else None
        text = script.text if isinstance(script, Document) else script

        async def content() -> AsyncIterator[bytes]:
            yield text.encode(errors="replace")

        arguments = (document, *areas, decisions)
        return await self._store_and_read(read_draft_file, name, content(), visitor, arguments)

    async def _store_and_read(
        self,
        work: Callable[..., Result],
        name: str,
        content: AsyncIterable[bytes],
        visitor: str,
        arguments: tuple[Any, ...],
    ) -> Result:
        if self._under_way[visitor] >= MOST_OF_VISITOR:
            raise Unavailable(
                Message(
                    "{most_of_visitor} imports with this token are under way: try again when "
                    "some of them have ended",
                    most_of_visitor=MOST_OF_VISITOR,
                )
            )
        self._under_way[visitor] += 1
        try:
            return await self._in_turn(work, name, content, visitor, arguments)
        finally:
            self._under_way[visitor] -= 1

    async def _in_turn(
        self,
        work: Callable[..., Result],
        name: str,
        content: AsyncIterable[bytes],
        visitor: str,
        arguments: tuple[Any, ...],
    ) -> Result:
        try:
            folder = TemporaryDirectory(prefix="argo-import-", ignore_cleanup_errors=True)
        except OSError as error:
            raise _unwritable(error) from None
        with folder:
            path = Path(folder.name) / "upload"
            size = await _store(path, content)
            async with AsyncExitStack() as stack:
                await stack.enter_async_context(self._visitors[visitor])
                await stack.enter_async_context(self._turns)
                return await self._read(work, name, path, limits_for_size(size), arguments)

    async def _read(
        self,
        work: Callable[..., Result],
        name: str,
        path: Path,
        limits: CallLimits,
        arguments: tuple[Any, ...],
    ) -> Result:
        process = JobProcess[Result](
            work, self._site, name, path, limits, *arguments, limits=limits
        )
        try:
            return await process.start_and_wait(lambda _: None)
        except LimitExceeded as error:
            raise Invalid(
                Message(
                    "{name} {error}: is it the right file? A mission takes far less",
                    name=name,
                    error=error,
                )
            ) from None
        finally:
            await process.end()


async def _store(path: Path, content: AsyncIterable[bytes]) -> int:
    """Write the parts of an upload to a file, and return its size in bytes."""
    with open(path, "wb", buffering=0) as file:
        async for part in content:
            try:
                write_all(file.fileno(), part)
            except OSError as error:
                raise _unwritable(error) from None
        return file.tell()


def _unwritable(error: OSError) -> ArgoError:
    return Unavailable(
        Message(
            "the upload can't be stored: {reason}; free some space for temporary files",
            reason=reason_text(error),
        )
    )


def import_file(
    site: str,
    name: str,
    path: Path,
    limits: CallLimits,
    start_area: int | None,
    end_area: int | None,
    _: ReportProgress,
) -> ReadUpload:
    """Read and check the mission in a file within limits, as the work of a process.

    `site` is a reference that `open_site` takes, `name` that of the file in messages. Raises the
    errors of `import_mission`, LimitExceeded, and PlanTooLarge.
    """
    opened = open_site(site)
    set_niceness(niceness() + _LOWER_PRIORITY)
    first = first_bytes_if_readable(path)
    with limited(limits):
        if is_bag_content(name, first):
            bag = path.with_suffix(suffix_by_first_bytes(first))
            os.rename(path, bag)
            upload = Upload(name, bag)
        else:
            upload = Upload(name, path.read_bytes())
        try:
            imported = import_mission(upload, opened, start_area, end_area)
        except IncompleteDraft as error:
            reading = _read_steps(upload, opened, (start_area, end_area), error.draft)
            return ReadUpload(None, _script_of(upload), reading)
        _require_plan_size(imported)
        return ReadUpload(imported, _script_of(upload))


def read_draft_file(
    site: str,
    name: str,
    path: Path,
    limits: CallLimits,
    document: Document | None,
    start_area: int | None,
    end_area: int | None,
    decisions: tuple[LineDecision, ...],
    _: ReportProgress,
) -> DraftReading:
    """Read the draft of a script in a file within limits, as the work of a process.

    The script is `document`, or the text of the file if that is None. The other arguments and the
    errors are those of `import_file`. Errors of the mission as a whole are not raised, but are
    problems of the reading.
    """
    opened = open_site(site)
    set_niceness(niceness() + _LOWER_PRIORITY)
    with limited(limits):
        content = path.read_bytes() if document is None else document
        upload = Upload(name, content, decisions)
        draft = load_draft(upload, opened.catalog, start_area, end_area)
        return _read_steps(upload, opened, (start_area, end_area), draft)


def _read_steps(
    upload: Upload, site: OpenedSite, areas: tuple[int | None, int | None], draft: Draft
) -> DraftReading:
    """Return the draft of an upload with its mission, and with the steps of its lines.

    Of a draft whose lines are only to be confirmed, the steps are those once they are.
    """
    if any(line.state is LineState.OPEN for line in draft.lines):
        idle = frozenset(line.label for line in lines_naming_nothing(draft, site.catalog))
        return DraftReading(draft, naming_nothing=idle)
    confirmed = draft
    if draft.left:
        confirmed = load_draft(upload, site.catalog, *areas, decisions=draft.confirm())
    try:
        imported = import_mission(replace(upload, draft=confirmed), site, *areas)
        _require_plan_size(imported)
    except DiagnosticError as error:
        problems = () if draft.left else error.diagnostics
        return DraftReading(draft, None, problems)
    return DraftReading(draft, None if draft.left else imported, (), _steps_of(imported, site))


def _steps_of(imported: ImportedMission, site: OpenedSite) -> dict[int, tuple[str, ...]]:
    """Return the sentences of a mission by the line of the script that asks for them."""
    try:
        reading = explain_mission(imported, site)
    except DiagnosticError:  # no script can express a part of it
        return {}
    found: defaultdict[int, tuple[str, ...]] = defaultdict(tuple)
    for entry in reading.entries:
        if entry.source is not None:
            found[entry.source.line] += entry.sentences
    return dict(found)


def _script_of(upload: Upload) -> str | Document | None:
    return script_in(upload) if guess_source_kind(upload) is SourceKind.SCRIPT else None


def _require_plan_size(imported: ImportedMission) -> None:
    mission = imported.mission
    require_within_limits(mission, mission_change(Mission(tasks=()), mission))
