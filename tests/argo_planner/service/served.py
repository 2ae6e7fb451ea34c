"""Service under test: a real server with its own socket, in a thread of this process."""

import asyncio
import json
import socket
import stat
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

import httpx
import uvicorn
from websockets.sync.client import ClientConnection, connect

from argo_env.planning.opening import OpenedSite
from argo_planner.service.rooms.mailbox import Mailbox
from argo_planner.service.web.access import AccessRole, AccessToken, TokenBook
from argo_planner.service.web.app import make_app
from argo_planner.service.web.connections import server_options
from argo_planner.service.web.guard import LOOPBACK, Guard, GuardSettings
from argo_planner.service.web.serving import listen, make_service_opener, open_plan_folder
from argo_planner.service.world.obstacle_store import ObstacleStore

ALL = "all-may-be-done-with-this"
SECRETS = {
    AccessRole.OPERATE: "operator-of-the-robot",
    AccessRole.PLAN: "planner-of-missions",
    AccessRole.VIEW: "viewer-of-everything",
}
_IDS = count(1)


class Served:
    """Running service, with clients for it. `client` has all rights, and the name `ann`."""

    def __init__(self, folder: Path, address: str) -> None:
        self.folder = folder
        self.address = address
        self.closing = ExitStack()
        self.client = self.as_("ann")

    def as_(self, author: str, secret: str = ALL) -> httpx.Client:
        headers = {"authorization": f"Bearer {secret}", "argo-author": author}
        client = httpx.Client(base_url=f"http://{self.address}", headers=headers, timeout=60)
        return self.closing.enter_context(client)

    def follow(self, id: str, author: str = "ann", since: int | None = None) -> ClientConnection:
        query = f"?author={author}" + ("" if since is None else f"&since={since}")
        return self.socket(f"/api/missions/{id}/live{query}", {"authorization": f"Bearer {ALL}"})

    def socket(self, path: str, headers: dict[str, str]) -> ClientConnection:
        """Return a WebSocket, which is closed at the end of the tests at the latest."""
        opening = connect(
            f"ws://{self.address}{path}", additional_headers=headers, max_size=None, proxy=None
        )
        return self.closing.enter_context(opening)

    def create(self, name: str = "Round", mission: Any = None) -> str:
        body = {"name": name} | ({} if mission is None else {"mission": mission})
        answer = self.client.post("/api/missions", json=body)
        assert answer.status_code == 201, answer.text
        id: str = answer.json()["id"]
        return id

    def command(
        self,
        id: str,
        revision: int | str,
        *edits: Any,
        client: httpx.Client | None = None,
        **fields: Any,
    ) -> httpx.Response:
        body = (
            {"kind": "edit", "id": f"k{next(_IDS)}"} | ({"edits": edits} if edits else {}) | fields
        )
        used = client or self.client
        return used.post(f"/api/missions/{id}/commands", json=body, headers=_if_match(revision))

    def post(self, path: str, revision: int | str | None = None, **body: Any) -> httpx.Response:
        """Post a body, with the revision it was made on, if one is given."""
        headers = {} if revision is None else _if_match(revision)
        return self.client.post(path, json=body, headers=headers)

    def mission(self, id: str) -> Any:
        return self.client.get(f"/api/missions/{id}").json()["mission"]

    def imported(self, script: str, filename: str = "m.txt", **areas: int) -> str:
        """Import a script, and return the id of its mission."""
        params = {"filename": filename} | areas
        answer = self.client.post("/api/imports", params=params, content=script)
        assert answer.status_code == 201, answer.text
        id: str = answer.json()["id"]
        return id

    def run(
        self, id: str, revision: int | str = "*", client: httpx.Client | None = None, **order: Any
    ) -> httpx.Response:
        """Request a run of a mission."""
        used = client or self.client
        return used.post(f"/api/missions/{id}/runs", json=order, headers=_if_match(revision))

    def put_obstacles(self, *obstacles: Any, revision: int | str = "*") -> httpx.Response:
        """Replace the obstacles."""
        body = {"obstacles": obstacles}
        return self.client.put("/api/world/obstacles", json=body, headers=_if_match(revision))


def _if_match(revision: int | str) -> dict[str, str]:
    return {"if-match": revision if isinstance(revision, str) else f'"{revision}"'}


@contextmanager
def served(folder: Path, site: OpenedSite) -> Iterator[Served]:
    """Serve the missions of a folder; all threads end with the context."""
    tokens = [AccessToken(ALL), *(AccessToken(s, role, str(role)) for role, s in SECRETS.items())]
    plans = open_plan_folder(folder)
    app = make_app(make_service_opener(plans, ObstacleStore(folder), site))
    guard = Guard(app, TokenBook(tokens), GuardSettings(frozenset(LOOPBACK)))
    listening = listen("127.0.0.1", 0)
    server = uvicorn.Server(uvicorn.Config(guard, **server_options()))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    thread.start()
    try:
        wait_or_fail(lambda: server.started or not thread.is_alive())
        assert thread.is_alive(), "the service has not started"
        with (running := Served(folder, f"127.0.0.1:{listening.getsockname()[1]}")).closing:
            yield running
    finally:
        server.should_exit = True
        thread.join(30)
        listening.close()
        assert not thread.is_alive()


def wait_or_fail(done: Callable[[], bool]) -> None:
    """Wait until `done` returns True; fail if that takes minutes, as it never happens then."""
    end = time.monotonic() + 180
    while not done():
        assert time.monotonic() < end, "what the test waits for has not happened"
        time.sleep(0.01)


def send_raw(address: str, content: bytes, most: int = 1_000_000) -> bytes:
    """Send bytes that no HTTP library would send, and return the answer."""
    host, _, port = address.partition(":")
    with socket.create_connection((host, int(port)), timeout=30) as connection:
        with suppress(BrokenPipeError, ConnectionResetError):
            connection.sendall(content)
        answer = b""
        with suppress(ConnectionResetError):
            while len(answer) < most and (part := connection.recv(65_536)):
                answer += part
        return answer


async def waiting_messages(mailbox: Mailbox, kind: str) -> list[dict[str, Any]]:
    """Return all waiting messages of a kind."""
    messages = []
    while True:
        try:
            message = json.loads(await asyncio.wait_for(mailbox.next_message(), 0.05))
        except TimeoutError:
            return messages
        if message["kind"] == kind:
            messages.append(message)


def require_private(folder: Path) -> None:
    """Require that only the owner can read a folder and all that is in it.

    A file that is removed meanwhile, such as a draft, does not count.
    """
    modes = {}
    for path in (folder, *folder.rglob("*")):
        with suppress(FileNotFoundError):
            modes[path] = path.stat().st_mode
    allowed = {path: 0o700 if stat.S_ISDIR(mode) else 0o600 for path, mode in modes.items()}
    assert {path: stat.S_IMODE(mode) for path, mode in modes.items()} == allowed
