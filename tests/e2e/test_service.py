"""`argo serve` from a shell: if it is killed and restarted, no acknowledged edit is lost."""

import asyncio
import json
import os
import signal
import socket
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from tests.argo_planner.service.test_live import Listener
from tests.argo_planner.service.test_plan import mission
from tests.conftest import examples
from tests.e2e.conftest import read_errors_until, start_argo
from tests.e2e.test_errors import require_refusal

TOKEN = "token-of-the-test-of-kills"
HEADERS = {"authorization": f"Bearer {TOKEN}"}


class ServiceProcess:
    """Process of `argo serve` that can be result and restarted at the same port."""

    def __init__(self, folder: Path) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.address = f"127.0.0.1:{self.port}"
        self.folder = folder

    def client(self, kind: Any = httpx.Client, timeout: float = 60) -> Any:
        """Return an HTTPX client of a class, with a token that has all rights."""
        return kind(base_url=f"http://{self.address}", headers=HEADERS, timeout=timeout)

    def begin(self) -> None:
        self.process = start_argo(
            *("serve", self.folder, "--port", self.port),
            stdout=None,
            env=os.environ | {"ARGO_TOKEN": TOKEN},
            start_new_session=True,  # a group of its own, as in a terminal
        )
        read_errors_until(self.process, "Ctrl-C")

    def end(self, number: int) -> str:
        """Send the process a signal and wait for its end; return its standard error."""
        self.process.send_signal(number)
        return self.process.communicate(timeout=60)[1] or ""

    def interrupt(self) -> str:
        """Send SIGINT to the whole process group, as Ctrl-C does; return its standard error."""
        os.killpg(self.process.pid, signal.SIGINT)
        return self.process.communicate(timeout=60)[1] or ""


@pytest.fixture
def service(tmp_path):
    service_process = ServiceProcess(tmp_path / "missions")
    service_process.begin()
    yield service_process
    if service_process.process.poll() is None:
        service_process.end(signal.SIGKILL)


@pytest.mark.everywhere
def test_the_service_starts_answers_and_ends(service: ServiceProcess) -> None:
    with service.client() as client:
        assert client.get("/api/service").json()["site"] == "umad"
    errors = service.end(signal.SIGINT)
    assert "Traceback" not in errors
    assert service.process.returncode in (0, 130)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--host", "0.0.0.0"], "give --token or --token-file"),
        (["--token", "short"], "at least 16 characters"),
        (["--token-file", "nothing"], "can't be read"),
        (["--site", "nowhere"], "nowhere"),
        (["--port", "70000"], "65535"),
        (["--host", "no.such.host.invalid", "--token", "x" * 20], "the service can't listen at"),
    ],
)
def test_wrong_options_are_refused(argo, tmp_path, options, message) -> None:
    assert message in require_refusal(argo("serve", tmp_path / "m", *options))


@pytest.mark.parametrize("damage", ["cut", "folder", "link"])
@pytest.mark.parametrize("command", [["serve"], ["plan", "--no-browser", "--folder"]])
def test_obstacles_that_can_not_be_read_are_refused_before_an_address_is_printed(
    argo, tmp_path, command, damage
) -> None:
    folder, elsewhere = tmp_path / "m", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.write_text("{}")
    path = folder / "obstacles.json"
    match damage:
        case "cut":
            path.write_text('{"checksum":"01234567","revision":2,"obst')
        case "folder":
            path.mkdir()
        case "link":
            path.symlink_to(elsewhere)
    refusal = require_refusal(argo(*command, folder, "--port", "0"))
    assert str(path) in refusal
    assert "restore the file from a copy, or delete it" in refusal
    assert "http" not in refusal


def start_evaluation(client: httpx.Client) -> str:
    """Start a long evaluation and wait for its first rows; return its id."""
    plan = client.post(
        "/api/missions",
        json={"name": "Round", "mission": mission("A", "B").model_dump(mode="json")},
    )
    assert plan.status_code == 201, plan.text
    begun = client.post(
        f"/api/missions/{plan.json()['id']}/evaluations",
        json={"worlds": 10_000},
        headers={"if-match": "*"},
    )
    assert begun.status_code == 202, begun.text
    job: str = begun.json()["id"]
    wait_for_rows(client, job)
    return job


def wait_for_rows(client: httpx.Client, job: str) -> None:
    while client.get(f"/api/jobs/{job}").json()["standing"] is None:
        time.sleep(0.1)


@pytest.mark.long
@pytest.mark.parametrize("end", ["Ctrl-C", "kill -9"])
def test_an_evaluation_ends_with_the_service_and_goes_on(service: ServiceProcess, end: str) -> None:
    with service.client() as client:
        job = start_evaluation(client)
    rows = service.folder / "evaluations" / job / "rows.log"
    if end == "Ctrl-C":
        assert service.interrupt() == "argo: interrupted\n"
    else:
        service.end(signal.SIGKILL)
        time.sleep(3)  # workers check once a second if the service still runs
    size = rows.stat().st_size
    time.sleep(1)
    assert rows.stat().st_size == size > 0, "a worker still runs"
    service.begin()
    with service.client() as client:
        assert client.get(f"/api/jobs/{job}").json()["state"] == "interrupted"
        assert client.post(f"/api/jobs/{job}/go_on").status_code == 202
        wait_for_rows(client, job)
    assert rows.stat().st_size >= size
    service.end(signal.SIGTERM)


@pytest.mark.long
def test_a_second_service_with_the_same_folder_is_refused(
    service: ServiceProcess, argo_process
) -> None:
    result = argo_process("serve", str(service.folder), "--port", "0", "--token", TOKEN)
    assert "another service uses this folder" in require_refusal(result)


class Subscriber(Listener):
    """Client that follows a mission, and connects again after the service was killed."""

    def __init__(self, service: ServiceProcess, id: str, author: str) -> None:
        self.url = f"ws://{service.address}/api/missions/{id}/live?author={author}"
        self.connections = 0

    async def follow(self) -> None:
        while True:
            since = "" if self.revision is None else f"&since={self.revision}"
            try:
                async with connect(
                    self.url + since, additional_headers=HEADERS, max_size=None, proxy=None
                ) as opened:
                    self.connections += 1
                    async for text in opened:
                        self.apply_message(json.loads(text))
            except (OSError, ConnectionClosed, InvalidHandshake, EOFError):  # killed at any moment
                await asyncio.sleep(0.2)


async def edit_until(
    stopped: asyncio.Event, service: ServiceProcess, id: str, acknowledged: Counter[str]
) -> int:
    """Send twenty edits a second, each until it is acknowledged; return the highest revision."""
    loop = asyncio.get_running_loop()
    number, highest = 0, 1
    async with service.client(httpx.AsyncClient, timeout=10) as client:
        while not stopped.is_set():
            number += 1
            edit = {"kind": "change_task", "name": f"t{number % 50}", "velocity": number / 1e4}
            body = {"kind": "edit", "id": f"e{number}", "edits": [edit]}
            due = loop.time() + 0.05
            while True:
                try:
                    answer = await client.post(
                        f"/api/missions/{id}/commands", json=body, headers={"if-match": "*"}
                    )
                except httpx.HTTPError:
                    await asyncio.sleep(0.1)
                    continue
                assert answer.status_code == 200, answer.text
                acknowledged[body["id"]] = answer.json()["revision"]["number"]
                highest = max(highest, answer.json()["newest"])
                break
            await asyncio.sleep(max(0.0, due - loop.time()))
    return highest


async def wait_for_connections(pages: Sequence[Subscriber], times: int) -> None:
    """Wait until each page has connected so many times, which takes seconds on a slow machine."""
    async with asyncio.timeout(60):
        while any(page.connections < times for page in pages):
            await asyncio.sleep(0.05)


async def edit_while_killing(
    service: ServiceProcess, seconds: float, subscribers: int, kills: int
) -> None:
    async with service.client(httpx.AsyncClient, timeout=30) as client:
        tasks = mission(*(f"t{k}" for k in range(50))).model_dump(mode="json")
        for task in tasks["tasks"]:
            task["object_id"] = "1"
        made = await client.post("/api/missions", json={"name": "Round", "mission": tasks})
        id = made.json()["id"]
    pages = [Subscriber(service, id, f"p{k}") for k in range(subscribers)]
    following = [asyncio.create_task(page.follow()) for page in pages]
    await wait_for_connections(pages, 1)
    acknowledged: Counter[str] = Counter()
    stopped = asyncio.Event()
    editing = asyncio.create_task(edit_until(stopped, service, id, acknowledged))
    for kill in range(kills):
        await asyncio.sleep(seconds / (kills + 1))
        await asyncio.to_thread(service.end, signal.SIGKILL)
        await asyncio.to_thread(service.begin)
        await wait_for_connections(pages, kill + 2)
    await asyncio.sleep(seconds / (kills + 1))
    stopped.set()
    highest = await editing
    async with service.client(httpx.AsyncClient) as client:
        state = (await client.get(f"/api/missions/{id}")).json()
    assert state["revision"] == highest
    assert sorted(acknowledged.values()) == [*range(2, highest + 1)], "lost, or done twice"
    async with asyncio.timeout(60):
        while any(page.revision != highest for page in pages):
            await asyncio.sleep(0.05)
            for task in following:
                assert not task.done(), task.exception()
    for page, task in zip(pages, following, strict=True):
        assert page.follower is not None
        assert page.follower.state == state["mission"]
        assert page.connections == kills + 1
        task.cancel()
    await asyncio.gather(*following, return_exceptions=True)


@pytest.mark.long
def test_nothing_is_lost_or_done_twice_when_the_service_is_killed(service: ServiceProcess) -> None:
    asyncio.run(edit_while_killing(service, seconds=4, subscribers=5, kills=1))


@pytest.mark.long
def test_fifty_subscribers_and_two_kills(service: ServiceProcess) -> None:
    asyncio.run(edit_while_killing(service, seconds=examples(60), subscribers=50, kills=2))
