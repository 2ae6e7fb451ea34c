"""The drafts of a service: they are read anew after each decision, and stored."""

import asyncio
from collections import OrderedDict, defaultdict
from collections.abc import Callable, Sequence
from datetime import datetime

from argo_compiler.base.errors import Conflict, Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.documents.document import Document
from argo_compiler.script.drafts.draft import Draft, IncompleteDraft, LineState
from argo_planner.service.core.plan_limits import require_displayable_name
from argo_planner.service.core.refusals import StaleRevision
from argo_planner.service.drafts.messages import (
    MOST_LINES,
    AnyAct,
    ChooseAreas,
    DraftState,
    DraftSummary,
    areas_to_choose,
    decisions_after,
    drafted_lines,
    other_messages,
)
from argo_planner.service.jobs.imports import DraftReading, Imports
from argo_planner.service.storage.draft_folder import DraftFolder, DraftRecord
from argo_planner.use_cases.importing import ImportedMission

MOST_DRAFTS = 200
"""drafts in a folder"""
MAX_TEXT_LENGTH = 1_000_000
"""in characters"""
_MOST_READ = 20
"""drafts of which the last reading is in memory"""


class Drafts:
    """Drafts of scripts for one site. Each decision is on disk before it is answered."""

    def __init__(
        self, folder: DraftFolder, scripts: Imports, clock: Callable[[], datetime]
    ) -> None:
        """Create the drafts in a folder; `scripts` read them in processes of their own."""
        self._folder = folder
        self._scripts = scripts
        self._clock = clock
        self._summaries: dict[str, DraftSummary] = {}
        self._readings: OrderedDict[str, tuple[int, DraftReading]] = OrderedDict()
        """last readings by id, each with its revision"""
        self._turns: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        """held while a draft is read or changed"""

    async def open(self) -> None:
        """Load the summaries of the stored drafts."""
        stored = await asyncio.to_thread(self._folder.load_drafts)
        self._summaries = {draft.id: _summary(draft) for draft in stored}

    def list_drafts(self) -> list[DraftSummary]:
        """Return summaries of all drafts, the last changed ones first."""
        return sorted(self._summaries.values(), key=lambda one: one.changed, reverse=True)

    async def create(
        self,
        name: str,
        source_name: str,
        script: str | Document,
        reading: DraftReading,
        areas: tuple[int | None, int | None],
    ) -> DraftState:
        """Store the draft of a script with its first reading, and return its state.

        Raises Invalid if it is too long, Conflict if there are MOST_DRAFTS drafts already,
        Unavailable if it can't be stored.
        """
        require_displayable_name(name, Message("the mission"))
        draft = reading.draft
        document = script if isinstance(script, Document) else None
        text = script if isinstance(script, str) else script.text
        if len(text) > MAX_TEXT_LENGTH or len(draft.lines) > MOST_LINES:
            raise Invalid(
                Message(
                    "{incompletedraft}; with more than {most_lines:,} lines or "
                    "{max_text_length:,} characters that is done with `argo import`",
                    incompletedraft=IncompleteDraft(draft),
                    most_lines=MOST_LINES,
                    max_text_length=MAX_TEXT_LENGTH,
                )
            )
        if len(self._summaries) >= MOST_DRAFTS:
            raise Conflict(
                Message(
                    "there are {most_drafts} drafts: complete or delete some of them first",
                    most_drafts=MOST_DRAFTS,
                )
            )
        now = self._clock()
        stored = _with_counts(
            DraftRecord(
                id=self._folder.free_id(),
                name=name,
                source_name=source_name,
                text=text,
                document=document,
                start_area=areas[0],
                end_area=areas[1],
                created=now,
                changed=now,
                to_confirm=0,
                to_answer=0,
            ),
            draft,
        )
        return await self._store(stored, reading)

    async def state(self, id: str, visitor: str) -> DraftState:
        """Return the state of a draft; `visitor` is the key of who asks for it."""
        async with self._turns[id]:
            stored = await self._load(id)
            return _state(stored, await self._reading(stored, visitor))

    async def carry_out(
        self, id: str, acts: Sequence[AnyAct], made_on: int | None, visitor: str
    ) -> DraftState:
        """Carry out acts on a draft of revision `made_on` (None: any), and return its new state.

        Raises StaleRevision if the draft has changed since, Invalid if an act is impossible.
        """
        async with self._turns[id]:
            stored = await self._load(id)
            _require_newest(stored, made_on)
            reading = await self._reading(stored, visitor)
            decided = decisions_after(reading.draft, acts)
            update: dict[str, object] = {"decisions": decided, "revision": stored.revision + 1}
            update["changed"] = self._clock()
            for act in acts:
                if isinstance(act, ChooseAreas):
                    update |= {"start_area": act.start_area, "end_area": act.end_area}
            changed = stored.model_copy(update=update)
            reading = await self._read(changed, visitor)
            return await self._store(_with_counts(changed, reading.draft), reading)

    async def complete_mission(
        self, id: str, made_on: int | None, visitor: str
    ) -> tuple[DraftRecord, ImportedMission]:
        """Return a draft and its mission.

        Raises IncompleteDraft if lines are left, DiagnosticError if the mission has errors.
        """
        async with self._turns[id]:
            stored = await self._load(id)
            _require_newest(stored, made_on)
            reading = await self._reading(stored, visitor)
            if reading.draft.left:
                raise IncompleteDraft(reading.draft)
            if reading.imported is None:
                raise DiagnosticError(stored.source_name, reading.problems)
            return stored, reading.imported

    async def delete(self, id: str) -> None:
        """Delete a draft; raises NotFound if there is none."""
        async with self._turns[id]:
            await asyncio.to_thread(self._folder.delete, id)
            self._summaries.pop(id, None)
            self._readings.pop(id, None)
        self._turns.pop(id, None)

    async def _load(self, id: str) -> DraftRecord:
        try:
            return await asyncio.to_thread(self._folder.load, id)
        except NotFound:
            self._turns.pop(id, None)
            raise

    async def _reading(self, stored: DraftRecord, visitor: str) -> DraftReading:
        revision, reading = self._readings.get(stored.id, (0, None))
        if reading is None or revision != stored.revision:
            reading = await self._read(stored, visitor)
            self._remember(stored, reading)
        return reading

    async def _read(self, stored: DraftRecord, visitor: str) -> DraftReading:
        return await self._scripts.read_draft(
            stored.source_name,
            stored.document or stored.text,
            visitor,
            (stored.start_area, stored.end_area),
            stored.decisions,
        )

    async def _store(self, stored: DraftRecord, reading: DraftReading) -> DraftState:
        await asyncio.shield(asyncio.to_thread(self._folder.store, stored))
        self._summaries[stored.id] = _summary(stored)
        self._remember(stored, reading)
        return _state(stored, reading)

    def _remember(self, stored: DraftRecord, reading: DraftReading) -> None:
        self._readings[stored.id] = stored.revision, reading
        self._readings.move_to_end(stored.id)
        while len(self._readings) > _MOST_READ:
            self._readings.popitem(last=False)


def _require_newest(stored: DraftRecord, made_on: int | None) -> None:
    if made_on is not None and made_on != stored.revision:
        raise StaleRevision(made_on, stored.revision)


def _with_counts(stored: DraftRecord, draft: Draft) -> DraftRecord:
    proposed = sum(line.state is LineState.PROPOSED for line in draft.left)
    counts = {"to_confirm": proposed, "to_answer": len(draft.left) - proposed}
    return stored.model_copy(update=counts)


def _summary(stored: DraftRecord) -> DraftSummary:
    fields = {name: getattr(stored, name) for name in DraftSummary.model_fields}
    return DraftSummary.model_construct(**fields)


def _state(stored: DraftRecord, reading: DraftReading) -> DraftState:
    return DraftState.model_construct(
        **dict(_summary(stored)),
        start_area=stored.start_area,
        end_area=stored.end_area,
        areas_to_choose=areas_to_choose(reading.draft, reading.problems),
        lines=drafted_lines(reading.draft, reading.steps, reading.naming_nothing),
        diagnostics=other_messages(reading.draft, reading.problems),
        is_complete=reading.imported is not None,
    )
