"""How fast the planning service answers, with a service in a process of its own.

    python -m benchmarks.service            # edits, and how soon others see them
    python -m benchmarks.service --tasks 2000 --edits 200
    python -m benchmarks.service --poses   # and what it costs to tell where the robot is

Prints, for missions of several sizes, how long a durable edit takes (ms, from the request to the
answer, when it is on disk), and when the last of 50 subscribers has it; once more while one
subscriber hears nothing. The times are medians and 95 % of the edits took no longer. Of poses it
prints how many a second each of 50 followers of a run gets, the gaps between them, and the share of
a core that the service takes for that.
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
    reader = threading.Thread(target=process.stderr.read, daemon=True)
    try:
        for line in process.stderr:
            if "http://" in line:
                address = line.partition("http://")[2].strip().strip("/")
                break
        reader.start()
        yield address, process.pid
    finally:
        process.terminate()
        process.wait()
        if reader.ident is not None:
            reader.join()
        process.stderr.close()


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


def follow_poses(address: str, count: int, seconds: float, gaps: Connection) -> None:
    """In a process of its own: that many followers of the robot for a time (s). Sends all gaps (s)
    between the poses that one follower gets."""

    async def one() -> list[float]:
        url = f"ws://{address}/api/robot/live?since=1000000000"
        found: list[float] = []
        async with connect(url, additional_headers=HEADERS, max_size=None, proxy=None) as socket:
            last, ends = None, time.perf_counter() + seconds
            while (now := time.perf_counter()) < ends:
                text = await socket.recv()
                if text.startswith('{"kind":"pose"'):
                    now = time.perf_counter()
                    if last is not None:
                        found.append(now - last)
                    last = now
        return found

    async def all_of_them() -> list[float]:
        return [
            gap for gaps in await asyncio.gather(*(one() for _ in range(count))) for gap in gaps
        ]

    gaps.send(asyncio.run(all_of_them()))


def measure_poses(address: str, process: int, followers: int, seconds: float = 20.0) -> None:
    """Prints what it costs to tell many where the robot is."""
    with httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client:
        made = client.post("/api/missions", json={"name": "poses", "mission": mission(200)})
        id = made.raise_for_status().json()["id"]
        # At three times real time each step of 0.1 s is told, so that there are 30 a second.
        order = {"drive": "route", "speed": 3.0}
        begun = client.post(f"/api/missions/{id}/runs", json=order, headers={"if-match": "*"})
        run = begun.raise_for_status().json()["id"]
        while client.get(f"/api/runs/{run}").json()["status"] != "running":
            time.sleep(0.1)
        for count in (0, followers):
            here, there = Pipe()
            listening = Process(target=follow_poses, args=(address, count, seconds, there))
            listening.start()
            time.sleep(1.0)
            before, at = busy(process), time.perf_counter()
            time.sleep(seconds - 2.0)
            share = (busy(process) - before) / (time.perf_counter() - at)
            gaps = here.recv()
            listening.join()
            text = f"  {count} followers of a run: {share:.1%} of a core"
            if gaps:
                cuts = quantiles(gaps, n=100)
                text += (
                    f", {1 / (sum(gaps) / len(gaps)):.0f} poses a second each, gaps "
                    f"{median(gaps) * 1e3:.0f} ms, 99 % up to {cuts[-1] * 1e3:.0f} ms"
                )
            print(text, flush=True)
        client.post(f"/api/runs/{run}/requests", json={"kind": "stop", "id": "stop"})


def busy(process: int) -> float:
    """s that a process has worked so far, without those that it has begun."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


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
    parser.add_argument("--poses", action="store_true", help="of poses only")
    options = parser.parse_args()
    print(f"  {'':52s}  median    95 %")
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as (address, process):
        measure_poses(address, process, options.subscribers)
        for size in () if options.poses else options.tasks:
            measure(address, size, options.edits, options.subscribers)


if __name__ == "__main__":
    main()
