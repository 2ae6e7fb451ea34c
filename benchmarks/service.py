"""Speed of the planning service, with a service in a process of its own.

    python -m benchmarks.service            # poses, edits, and when subscribers receive edits
    python -m benchmarks.service --tasks 2000 --edits 200
    python -m benchmarks.service --poses    # only the poses of a running robot

Prints for missions of several sizes how long a durable edit takes (ms, from the request to the
answer, when the edit is on disk), and when the last of 50 subscribers has received it; then the
same with one more client that reads nothing. The times are the median and the 95th percentile. For
poses it prints how many a second each of 50 followers of a run receives, the gaps between them, and
the share of a core that the service needs for them.
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
def start_service(folder: Path, *options: str) -> Iterator[tuple[str, int]]:
    """Start a service with more options, yield its address and process id, and end it."""
    command = [sys.executable, "-m", "argo_planner", "serve", str(folder), "--port", "0", *options]
    environment = os.environ | ({} if "--token-file" in options else {"ARGO_TOKEN": TOKEN})
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "http://" in line:
                address = line.partition("http://")[2].strip().strip("/")
                break
        rest = threading.Thread(target=process.stderr.read)
        rest.start()
        try:
            yield address, process.pid
        finally:
            process.terminate()
            rest.join()


def make_mission(size: int) -> dict[str, object]:
    """Return a mission of measurements in sequence, with a group of ten in every twenty."""
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
    return {"version": 4, "tasks": tasks, "groups": groups}


def receive_revisions(
    address: str, id: str, revisions: int, subscribers: int, times: Connection
) -> None:
    """Subscribe to a mission, `subscribers` times, until each has received `revisions` revisions.

    Runs in a process of its own. Sends None through `times` when all are subscribed, and at the
    end one dictionary: by the number of each revision the time (ns) at which the last subscriber
    received it.
    """

    async def follow_once(last: Counter[int], ready: asyncio.Semaphore) -> None:
        url = f"ws://{address}/api/missions/{id}/live"
        async with connect(url, additional_headers=HEADERS, max_size=None, proxy=None) as socket:
            await socket.recv()
            ready.release()
            received = 0
            while received < revisions:
                text = await socket.recv()
                if text.startswith('{"kind":"revision"'):
                    received += 1
                    number = json.loads(text)["revision"]["number"]
                    last[number] = max(last[number], time.perf_counter_ns())

    async def follow_in_parallel() -> Counter[int]:
        last: Counter[int] = Counter()
        ready = asyncio.Semaphore(0)
        tasks = [asyncio.create_task(follow_once(last, ready)) for _ in range(subscribers)]
        for _ in range(subscribers):
            await ready.acquire()
        times.send(None)
        await asyncio.gather(*tasks)
        return last

    times.send(asyncio.run(follow_in_parallel()))


def receive_poses(address: str, connections: int, seconds: float, gaps: Connection) -> None:
    """Follow the robot's poses for a number of seconds, over several connections at once.

    Runs in a process of its own. Sends through `gaps` a list of all times (s) between two
    successive poses that the same follower received.
    """

    async def follow_once() -> list[float]:
        url = f"ws://{address}/api/robot/live?since=1000000000"
        own_gaps: list[float] = []
        async with connect(url, additional_headers=HEADERS, max_size=None, proxy=None) as socket:
            last, ends = None, time.perf_counter() + seconds
            while (now := time.perf_counter()) < ends:
                text = await socket.recv()
                if text.startswith('{"kind":"pose"'):
                    now = time.perf_counter()
                    if last is not None:
                        own_gaps.append(now - last)
                    last = now
        return own_gaps

    async def follow_in_parallel() -> list[float]:
        return [
            gap
            for gaps in await asyncio.gather(*(follow_once() for _ in range(connections)))
            for gap in gaps
        ]

    gaps.send(asyncio.run(follow_in_parallel()))


def measure_poses(address: str, process: int, followers: int, seconds: float) -> None:
    """Print the load that a run's poses put on the service, without and with `followers`.

    `process` is the id of the service's process; each of the two measurements takes `seconds`.
    """
    with httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client:
        response = client.post(
            "/api/missions", json={"name": "poses", "mission": make_mission(200)}
        )
        id = response.raise_for_status().json()["id"]
        # At three times real time each step of 0.1 s is sent, 30 poses a second.
        order = {"drive": "route", "speed": 3.0}
        response = client.post(f"/api/missions/{id}/runs", json=order, headers={"if-match": "*"})
        run = response.raise_for_status().json()["id"]
        while client.get(f"/api/runs/{run}").json()["status"] != "running":
            time.sleep(0.1)
        for count in (0, followers):
            here, there = Pipe()
            listening = Process(target=receive_poses, args=(address, count, seconds, there))
            listening.start()
            time.sleep(1.0)
            before, at = processor_seconds(process), time.perf_counter()
            time.sleep(seconds - 2.0)
            share = (processor_seconds(process) - before) / (time.perf_counter() - at)
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


def processor_seconds(process: int) -> float:
    """Return the processor time (s) so far of the process with this id, without its children."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def print_times(name: str, seconds: Sequence[float]) -> None:
    """Print the median and the 95th percentile of times (s), in ms."""
    cuts = quantiles(seconds, n=20)
    print(f"  {name:52s} {median(seconds) * 1e3:7.1f} {cuts[-1] * 1e3:7.1f} ms", flush=True)


def measure_edits(address: str, size: int, edits: int, subscribers: int) -> None:
    """Print how long edits of a mission of `size` tasks take, in ms.

    `edits` of them are made without subscribers, as many with `subscribers`, and as many with one
    subscriber more, which reads nothing.
    """
    with httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=60) as client:
        response = client.post(
            "/api/missions", json={"name": f"{size}", "mission": make_mission(size)}
        )
        id = response.raise_for_status().json()["id"]
        revision = 1
        for count, stalled in ((0, False), (subscribers, False), (subscribers, True)):
            with ExitStack() as stack:
                if stalled:
                    stack.enter_context(subscribe_without_reading(address, id))
                here, there = Pipe()
                followers = Process(
                    target=receive_revisions, args=(address, id, edits, count, there)
                )
                followers.start()
                here.recv()
                seconds, sent = [], {}
                for k in range(edits):
                    begun = time.perf_counter_ns()
                    change_velocity(
                        client, id, revision, f"t{size // 2 + k % 50}", 0.1 + revision / 1e5
                    )
                    seconds.append((time.perf_counter_ns() - begun) / 1e9)
                    revision += 1
                    sent[revision] = begun
                    time.sleep(0.05)
                received = here.recv()
                followers.join()
            title = f"{size} tasks, {count} subscribers" + (", one reads nothing" * stalled)
            print_times(f"{title}: edit", seconds)
            if count:
                print_times(
                    f"{title}: received by all",
                    [(received[n] - at) / 1e9 for n, at in sent.items()],
                )


def change_velocity(
    client: httpx.Client, id: str, revision: int, task: str, velocity: float
) -> None:
    """Change a task's speed (m/s) in mission `id`, whose latest revision is `revision`."""
    change = {"kind": "change_task", "name": task, "velocity": velocity}
    body = {"kind": "edit", "id": f"e{revision}", "edits": [change]}
    headers = {"if-match": f'"{revision}"'}
    client.post(f"/api/missions/{id}/commands", json=body, headers=headers).raise_for_status()


@contextmanager
def subscribe_without_reading(address: str, id: str) -> Iterator[None]:
    """Subscribe to mission `id` for this context, and read nothing that the service sends."""
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


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--tasks", type=int, nargs="*", default=SIZES, help="sizes of missions")
    parser.add_argument("--edits", type=int, default=200, help="edits of each mission")
    parser.add_argument("--subscribers", type=int, default=50, help="clients that receive edits")
    parser.add_argument("--poses", action="store_true", help="measure poses only")
    parser.add_argument(
        "--seconds", type=float, default=20.0, help="seconds in which poses are received"
    )
    options = parser.parse_args(arguments)
    print(f"  {'':52s}  median    95 %")
    with tempfile.TemporaryDirectory() as folder, start_service(Path(folder)) as (address, process):
        measure_poses(address, process, options.subscribers, options.seconds)
        for size in () if options.poses else options.tasks:
            measure_edits(address, size, options.edits, options.subscribers)


if __name__ == "__main__":
    main()
