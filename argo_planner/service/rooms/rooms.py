"""The plans of a folder, those that are in use open."""

import asyncio
from collections.abc import Callable
from datetime import datetime
from functools import partial

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission
from argo_planner.service.jobs.analysis import Analyst
from argo_planner.service.rooms.room import PlanRoom
from argo_planner.service.storage.folder import PlanFolder, summary_of
from argo_planner.service.storage.outline import PlanSummary

MOST_OPEN = 50
"""rooms without anybody in them that stay open"""


class PlanRooms:
    """Opens plans when they are asked for, one room each. Holds the folder."""

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
        self._turn = asyncio.Lock()
        self._listing = asyncio.Lock()  # lists are only read: nobody's edits wait for them

    async def plans(self) -> list[PlanSummary]:
        """All plans, the newest ones first."""
        async with self._listing:
            opened = {id: summary_of(room.document) for id, room in self._rooms.items()}
            return await asyncio.to_thread(self._folder.plans, opened)

    async def deleted(self) -> list[PlanSummary]:
        """Those in the bin."""
        async with self._listing:
            return await asyncio.to_thread(self._folder.deleted)

    async def create(self, name: str, mission: Mission) -> PlanRoom:
        """A new plan. Raises what `PlanFolder.create` raises."""
        async with self._turn:
            file = await asyncio.to_thread(self._folder.create, name, mission, self._clock())
            return self._opened(PlanRoom(file, self._catalog, self._analyst, self._clock))

    async def open(self, id: str) -> PlanRoom:
        """The plan with that id. Raises what `PlanFolder.open` raises."""
        if (room := self._rooms.get(id)) is not None:
            return room
        async with self._turn:
            if (room := self._rooms.get(id)) is not None:
                return room
            file = await asyncio.to_thread(self._folder.open, id)
            return self._opened(PlanRoom(file, self._catalog, self._analyst, self._clock))

    def opened(self, id: str) -> PlanRoom | None:
        """The plan with that id, if it is open."""
        return self._rooms.get(id)

    def tell_of_world(self, revision: int) -> None:
        """That the obstacles on the site have changed is told to all who have a plan open."""
        for room in self._rooms.values():
            room.tell_of_world(revision)

    async def delete(self, id: str) -> None:
        """Moves a plan to the bin; whoever has it open is told. Raises NotFound, Conflict."""
        async with self._turn:
            deleting = partial(self._folder.delete, id)
            if (room := self._rooms.get(id)) is None:
                await asyncio.to_thread(deleting)
            else:
                await room.close(deleting)
                self._rooms.pop(id, None)

    async def restore(self, id: str) -> PlanRoom:
        """Takes a plan out of the bin. Raises NotFound."""
        async with self._turn:
            await asyncio.to_thread(self._folder.restore, id)
        return await self.open(id)

    async def destroy(self, id: str) -> None:
        """Deletes a plan in the bin for good. Raises NotFound."""
        async with self._turn:
            await asyncio.to_thread(self._folder.destroy, id)

    async def close(self) -> None:
        """Closes all of them, and the folder."""
        for id, room in [*self._rooms.items()]:
            await room.close()
            self._rooms.pop(id, None)
        self._folder.close()

    def _opened(self, room: PlanRoom) -> PlanRoom:
        self._rooms[room.document.id] = room
        idle = [id for id, other in self._rooms.items() if other.empty and other is not room]
        for id in idle[: max(0, len(idle) - MOST_OPEN)]:
            self._rooms.pop(id).close_idle()
        return room
