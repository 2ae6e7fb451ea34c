"""Speed of edits while others upload files that are made to take long.

    python -m benchmarks.service_uploads                   # six uploads at once, for a minute
    python -m benchmarks.service_uploads --seconds 5 --uploads 2

Prints how long a durable edit takes (ms, from the request to the answer) without and with the
uploads: the median, the 95th percentile and the longest; then what became of the uploads, how long
they took, and the largest memory of the service's process.
"""

import argparse
import json
import os
import sqlite3
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from statistics import median, quantiles

import httpx

from benchmarks.service import TOKEN, make_mission, start_service

OTHER = "uploads-of-person-{}"
"""token of the person with that number; each upload is of another person"""
PAUSE = 0.05
"""s between two edits"""


def make_database(definition: str) -> bytes:
    """Return a database without content but for a definition."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bag.db3"
        with closing(sqlite3.connect(path)) as database:
            database.execute(definition)
            database.commit()
        return path.read_bytes()


def make_json(size: int) -> bytes:
    """Return a mission of `size` bytes at most."""
    tasks = json.dumps(make_mission(1_000)["tasks"])[1:-1].encode()
    return b'{"version":3,"tasks":[' + b",".join([tasks] * (size // len(tasks))) + b"]}"


FILES: tuple[tuple[str, Callable[[], bytes]], ...] = (
    ("large.json", lambda: make_json(15_900_000)),
    ("huge.json", lambda: make_json(43_000_000)),
    ("deep.json", lambda: b'{"tasks":' + b"[{}," * 3_900_000),
    ("steps.txt", lambda: b"".join(b"%d. Chekc teh chekpoint 1\n" % k for k in range(35_000))),
    (
        "endless.db3",
        lambda: make_database(
            "CREATE VIEW schema AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x FROM c) "
            "SELECT x AS schema_version FROM c WHERE x = 0"
        ),
    ),
    (
        "bomb.db3",
        lambda: make_database("CREATE TABLE messages(id INTEGER, data AS (zeroblob(900000000)))"),
    ),
)  # fmt: skip
"""names of the uploads, and functions that make their content"""


def upload_repeatedly(
    address: str,
    token: str,
    name: str,
    content: bytes,
    ended: threading.Event,
    outcomes: list[tuple[str, float]],
) -> None:
    """Upload a file again and again, and note the status and the time (s) of each answer."""
    headers = {"authorization": f"Bearer {token}"}
    with httpx.Client(base_url=f"http://{address}", headers=headers, timeout=None) as client:
        while not ended.is_set():
            begun = time.perf_counter()
            try:
                answer = client.post("/api/imports", params={"filename": name}, content=content)
                status = str(answer.status_code)
            except httpx.HTTPError as error:
                status = type(error).__name__
            outcomes.append((f"{name} {status}", time.perf_counter() - begun))


def edit_repeatedly(client: httpx.Client, id: str, until: float) -> list[float]:
    """Edit a mission until a time, and return how long each edit took (s)."""
    times = []
    while time.perf_counter() < until:
        edit = {"kind": "change_task", "name": "t0", "velocity": 0.1 + len(times) % 2 / 10}
        body = {"kind": "edit", "id": f"e{time.perf_counter_ns()}", "edits": [edit]}
        begun = time.perf_counter()
        answer = client.post(f"/api/missions/{id}/commands", json=body, headers={"if-match": "*"})
        times.append(time.perf_counter() - begun)
        assert answer.status_code == 200, answer.text
        time.sleep(PAUSE)
    return times


def print_times(label: str, times: Sequence[float]) -> None:
    """Print the median, the 95th percentile and the longest of the times."""
    p95 = quantiles(times, n=20)[-1] if len(times) > 1 else times[0]
    print(
        f"{label:<24} {len(times):5} edits: median {1e3 * median(times):6.0f} ms, 95 % up to "
        f"{1e3 * p95:6.0f} ms, longest {1e3 * max(times):6.0f} ms",
        flush=True,
    )


def largest_memory(process: int) -> str:
    """Return the largest memory of a process so far, as text; only Linux states it."""
    path = Path(f"/proc/{process}/status")
    if not path.exists():
        return "unknown"
    [line] = [line for line in path.read_text().splitlines() if line.startswith("VmHWM")]
    return f"{int(line.split()[1]) / 1e3:.0f} MB"


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; return 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--uploads", type=int, default=len(FILES), help="uploads at once")
    parser.add_argument("--tasks", type=int, default=200, help="tasks of the edited mission")
    options = parser.parse_args(arguments)
    files = [(name, make()) for name, make in FILES[: options.uploads]]
    with tempfile.TemporaryDirectory() as name:
        tokens = Path(name) / "tokens"
        others = [OTHER.format(k) for k in range(len(files))]
        lines = [f"{TOKEN} operate ann", *(f"{other} plan" for other in others)]
        tokens.write_text("\n".join(lines))
        missions = Path(name) / "missions"
        with (
            start_service(missions, "--token-file", str(tokens)) as (address, process),
            httpx.Client(
                base_url=f"http://{address}",
                headers={"authorization": f"Bearer {TOKEN}"},
                timeout=None,
            ) as client,
        ):
            new = {"name": "Round", "mission": make_mission(options.tasks)}
            id = client.post("/api/missions", json=new).json()["id"]
            edit_repeatedly(client, id, time.perf_counter() + 2)  # the first ones load modules
            quiet = edit_repeatedly(client, id, time.perf_counter() + options.seconds / 4)
            print_times("without uploads", quiet)
            ended = threading.Event()
            outcomes: list[tuple[str, float]] = []
            threads = [
                threading.Thread(
                    target=upload_repeatedly,
                    args=(address, other, *file, ended, outcomes),
                    daemon=True,
                )
                for other, file in zip(others, files, strict=True)
            ]
            for thread in threads:
                thread.start()
            busy = edit_repeatedly(client, id, time.perf_counter() + options.seconds)
            print_times(f"with {len(files)} uploads at once", busy)
            print(f"largest memory of the service: {largest_memory(process)}")
            ended.set()
            for thread in threads:
                thread.join()
    for outcome, count in sorted(Counter(outcome for outcome, _ in outcomes).items()):
        took = [seconds for other, seconds in outcomes if other == outcome]
        print(f"{outcome:<24} {count:5} times, longest {max(took):.1f} s")
    return 0


if __name__ == "__main__":
    os.environ.pop("ARGO_TOKEN", None)
    sys.exit(main())
