"""What waits to be sent to one client."""

import asyncio
from collections import deque
from collections.abc import Iterable

MOST_MESSAGES = 2_000
MOST_CHARACTERS = 16_000_000


class MailboxClosed(Exception):
    """Nothing more comes; the client is to be let go."""

    def __init__(self, reason: str, *, too_slow: bool = False) -> None:
        self.too_slow = too_slow
        super().__init__(reason)


class Mailbox:
    """Messages for one client, in order. Of poses only the newest one waits; nothing else is ever
    dropped: a client for which too much waits is let go, and resumes."""

    def __init__(self, past: Iterable[str] = ()) -> None:
        """`past`: what the client is told first, however much it is. Whoever has just come is not
        slow, and these texts are kept anyway."""
        self._messages: deque[str] = deque(past)
        self._past = len(self._messages)
        self._characters = 0
        self._newest: dict[str, str] = {}
        self._there = asyncio.Event()
        self._closed: MailboxClosed | None = None

    def post(self, message: str) -> None:
        """A message that has to arrive."""
        if self._closed is not None:
            return
        self._messages.append(message)
        self._characters += len(message)
        if len(self._messages) - self._past > MOST_MESSAGES or self._characters > MOST_CHARACTERS:
            self._messages.clear()
            self._past = 0
            self._newest.clear()
            self.close(MailboxClosed("too slow: connect again and resume", too_slow=True))
        self._there.set()

    def post_newest(self, kind: str, message: str) -> None:
        """A message that takes the place of the one of its kind that still waits."""
        if self._closed is None:
            self._newest[kind] = message
            self._there.set()

    def close(self, why: MailboxClosed) -> None:
        """What waits is still taken, then the reason is raised."""
        self._closed = self._closed or why
        self._there.set()

    async def take(self) -> str:
        """The next message: first those that have to arrive. Raises MailboxClosed at the end."""
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
            self._there.clear()
            await self._there.wait()
