"""Storing that is tried again until it succeeds, such as after a full disk."""

import asyncio
import logging
from collections.abc import Callable
from typing import Generic, TypeVar

from argo_compiler.base.errors import ArgoError

_log = logging.getLogger(__name__)
STORING_PERIOD = 5.0
"""s between two attempts to store what could not be stored, for example on a full disk"""

T = TypeVar("T")


class RetriedStorage(Generic[T]):
    """Items by their ids, each stored as soon as that is possible. Mutable: items are pending."""

    def __init__(
        self,
        store: Callable[[T], None],
        turn: asyncio.Lock,
        on_late_success: Callable[[T], None] = lambda _: None,
    ) -> None:
        """Create a storage without pending items.

        Args:
            store: Function that stores an item, called in a thread; raises ArgoError if it fails.
            turn: Lock that is held while pending items are stored.
            on_late_success: Function that is called with an item that was stored later.
        """
        self._store = store
        self._turn = turn
        self._on_late_success = on_late_success
        self._pending: dict[str, T] = {}
        self._retrying: asyncio.Task[None] | None = None

    async def store_or_retry_later(self, id: str, item: T) -> ArgoError | None:
        """Store an item, while the caller holds the turn.

        If that fails, the error is logged and returned, and storing is tried again later.
        """
        try:
            await asyncio.to_thread(self._store, item)
        except ArgoError as error:
            _log.error("%s", error)
            self._pending[id] = item
            if self._retrying is None or self._retrying.done():
                self._retrying = asyncio.create_task(self._retry())
            return error
        return None

    def discard_pending(self, is_discarded: Callable[[T], bool]) -> None:
        """Discard the pending items for which `is_discarded` is True; the caller holds the turn."""
        self._pending = {id: one for id, one in self._pending.items() if not is_discarded(one)}

    async def close(self) -> None:
        """Try once more to store the pending items, and then no more."""
        if self._retrying is not None:
            self._retrying.cancel()
        async with self._turn:
            await self._store_pending()

    async def _retry(self) -> None:
        while self._pending:
            await asyncio.sleep(STORING_PERIOD)
            async with self._turn:
                await self._store_pending()

    async def _store_pending(self) -> None:
        for id, item in [*self._pending.items()]:
            try:
                await asyncio.to_thread(self._store, item)
            except ArgoError as error:
                _log.error("%s", error)
            else:
                del self._pending[id]
                self._on_late_success(item)
