"""The present run as the service knows it: how it stands, what has happened, what was asked."""

import logging
from collections.abc import Iterable, Sequence

from argo_compiler.base.errors import ArgoError, NotFound
from argo_compiler.base.model import Model
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.runs.folder import DiskThread, KeptRun, RunFolder
from argo_planner.service.runs.requests import RequestBook, RequestState
from argo_planner.service.runs.state import (
    EntryList,
    EntryTold,
    PoseTold,
    RequestTold,
    RunState,
    StateTold,
)

_log = logging.getLogger(__name__)


class PresentRun:
    """The last run that was begun, if there was one. Holds its state, its entries and its requests,
    and who follows. What has to outlive the service is kept on disk before anybody is told."""

    def __init__(self, folder: RunFolder, disk: DiskThread) -> None:
        self._folder, self._disk = folder, disk
        self._kept: KeptRun | None = None
        self._lasting: tuple[object, ...] = ()
        """of the state that was kept last"""
        self._entries: list[str] = []
        self._followers: dict[str, Mailbox] = {}
        self.book = RequestBook("")

    def become(self, kept: KeptRun, requests: Iterable[RequestState] = ()) -> None:
        """From now on it is another run, which is kept already."""
        self._kept, self._lasting = kept, _lasting(kept.state)
        self._entries, self.book = [], RequestBook(kept.state.id, requests)

    @property
    def kept(self) -> KeptRun:
        assert self._kept is not None, "no run was begun"
        return self._kept

    @property
    def state(self) -> RunState | None:
        """How it stands; None: there was none."""
        return self._kept.state if self._kept else None

    def of(self, run: str) -> RunState:
        """How it stands. Raises NotFound if that run is another one."""
        state = self.state
        if state is None or state.id != run:
            raise NotFound(f"run {run[:40]!r} is not the present one")
        return state

    def entries(self, since: int, most: int) -> EntryList:
        """What has happened after the first `since` entries."""
        told = [EntryTold.model_validate_json(t) for t in self._entries[since : since + most]]
        return EntryList(count=len(self._entries), entries=tuple(one.entry for one in told))

    @property
    def count(self) -> int:
        """How many entries there are."""
        return len(self._entries)

    def follow(self, client: str, since: int | None) -> Mailbox:
        """Somebody follows: first how it stands, then the entries after that number, then all that
        happens."""
        mailbox = Mailbox([self._state_text(), *self._entries[since or 0 :]])
        self._followers[client] = mailbox
        return mailbox

    def leave(self, client: str) -> None:
        """Somebody has gone."""
        self._followers.pop(client, None)

    def close(self, why: str) -> None:
        """Lets all who follow go."""
        for mailbox in self._followers.values():
            mailbox.close(MailboxClosed(why))

    async def read_entries(self) -> None:
        """What has happened, and until when, is what the journals say: more may be there than the
        process could tell. Raises ArgoError if they can't be read."""
        run = self.kept.state.id
        entries = await self._disk.do(self._folder.entries, run)
        news = [
            EntryTold.model_construct(run=run, number=number, entry=entry).model_dump_json()
            for number, entry in enumerate(entries[len(self._entries) :], len(self._entries) + 1)
        ]
        self._entries += news
        self._post(*news)
        if entries:
            update = {"entries": len(self._entries), "t": entries[-1].t}
            state = self.kept.state.model_copy(update=update)
            self._kept = self.kept.model_copy(update={"state": state})

    async def accept(self, request: RequestState) -> None:
        """Somebody has asked for something. Raises Unavailable if it can't be kept."""
        self.book.note(request)
        try:
            await self._disk.do(self._folder.requests(self.kept.state.id).keep, [request])
        except ArgoError:
            self.book.forget(request.id)
            raise
        self._tell_request(self.book.of(request.id))

    async def take(self, messages: Sequence[Model]) -> None:
        """Things have happened, in this order. Very many may happen at once: they are kept
        together."""
        await self._keep(messages)
        stated = False
        for message in messages:
            match message:
                case StateTold(state=state) if state is not None:
                    self._kept = self.kept.model_copy(update={"state": state})
                    stated = True
                case RequestTold(request=request):
                    self.book.note(request)
                    self._tell_request(request)
                case EntryTold(number=number) if number > len(self._entries):
                    self._entries.append(text := message.model_dump_json())
                    self._post(text)
                case PoseTold():
                    self._post_newest("pose", message.model_dump_json())
        if stated:
            self._post_newest("state", self._state_text())

    async def _keep(self, messages: Sequence[Model]) -> None:
        """Writes down the last state, if it differs in what a run that goes on needs, and the
        requests that are over."""
        id = self.kept.state.id
        states = [m.state for m in messages if isinstance(m, StateTold) and m.state is not None]
        over = [m.request for m in messages if isinstance(m, RequestTold) and m.request.over]
        try:
            if states and _lasting(states[-1]) != self._lasting:
                kept = self.kept.model_copy(update={"state": states[-1]})
                await self._disk.do(self._folder.keep, kept)
                self._lasting = _lasting(states[-1])
            if over:
                await self._disk.do(self._folder.requests(id).keep, over)
        except ArgoError as error:
            # The run itself goes on: what has happened in it is in its journal.
            _log.error("run %s: how it stands is not kept: %s", id, error)

    def _tell_request(self, request: RequestState) -> None:
        """A request that is over is told behind the state that it has brought about."""
        told = RequestTold.model_construct(run=self.kept.state.id, request=request)
        texts = [self._state_text()] if request.over else []
        self._post(*texts, told.model_dump_json())

    def _post(self, *texts: str) -> None:
        """Texts that have to arrive, in this order."""
        for mailbox in self._followers.values():
            for text in texts:
                mailbox.post(text)

    def _post_newest(self, kind: str, text: str) -> None:
        for mailbox in self._followers.values():
            mailbox.post_newest(kind, text)

    def _state_text(self) -> str:
        return StateTold.model_construct(state=self.state).model_dump_json()


def _lasting(state: RunState) -> tuple[object, ...]:
    """What a run that goes on needs to know, and its journal does not say."""
    return state.status, state.skipped, state.revision, state.max_duration, state.speed
