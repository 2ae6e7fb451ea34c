"""Event feeds over WebSockets: that of a mission, and what all feeds share."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from itertools import count
from typing import Annotated

from fastapi import APIRouter, Query, WebSocket, WebSocketDisconnect
from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_compiler.base.message import Message
from argo_planner.service.rooms.mailbox import Mailbox, MailboxClosed
from argo_planner.service.rooms.messages import SelectTasks
from argo_planner.service.web.access import AccessRole, Visitor
from argo_planner.service.web.problems import problem_from_error, problem_response
from argo_planner.service.web.requests import PlanningService

router = APIRouter()

MAX_SOCKETS = 1_000
CLOSE_TOO_SLOW = 4408
"""close code: too many messages wait for the client, which should reconnect and resume"""
CLOSE_GONE = 4404
"""close code: the mission was deleted or closed"""
CLOSE_INVALID = 4400
"""close code: the client has sent an invalid message"""
_NUMBERS = count(1)


@router.websocket("/api/missions/{id}/live")
async def follow_mission(
    socket: WebSocket, id: str, since: Annotated[int | None, Query(ge=1)] = None
) -> None:
    """Send the messages of a mission's room, and receive the client's selection.

    The first messages are the mission or, if `since` is given and all later revisions are known,
    the revisions after `since`; see `PlanRoom.join`.
    """
    service: PlanningService = socket.app.state.service
    visitor: Visitor = socket.scope["visitor"]
    if not await accept_socket(socket, required_plan=id):
        return
    client = next_client_id()
    try:
        room = await service.rooms.open(id)
        mailbox = room.join(client, visitor.author, since)
    except ArgoError as error:
        await socket.close(CLOSE_GONE, str(error)[:100])
        return

    def receive_text(text: str) -> None:
        room.set_selection(client, SelectTasks.model_validate_json(text).names)

    try:
        await exchange_messages(socket, mailbox, receive_text)
    finally:
        room.leave(client)


def next_client_id() -> str:
    """Return a new identifier for a connection."""
    return f"c{next(_NUMBERS)}"


async def accept_socket(
    socket: WebSocket, role: AccessRole = AccessRole.VIEW, required_plan: str | None = None
) -> bool:
    """Accept a connection and return True, or refuse it with a problem and return False.

    Args:
        socket: The connection that a client has requested.
        role: Role that the client must have.
        required_plan: Id of a mission plan that must exist; None: the feed is of no plan.
    """
    visitor: Visitor = socket.scope["visitor"]
    try:
        visitor.require(role)
        if getattr(socket.app.state, "sockets", 0) >= MAX_SOCKETS:
            raise Unavailable(
                Message(
                    "{max_sockets} pages are open already: close some of them",
                    max_sockets=MAX_SOCKETS,
                )
            )
        if required_plan is not None:
            await socket.app.state.service.rooms.open(required_plan)
    except ArgoError as error:
        await socket.send_denial_response(problem_response(problem_from_error(error)))
        return False
    await socket.accept()
    return True


async def exchange_messages(
    socket: WebSocket, mailbox: Mailbox, receive_text: Callable[[str], None]
) -> None:
    """Send the mailbox's messages to the client until either side closes the connection.

    `receive_text` is called with each message of the client. A ValidationError that it raises
    closes the connection as invalid.
    """
    state = socket.app.state
    state.sockets = getattr(state, "sockets", 0) + 1
    tasks = [
        asyncio.ensure_future(_send_messages(socket, mailbox)),
        asyncio.ensure_future(_receive_messages(socket, receive_text)),
    ]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            with suppress(WebSocketDisconnect):
                task.result()
    except MailboxClosed as closed:
        code = CLOSE_TOO_SLOW if closed.too_slow else CLOSE_GONE
        await _finish_close(socket.close(code, str(closed)))
    except ValidationError as error:
        fault = error.errors(include_url=False, include_input=False)[0]
        await _finish_close(
            socket.close(
                CLOSE_INVALID, Message("invalid message: {fault}", fault=fault["msg"])[:100]
            )
        )
    finally:
        state.sockets -= 1
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _send_messages(socket: WebSocket, mailbox: Mailbox) -> None:
    while True:
        await socket.send_text(await mailbox.next_message())


async def _receive_messages(socket: WebSocket, receive_text: Callable[[str], None]) -> None:
    while True:
        message = await socket.receive()
        if message["type"] == "websocket.disconnect":
            return
        receive_text(message.get("text") or "")


async def _finish_close(closing: Awaitable[None]) -> None:
    # The client may have disconnected, or no longer read.
    with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
        await asyncio.wait_for(closing, 5)
