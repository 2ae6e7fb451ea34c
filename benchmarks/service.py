"""How fast the planning service answers, with a service in a process of its own.

    python -m benchmarks.service            # edits, and how soon others see them
    python -m benchmarks.service --tasks 2000 --edits 200

Prints, for missions of several sizes, how long a durable edit takes (ms, from the request to the
answer, when it is on disk), and when the last of 50 subscribers has it; once more while one
subscriber hears nothing. The times are medians and 95 % of the edits took no longer.
"""

import argparse
import asyncio
import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import Pipe, Process
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median, quantiles

import httpx
from websockets.asyncio.client import connect

TOKEN = "benchmark-of-the-service"
HEADERS = {"authorization": f"Bearer {TOKEN}"}
SIZES = (200, 2_000)


@contextmanager
def service(folder: Path) -> Iterator[tuple[str, int]]:
    """A service of its own; its address and its process."""
    command = [sys.executable, "-m", "argo_planner", "serve", str(folder), "--port", "0"]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, env=os.environ | {"ARGO_TOKEN": TOKEN}
    )
    assert process.stderr is not None
    try:
        for line in process.stderr:
            if "http://" in line:
                address = line.partition("http://")[2].strip().strip("/")
                break
        threading.Thread(target=process.stderr.read, daemon=True).start()
        yield address, process.pid
    finally:
        process.terminate()
        process.wait()


def mission(size: int) -> dict[str, object]:
    """Measurements, one after the other, with a group of ten each."""
    tasks = [
        {
            "name": f"t{k}",
            "action": "MEASURE",
            "object_id": str(k % 20 + 1),
            "transitions": [{"target": f"t{k + 1}"}] if k + 1 < size else [],
        }
        for k in range(size)
    ]
    groups = [
        {"name": f"g{k}", "start": f"t{k}", "end": f"t{k + 9}", "max_repeat_count": 2}
        for k in range(0, size - 10, 20)
    ]
    return {"version": 3, "tasks": tasks, "groups": groups}


def follow(address: str, id: str, revisions: int, count: int, times: Connection) -> None:
    """In a process of its own: that many subscribers hear of so many revisions. Sends, for each
    revision, when (s) the last of them had it."""

    async def one(last: Counter[int], ready: asyncio.Semaphore) -> None:
        url = f"ws://{address}/api/missions/{id}/live"
        async with connect(url, additional_headers=HEADERS, max_size=None, proxy=None) as socket:
            await socket.recv()
            ready.release()
            heard = 0
            while heard < revisions:
                text = await socket.recv()
                if text.startswith('{"kind":"revision"'):
                    heard += 1
                    number = json.loads(text)["revision"]["number"]
                    last[number] = max(last[number], time.perf_counter_ns())

    async def all_of_them() -> Counter[int]:
        last: Counter[int] = Counter()
        ready = asyncio.Semaphore(0)
        tasks = [asyncio.create_task(one(last, ready)) for _ in range(count)]
        for _ in range(count):
            await ready.acquire()
        times.send(None)
        await asyncio.gather(*tasks)
        return last

    times.send(asyncio.run(all_of_them()))


def show(name: str, seconds: Sequence[float]) -> None:
    """Prints a median, and what 95 of a hundred did not exceed."""
    cuts = quantiles(seconds, n=20)
    print(f"  {name:52s} {median(seconds) * 1e3:7.1f} {cuts[-1] * 1e3:7.1f} ms", flush=True)


def measure(address: str, size: int, edits: int, subscribers: int) -> None:
    """Prints how long edits of a mission of that size take."""
    with httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client:
        made = client.post("/api/missions", json={"name": f"{size}", "mission": mission(size)})
        id = made.raise_for_status().json()["id"]
        revision = 1
        for heard, stalled in ((0, False), (subscribers, False), (subscribers, True)):
            with ExitStack() as stack:
                if stalled:
                    stack.enter_context(stalled_client(address, id))
                here, there = Pipe()
                followers = Process(target=follow, args=(address, id, edits, heard, there))
                followers.start()
                here.recv()
                took, sent = [], {}
                for k in range(edits):
                    begun = time.perf_counter_ns()
                    edit(client, id, revision, f"t{size // 2 + k % 50}", 0.1 + revision / 1e5)
                    took.append((time.perf_counter_ns() - begun) / 1e9)
                    revision += 1
                    sent[revision] = begun
                    time.sleep(0.05)
                last = here.recv()
                followers.join()
            what = f"{size} tasks, {heard} subscribers" + (", one hears nothing" * stalled)
            show(f"{what}: edit", took)
            if heard:
                show(f"{what}: seen by all", [(last[n] - at) / 1e9 for n, at in sent.items()])


def edit(client: httpx.Client, id: str, revision: int, task: str, velocity: float) -> None:
    """Changes a task's speed (m/s)."""
    change = {"kind": "change_task", "name": task, "velocity": velocity}
    body = {"kind": "edit", "id": f"e{revision}", "edits": [change]}
    headers = {"if-match": f'"{revision}"'}
    client.post(f"/api/missions/{id}/commands", json=body, headers=headers).raise_for_status()


@contextmanager
def stalled_client(address: str, id: str) -> Iterator[None]:
    """A client that opens a mission, and then reads nothing."""
    host, _, port = address.partition(":")
    with socket.create_connection((host, int(port))) as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.sendall(
            f"GET /api/missions/{id}/live HTTP/1.1\r\nHost: {address}\r\n"
            f"Authorization: Bearer {TOKEN}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {'A' * 22}==\r\n\r\n".encode()
        )
        yield


def main() -> None:
    """Prints all of it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--tasks", type=int, nargs="*", default=SIZES)
    parser.add_argument("--edits", type=int, default=200)
    parser.add_argument("--subscribers", type=int, default=50)
    options = parser.parse_args()
    print(f"  {'':52s}  median    95 %")
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as (address, _):
        for size in options.tasks:
            measure(address, size, options.edits, options.subscribers)


if __name__ == "__main__":
    main()
