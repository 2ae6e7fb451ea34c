"""Rooms of the mission plans in a folder; a room is open while its plan is in use."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from functools import partial
from typing import TypeVar

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission
from argo_planner.service.jobs.analysis import Analyst
from argo_planner.service.rooms.room import PlanRoom
from argo_planner.service.storage.folder import PlanFolder
from argo_planner.service.storage.outline import PlanSummary

T = TypeVar("T")
MOST_OPEN = 50
"""rooms without members that stay open"""
MOST_THREADS = 4


class PlanRooms:
    """Open rooms of a folder's mission plans, one for each plan. Owns the folder."""

    def __init__(
        self,
        folder: PlanFolder,
        catalog: Catalog,
        analyst: Analyst | None,
        clock: Callable[[], datetime],
    ) -> None:
        self._folder = folder
        self._catalog = catalog
        self._analyst = analyst
        self._clock = clock
        self._rooms: dict[str, PlanRoom] = {}
        self._threads = ThreadPoolExecutor(MOST_THREADS, thread_name_prefix="plans")
        """Threads for plans only. An edit does not wait for other work that takes long."""
        self._turn = asyncio.Lock()
        self._listing = asyncio.Lock()  # separate from `_turn`: edits do not wait for lists

    async def list_plans(self) -> list[PlanSummary]:
        """Return summaries of all plans, the last changed ones first."""
        async with self._listing:
            open_plans = {id: room.summary() for id, room in self._rooms.items()}
            return await self._on_disk(self._folder.list_plans, open_plans)

    async def list_deleted(self) -> list[PlanSummary]:
        """Return summaries of the deleted plans, which are in the bin, the last changed first."""
        async with self._listing:
            return await self._on_disk(self._folder.list_deleted)

    async def create(self, name: str, mission: Mission, folder: str = "") -> PlanRoom:
        """Create a plan and return its open room; raises the errors of `PlanFolder.create`."""
        async with self._turn:
            file = await self._on_disk(self._folder.create, name, mission, self._clock(), folder)
            return self._add(
                PlanRoom(file, self._catalog, self._analyst, self._clock, self._threads)
            )

    async def open(self, id: str) -> PlanRoom:
        """Return the room of a plan, opened if needed; raises the errors of `PlanFolder.open`."""
        if (room := self._rooms.get(id)) is not None:
            return room
        async with self._turn:
            if (room := self._rooms.get(id)) is not None:
                return room
            file = await self._on_disk(self._folder.open, id)
            return self._add(
                PlanRoom(file, self._catalog, self._analyst, self._clock, self._threads)
            )

    def find_open(self, id: str) -> PlanRoom | None:
        """Return the room of a plan, or None if it is not open."""
        return self._rooms.get(id)

    def publish_world(self, revision: int) -> None:
        """Tell the members of all rooms that the obstacles have changed to this revision."""
        for room in self._rooms.values():
            room.publish_world(revision)

    async def delete(self, id: str) -> None:
        """Move a plan to the bin, tell its members, and close its room.

        Raises the errors of `PlanFolder.delete`; the room then stays open.
        """
        async with self._turn:
            move_file = partial(self._folder.delete, id)
            if (room := self._rooms.get(id)) is None:
                await self._on_disk(move_file)
            else:
                await room.close(move_file)
                self._rooms.pop(id, None)

    async def restore(self, id: str) -> PlanRoom:
        """Move a plan out of the bin and open its room; raises NotFound if it is not in the bin."""
        async with self._turn:
            await self._on_disk(self._folder.restore, id)
        return await self.open(id)

    async def delete_from_bin(self, id: str) -> None:
        """Delete a plan in the bin permanently; raises NotFound if the bin does not have it."""
        async with self._turn:
            await self._on_disk(self._folder.delete_from_bin, id)

    async def close(self) -> None:
        """Close all rooms and the folder."""
        for id, room in [*self._rooms.items()]:
            await room.close()
            self._rooms.pop(id, None)
        self._threads.shutdown()
        self._folder.close()

    async def _on_disk(self, work: Callable[..., T], *arguments: object) -> T:
        """Call a function in one of the threads for plans, and return its result."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._threads, partial(work, *arguments))

    def _add(self, room: PlanRoom) -> PlanRoom:
        self._rooms[room.document.id] = room
        idle = [id for id, other in self._rooms.items() if other.is_idle and other is not room]
        for id in idle[: max(0, len(idle) - MOST_OPEN)]:
            self._rooms.pop(id).close_at_once()
        return room
