"""A channel over a link that loses, repeats and breaks off: messages come once, and in order."""

import logging
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from pydantic import BaseModel, ValidationError

from argo_env.remote.messages import Envelope

_log = logging.getLogger(__name__)

REPEAT = 0.5
"""s after which what was not acknowledged is sent again, and a sign of life if there is nothing"""
_MAX_PENDING = 10_000  # messages to an end that does not answer


class Link(Protocol):
    """What carries texts to the other end and back, or does not. Neither call waits."""

    def send(self, message: str) -> None:
        """Sends a text, if there is a connection."""

    def receive(self) -> Sequence[str]:
        """The texts that have come since the last call."""


class Channel:
    """One end. Holds what was not acknowledged, and what was heard of the other end.

    What is posted comes to the other end once and in order, whatever the link does, as long as
    both processes live. If the other one has begun anew (`restarts` counts it), it gets what had
    not been acknowledged. What `take` gives is acknowledged with the next `flush`, once it has been
    acted on.
    """

    def __init__(self, link: Link, session: str, clock: Callable[[], float]) -> None:
        """The `session` is a word that no other process has; the clock gives s."""
        self.restarts = 0
        """how often the other end began anew"""
        self.heard_at: float | None = None
        """s, by the clock, when the other end was heard last; None: never"""
        self._link = link
        self._session = session
        self._clock = clock
        self._other: str | None = None
        self._gone: set[str] = set()
        self._pending: list[dict[str, Any]] = []
        self._first = 1  # number of the first that is pending
        self._taken = 0  # the last number that was taken from the other end
        self._sent = 0
        self._seen = 0  # envelopes of the other end
        self._next = 0.0  # s, when all is sent again

    @property
    def pending(self) -> Sequence[dict[str, Any]]:
        """The bodies that were posted, and not acknowledged."""
        return tuple(self._pending)

    def post(self, message: BaseModel) -> None:
        """Sends a message until it is acknowledged."""
        if len(self._pending) >= _MAX_PENDING:
            raise OverflowError(f"{_MAX_PENDING} messages wait for an end that does not answer")
        self._pending.append(message.model_dump(mode="json", exclude_none=True))
        self._next = 0.0

    def tell(self, message: BaseModel) -> None:
        """Sends a message once, whether it arrives or not: a newer one will follow."""
        self._send(None, message.model_dump(mode="json", exclude_none=True))

    def flush(self) -> None:
        """Acknowledges what was taken, and sends what is due."""
        now = self._clock()
        if now < self._next:
            return
        self._next = now + REPEAT
        pending = self._pending if self._other is not None else []
        for number, body in enumerate(pending, start=self._first):
            self._send(number, body)
        if not pending:
            self._send(None, None)

    def take(self) -> list[dict[str, Any]]:
        """The bodies that have come since, each once."""
        taken = []
        for text in self._link.receive():
            try:
                envelope = Envelope.model_validate_json(text)
            except ValidationError as error:
                _log.warning("a message that makes no sense: %s", error.errors()[0]["msg"])
                continue
            body = self._open(envelope)
            if body is not None:
                taken.append(body)
        return taken

    def _open(self, envelope: Envelope) -> dict[str, Any] | None:
        """The envelope's body, if it is one to act on."""
        if envelope.sender in self._gone:
            return None
        if envelope.sender != self._other:
            self._meet(envelope.sender)
        self.heard_at = self._clock()
        newest, self._seen = envelope.sent > self._seen, max(self._seen, envelope.sent)
        if envelope.to != self._session:
            return None
        while self._pending and self._first <= envelope.heard:
            self._pending.pop(0)
            self._first += 1
        if envelope.number is None:
            return envelope.body if newest else None
        self._next = 0.0  # so that it is acknowledged
        if envelope.number != self._taken + 1:
            return None
        self._taken += 1
        return envelope.body

    def _meet(self, session: str) -> None:
        """The other end is there, for the first time or after it began anew."""
        if self._other is not None:
            self._gone.add(self._other)
            self.restarts += 1
        self._other = session
        self._first, self._taken, self._seen, self._next = 1, 0, 0, 0.0

    def _send(self, number: int | None, body: dict[str, Any] | None) -> None:
        self._sent += 1
        envelope = Envelope(
            sender=self._session,
            to=self._other,
            sent=self._sent,
            number=number,
            heard=self._taken,
            body=body,
        )
        self._link.send(envelope.model_dump_json(exclude_none=True))
