"""A mission as it changes, over a WebSocket."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from itertools import count
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.rooms.messages import SelectTasks
from argo_planner.service.web.access import AccessRole, Visitor
from argo_planner.service.web.problems import answer, problem_of
from argo_planner.service.web.requests import PlanningService

router = APIRouter()

MOST_SOCKETS = 1_000
TOO_SLOW = 4408
"""close code: too much waited to be sent; connect again and resume"""
GONE = 4404
"""close code: the mission was deleted or closed"""
WRONG = 4400
"""close code: what was sent is no message"""
_NUMBERS = count(1)


@router.websocket("/api/missions/{id}/live")
async def follow(
    socket: WebSocket, id: str, since: Annotated[int | None, Query(ge=1)] = None
) -> None:
    """First the whole mission, or what happened `since` a revision, then all that happens."""
    service: PlanningService = socket.app.state.service
    visitor: Visitor = socket.scope["visitor"]
    if not await admitted(socket, plan=id):
        return
    client = socket_client()
    try:
        room = await service.rooms.open(id)
        mailbox = room.join(client, visitor.author, since)
    except ArgoError as error:
        await socket.close(GONE, str(error)[:100])
        return

    def heard(text: str) -> None:
        room.select(client, SelectTasks.model_validate_json(text).names)

    try:
        await carry(socket, mailbox, heard)
    finally:
        room.leave(client)


def socket_client() -> str:
    """What a connection is called."""
    return f"c{next(_NUMBERS)}"


async def admitted(
    socket: WebSocket, role: AccessRole = AccessRole.VIEW, plan: str | None = None
) -> bool:
    """Return whether a connection is taken, to a plan if one is named. A client that is refused is
    told why."""
    visitor: Visitor = socket.scope["visitor"]
    try:
        visitor.require(role)
        if getattr(socket.app.state, "sockets", 0) >= MOST_SOCKETS:
            raise Unavailable(f"{MOST_SOCKETS} pages are open already: close some of them")
        if plan is not None:
            await socket.app.state.service.rooms.open(plan)
    except ArgoError as error:
        await socket.send_denial_response(answer(problem_of(error)))
        return False
    await socket.accept()
    return True


async def carry(socket: WebSocket, mailbox: Mailbox, heard: Callable[[str], None]) -> None:
    """Sends what comes into the mailbox, and tells what the client says, until one of them ends."""
    state = socket.app.state
    state.sockets = getattr(state, "sockets", 0) + 1
    working = [
        asyncio.ensure_future(_sending(socket, mailbox)),
        asyncio.ensure_future(_hearing(socket, heard)),
    ]
    try:
        done, _ = await asyncio.wait(working, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            with suppress(WebSocketDisconnect):
                task.result()
    except MailboxClosed as closed:
        code = TOO_SLOW if closed.too_slow else GONE
        await _closed(socket.close(code, str(closed)))
    except ValidationError as error:
        fault = error.errors(include_url=False, include_input=False)[0]
        await _closed(socket.close(WRONG, f"no message: {fault['msg']}"[:100]))
    finally:
        state.sockets -= 1
        for task in working:
            task.cancel()
        await asyncio.gather(*working, return_exceptions=True)


async def _sending(socket: WebSocket, mailbox: Mailbox) -> None:
    while True:
        await socket.send_text(await mailbox.next_message())


async def _hearing(socket: WebSocket, heard: Callable[[str], None]) -> None:
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
        heard(message.get("text") or "")


async def _closed(closing: Awaitable[None]) -> None:
    # The other side may be gone, or not read any more.
    with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
        await asyncio.wait_for(closing, 5)
