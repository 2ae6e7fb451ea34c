"""Channel over an unreliable link: each message is delivered exactly once, and in order."""

import logging
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from pydantic import BaseModel, ValidationError

from argo_env.remote.messages import Envelope

_log = logging.getLogger(__name__)

REPEAT = 0.5
"""s between repetitions of unacknowledged messages; if there are none, an empty envelope is sent"""
_MAX_PENDING = 10_000  # messages to a peer that does not answer


class Link(Protocol):
    """Protocol of a connection that carries texts in both directions, but may lose them.

    Neither method waits.
    """

    def send(self, message: str) -> None:
        """Send a text; without a connection it is lost."""

    def receive(self) -> Sequence[str]:
        """Return the texts that have arrived since the last call."""


class Channel:
    """End of the channel; the other end is its peer.

    It holds the unacknowledged messages and the numbers that were received last. Posted messages
    are delivered once and in order, whatever the link does, as long as both processes live. A peer
    that has restarted (`restarts` counts this) gets the messages that had not been acknowledged.
    Messages that `receive` returned are acknowledged with the next `flush`, so act on them first.
    """

    def __init__(self, link: Link, session: str, clock: Callable[[], float]) -> None:
        """Start a session over the link.

        The `session` is a word that no other process has; the clock returns s.
        """
        self.restarts = 0
        """number of restarts of the peer"""
        self.last_received_at: float | None = None
        """s of the clock when an envelope of the peer was last received; None if never"""
        self._link = link
        self._session = session
        self._clock = clock
        self._peer: str | None = None
        self._former_sessions: set[str] = set()
        self._pending: list[dict[str, Any]] = []
        self._first = 1  # number of the first pending message
        self._last_received = 0  # number of the last message received from the peer
        self._sent = 0
        self._peer_sent = 0  # the highest `sent` of the peer's envelopes
        self._next_flush = 0.0  # s of the clock when all pending messages are sent again

    @property
    def pending(self) -> Sequence[dict[str, Any]]:
        """Bodies of the posted messages that the peer has not acknowledged yet, oldest first."""
        return tuple(self._pending)

    def post(self, message: BaseModel) -> None:
        """Queue a message, which `flush` sends repeatedly until the peer has acknowledged it.

        The next `flush` sends it. Raises OverflowError if too many messages are pending.
        """
        if len(self._pending) >= _MAX_PENDING:
            raise OverflowError(f"{_MAX_PENDING} messages wait for a peer that does not answer")
        self._pending.append(message.model_dump(mode="json", exclude_none=True))
        self._next_flush = 0.0

    def send_once(self, message: BaseModel) -> None:
        """Send a message now and only once; it may be lost. It is for states, which age anyway."""
        self._send(None, message.model_dump(mode="json", exclude_none=True))

    def flush(self) -> None:
        """Send all pending messages and acknowledge the received ones, if that is due.

        It is due REPEAT s after the last time, or at once after a `post` or a received message.
        Call it often.
        """
        now = self._clock()
        if now < self._next_flush:
            return
        self._next_flush = now + REPEAT
        pending = self._pending if self._peer is not None else []
        for number, body in enumerate(pending, start=self._first):
            self._send(number, body)
        if not pending:
            self._send(None, None)

    def receive(self) -> list[dict[str, Any]]:
        """Return the bodies of the messages that have arrived since the last call, each once.

        Invalid messages are left out, as are states that arrive after newer ones.
        """
        bodies = []
        for text in self._link.receive():
            try:
                envelope = Envelope.model_validate_json(text)
            except ValidationError as error:
                _log.warning("ignored an invalid message: %s", error.errors()[0]["msg"])
                continue
            body = self._accept(envelope)
            if body is not None:
                bodies.append(body)
        return bodies

    def _accept(self, envelope: Envelope) -> dict[str, Any] | None:
        """Record the envelope's acknowledgement, and return its body if it has to be acted on."""
        if envelope.sender in self._former_sessions:
            return None
        if envelope.sender != self._peer:
            self._start_session(envelope.sender)
        self.last_received_at = self._clock()
        newest, self._peer_sent = (
            envelope.sent > self._peer_sent,
            max(self._peer_sent, envelope.sent),
        )
        if envelope.to != self._session:
            return None
        while self._pending and self._first <= envelope.heard:
            self._pending.pop(0)
            self._first += 1
        if envelope.number is None:
            return envelope.body if newest else None
        self._next_flush = 0.0  # to acknowledge it
        if envelope.number != self._last_received + 1:
            return None
        self._last_received += 1
        return envelope.body

    def _start_session(self, session: str) -> None:
        """Restart the counts for a new session of the peer: its first, or one after a restart."""
        if self._peer is not None:
            self._former_sessions.add(self._peer)
            self.restarts += 1
        self._peer = session
        self._first, self._last_received, self._peer_sent, self._next_flush = 1, 0, 0, 0.0

    def _send(self, number: int | None, body: dict[str, Any] | None) -> None:
        self._sent += 1
        envelope = Envelope(
            sender=self._session,
            to=self._peer,
            sent=self._sent,
            number=number,
            heard=self._last_received,
            body=body,
        )
        self._link.send(envelope.model_dump_json(exclude_none=True))
