"""The current run as the service knows it: its state, its log, its requests and its followers."""

import logging
from collections.abc import Iterable, Sequence

from argo_compiler.base.errors import ArgoError, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.runs.folder import DiskThread, RunFolder, StoredRun
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


class CurrentRun:
    """The run that was started last, if there was one.

    Holds its state, its log, its requests and the mailboxes of its followers. What must outlive the
    service is written to disk before a follower gets it.
    """

    def __init__(self, folder: RunFolder, disk: DiskThread) -> None:
        self._folder, self._disk = folder, disk
        self._stored: StoredRun | None = None
        self._essential_fields: tuple[object, ...] = ()
        """essential fields of the state on disk"""
        self._entries: list[str] = []
        """messages with the entries of the log, as JSON"""
        self._followers: dict[str, Mailbox] = {}
        self.book = RequestBook("")

    def replace_run_silently(
        self, stored: StoredRun, requests: Iterable[RequestState] = ()
    ) -> None:
        """Make another run the current one, with an empty log and its earlier requests.

        The run must be on disk already. `load_missing_entries` fills the log. Followers stay, and
        are sent nothing by this.
        """
        self._stored, self._essential_fields = stored, _essential_fields(stored.state)
        self._entries, self.book = [], RequestBook(stored.state.id, requests)

    @property
    def stored(self) -> StoredRun:
        """The current run with its order and state; only valid if a run was ever started."""
        assert self._stored is not None, "no run was started"
        return self._stored

    @property
    def state(self) -> RunState | None:
        """State of the run; None: no run was ever started."""
        return self._stored.state if self._stored else None

    def require_run(self, run: str) -> RunState:
        """Return the state of the run `run`; raises NotFound unless it is the current run."""
        state = self.state
        if state is None or state.id != run:
            raise NotFound(Message("run {run} is not the current run", run=repr(run[:40])))
        return state

    def list_entries(self, after_first: int, most: int) -> EntryList:
        """Return at most `most` entries of the log after the first `after_first` ones.

        The list is empty if the log has no more than those.
        """
        texts = self._entries[after_first : after_first + most]
        messages = [EntryTold.model_validate_json(text) for text in texts]
        entries = tuple(message.entry for message in messages)
        return EntryList(count=len(self._entries), entries=entries)

    @property
    def entry_count(self) -> int:
        """Number of entries in the log."""
        return len(self._entries)

    def subscribe(self, client: str, skip_first: int | None) -> Mailbox:
        """Add a follower with the id `client`, and return its mailbox.

        The mailbox gets the state of the run, then its entries without the first `skip_first` ones
        (None: all entries), then all further messages.
        """
        mailbox = Mailbox([self._state_text(), *self._entries[skip_first or 0 :]])
        self._followers[client] = mailbox
        return mailbox

    def unsubscribe(self, client: str) -> None:
        """Remove the follower with this id and its mailbox, if there is one."""
        self._followers.pop(client, None)

    def close(self, why: str) -> None:
        """Close the mailboxes of all followers; `why` is the reason that they are told."""
        for mailbox in self._followers.values():
            mailbox.close(MailboxClosed(why))

    async def load_missing_entries(self) -> None:
        """Add the entries that are in the journals, but did not arrive, and send them to followers.

        A process that was killed may have written entries that it could not send. The number of
        entries and the time in the run's state are set to those of the journals, if these have
        entries. Raises ArgoError if a journal can't be read.
        """
        run = self.stored.state.id
        entries = await self._disk.run(self._folder.load_entries, run)
        missing = [
            EntryTold.model_construct(run=run, number=number, entry=entry).model_dump_json()
            for number, entry in enumerate(entries[len(self._entries) :], len(self._entries) + 1)
        ]
        self._entries += missing
        self._post(*missing)
        if entries:
            update = {"entries": len(self._entries), "t": entries[-1].t}
            state = self.stored.state.model_copy(update=update)
            self._stored = self.stored.model_copy(update={"state": state})

    async def accept_request(self, request: RequestState) -> None:
        """Store a new request on disk and send it to followers; raises Unavailable if it can't."""
        self.book.update(request)
        try:
            file = self._folder.request_file(self.stored.state.id)
            await self._disk.run(file.append, [request])
        except ArgoError:
            self.book.remove(request.id)
            raise
        self._publish_request(self.book.find(request.id))

    async def apply_messages(self, messages: Sequence[Model]) -> None:
        """Update state, log and requests by messages of the run's process, and inform followers.

        The messages are applied in their order. Before that, the last state among them is written
        to disk if an essential field has changed, and so are the requests that are over. There may
        be very many messages, so this is done once for all of them.
        """
        await self._store(messages)
        stated = False
        for message in messages:
            match message:
                case StateTold(state=state) if state is not None:
                    self._stored = self.stored.model_copy(update={"state": state})
                    stated = True
                case RequestTold(request=request):
                    self.book.update(request)
                    self._publish_request(request)
                case EntryTold(number=number) if number > len(self._entries):
                    self._entries.append(text := message.model_dump_json())
                    self._post(text)
                case PoseTold():
                    self._post_newest("pose", message.model_dump_json())
        if stated:
            self._post_newest("state", self._state_text())

    async def _store(self, messages: Sequence[Model]) -> None:
        """Store the last state, if an essential field has changed, and the settled requests.

        A failure is only logged.
        """
        id = self.stored.state.id
        states = [m.state for m in messages if isinstance(m, StateTold) and m.state is not None]
        over = [m.request for m in messages if isinstance(m, RequestTold) and m.request.over]
        try:
            if states and _essential_fields(states[-1]) != self._essential_fields:
                stored = self.stored.model_copy(update={"state": states[-1]})
                await self._disk.run(self._folder.store, stored)
                self._essential_fields = _essential_fields(states[-1])
            if over:
                await self._disk.run(self._folder.request_file(id).append, over)
        except ArgoError as error:
            # The run itself continues, as its log is in its journals.
            _log.error("run %s: its state could not be stored: %s", id, error)

    def _publish_request(self, request: RequestState) -> None:
        """Post the state of a request; if it is over, first post the state of the run."""
        message = RequestTold.model_construct(run=self.stored.state.id, request=request)
        texts = [self._state_text()] if request.over else []
        self._post(*texts, message.model_dump_json())

    def _post(self, *texts: str) -> None:
        """Post texts to all followers; each of them must arrive, in this order."""
        for mailbox in self._followers.values():
            for text in texts:
                mailbox.post(text)

    def _post_newest(self, kind: str, text: str) -> None:
        for mailbox in self._followers.values():
            mailbox.post_newest(kind, text)

    def _state_text(self) -> str:
        return StateTold.model_construct(state=self.state).model_dump_json()


def _essential_fields(state: RunState) -> tuple[object, ...]:
    """Return the fields that a resumed run needs and that its journal does not have."""
    return state.status, state.skipped, state.revision, state.max_duration, state.speed
