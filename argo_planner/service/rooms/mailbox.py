"""Queue of messages for one client."""

import asyncio
from collections import deque
from collections.abc import Iterable

from argo_compiler.base.message import Message

MOST_MESSAGES = 2_000
MOST_CHARACTERS = 16_000_000


class MailboxClosed(Exception):
    """Raised when a mailbox has no further messages; the client is to be disconnected."""

    def __init__(self, reason: str, *, too_slow: bool = False) -> None:
        self.too_slow = too_slow
        super().__init__(reason)


class Mailbox:
    """Queue of messages for one client, in order.

    A message of `post_newest` replaces the waiting one of its kind. No other message is ever
    dropped: a client for which too many messages wait is disconnected, and may resume.
    """

    def __init__(self, past: Iterable[str] = ()) -> None:
        """Create a mailbox that begins with messages `past`, which don't count towards the limits.

        A client that has just connected is not slow, and these texts are in memory anyway.
        """
        self._messages: deque[str] = deque(past)
        self._past = len(self._messages)
        self._characters = 0
        self._newest: dict[str, str] = {}
        self._changed = asyncio.Event()
        self._closed: MailboxClosed | None = None

    def post(self, message: str) -> None:
        """Add a message, which no later message replaces; does nothing if the mailbox is closed.

        If too many messages then wait, all that wait are removed, this one and those of
        `post_newest` included, and the mailbox is closed as too slow.
        """
        if self._closed is not None:
            return
        self._messages.append(message)
        self._characters += len(message)
        if len(self._messages) - self._past > MOST_MESSAGES or self._characters > MOST_CHARACTERS:
            self._messages.clear()
            self._past = 0
            self._newest.clear()
            self.close(MailboxClosed(Message("too slow: connect again and resume"), too_slow=True))
        self._changed.set()

    def post_newest(self, kind: str, message: str) -> None:
        """Add a message that replaces the waiting message of the same `kind`, if there is one.

        It takes the place of that message. Does nothing if the mailbox is closed.
        """
        if self._closed is None:
            self._newest[kind] = message
            self._changed.set()

    def close(self, why: MailboxClosed) -> None:
        """Close the mailbox: after the waiting messages, `next_message` raises the reason."""
        self._closed = self._closed or why
        self._changed.set()

    async def next_message(self) -> str:
        """Remove and return the next message; messages of `post` precede those of `post_newest`.

        Waits for one if there is none. Raises MailboxClosed if the mailbox is closed and empty.
        """
        while True:
            if self._messages:
                message = self._messages.popleft()
                if self._past > 0:
                    self._past -= 1
                else:
                    self._characters -= len(message)
                return message
            if self._newest:
                return self._newest.pop(next(iter(self._newest)))
            if self._closed is not None:
                raise self._closed
            self._changed.clear()
            await self._changed.wait()
