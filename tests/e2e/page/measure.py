"""How fast the page is: `python -m tests.e2e.page.measure`. Printed, and never asserted."""

import argparse
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from http.client import HTTPConnection
from itertools import pairwise
from multiprocessing import Process
from pathlib import Path
from threading import Barrier
from typing import Any

from playwright.sync_api import expect
from websockets.sync.client import connect

from argo_env.planning.opening import open_site
from tests.argo_planner.service.served import ALL, Served, served
from tests.e2e.page.person import Browsers, Person

MOVES = 200


def mission(count: int, site: str) -> dict[str, Any]:
    tasks: list[dict[str, Any]] = [
        {"name": f"T{n}", "action": "MEASURE", "object_id": str(n % 3 + 1)} for n in range(count)
    ]
    for task, after in pairwise(tasks):
        task["transitions"] = [{"target": after["name"]}]
    return {"version": 3, "site": site, "tasks": tasks}


@contextmanager
def serving(site: str) -> Iterator[Served]:
    opened = open_site(site).prepare()
    with tempfile.TemporaryDirectory() as folder, served(Path(folder), opened) as found:
        yield found


def rows_there(person: Person) -> None:
    expect(person.page.get_by_role("treeitem").first).to_be_visible()
    expect(person.button("Add")).to_be_enabled()


def opening(browsers: Browsers, service: Served, count: int) -> None:
    """From the address to where one can work, and to where all is drawn; the second time, as the
    first one fills the caches of the service."""
    id = service.create(f"{count} tasks", mission(count, "umad"))
    for attempt in ("first", "again"):
        person = browsers.person(f"http://{service.address}/?token={ALL}")
        begun = time.perf_counter()
        person.open(f"/missions/{id}")
        rows_there(person)
        usable = time.perf_counter() - begun
        person.idle()
        drawn = time.perf_counter() - begun
        print(f"{count:5} tasks, {attempt}: usable in {usable:.2f} s, all drawn in {drawn:.2f} s")
        browsers.leave()


def many_pages(browsers: Browsers, service: Served, count: int) -> None:
    """Many pages of one mission that open at once, each in a context of its own."""
    id = service.create("Together", mission(200, "umad"))
    people = [browsers.person(f"http://{service.address}/?token={ALL}") for _ in range(count)]
    begun = time.perf_counter()
    for person in people:
        person.page.goto(f"{person.address}#/missions/{id}", wait_until="commit")
    for person in people:
        rows_there(person)
    took = time.perf_counter() - begun
    print(f"{count} pages with 200 tasks: the last one usable in {took:.1f} s")
    # One browser draws so many scenes with one processor: what it says of that is not the page's.
    print(*sorted({said for person in people for said in person.complaints}), sep="\n")
    for person in people:
        person.complaints.clear()
    browsers.leave()


def asked_by_a_page(browsers: Browsers, service: Served, id: str) -> list[str]:
    """Paths of all that a page asks of the service until it has drawn all."""
    person = browsers.person(f"http://{service.address}/?token={ALL}")
    paths: list[str] = []
    person.page.on("request", lambda request: paths.append(request.url.split(service.address)[1]))
    person.open(f"/missions/{id}")
    rows_there(person)
    person.idle()
    browsers.leave()
    return paths


def ask_all(address: str, paths: list[str], id: str, start: Barrier) -> None:
    """Asks what a page asks, on one connection, and opens its live connection."""
    connection = HTTPConnection(address)
    headers = {"authorization": f"Bearer {ALL}", "accept-encoding": "gzip"}
    start.wait()
    for path in paths:
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        answer.read()
        assert answer.status < 400, f"{path}: {answer.status}"
    with connect(
        f"ws://{address}/api/missions/{id}/live", additional_headers=headers, proxy=None
    ) as live:
        live.recv()


def ask_for_many(address: str, paths: list[str], id: str, count: int) -> None:
    start = Barrier(count + 1)
    with ThreadPoolExecutor(count) as pool:
        asked = [pool.submit(ask_all, address, paths, id, start) for _ in range(count)]
        start.wait()
        begun = time.perf_counter()
        for one in asked:
            one.result()
        took = time.perf_counter() - begun
    print(f"{count} times all of the {len(paths)} answers that a page needs: {took:.1f} s")


def answering(browsers: Browsers, service: Served, count: int) -> None:
    """What the service does for many pages that open at once, without their browsers."""
    id = service.create("Answers", mission(200, "umad"))
    paths = asked_by_a_page(browsers, service, id)
    asking = Process(target=ask_for_many, args=(service.address, paths, id, count))
    asking.start()
    asking.join()


def line_of_text(browsers: Browsers, service: Served, count: int) -> None:
    """What as many browsers take for a text: the least that any page could."""
    people = [browsers.person(f"http://{service.address}/api/service") for _ in range(count)]
    begun = time.perf_counter()
    for person in people:
        person.page.goto(person.address, wait_until="commit")
    for person in people:
        expect(person.page.locator("body")).to_be_visible()
    print(f"{count} pages with a line of text: {time.perf_counter() - begun:.1f} s")
    for person in people:
        person.complaints.clear()
    browsers.leave()


def hovering(browsers: Browsers, service: Served, site: str) -> None:
    """The verdict under the pointer, and what it asks of the service."""
    id = service.create("Ghost", mission(3, site))
    person = browsers.person(f"http://{service.address}/?token={ALL}")
    person.open(f"/missions/{id}")
    rows_there(person)
    person.idle()
    person.key("n")
    person.page.wait_for_timeout(3000)
    asked: list[str] = []
    person.page.on("request", lambda request: asked.append(request.url))
    box = person.page.locator("argo-scene").bounding_box()
    assert box is not None
    for k in range(MOVES):
        x = box["x"] + box["width"] * (0.25 + 0.5 * k / MOVES)
        person.page.mouse.move(x, box["y"] + box["height"] * (0.4 + 0.3 * (k % 10) / 10))
    took = sorted(person.ask("() => window.argo.figures().hover"))
    solids = sum(len(element.solids) for element in open_site(site).site.elements)
    last = took[int(0.95 * len(took))]
    print(f"{solids} solids: verdict p95 {last:.2f} ms of {len(took)}, {len(asked)} requests")
    browsers.leave()


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--large", default="generated:floors=6,seed=7", metavar="SITE")
    parser.add_argument("--tasks", type=int, nargs="*", default=(200, 2_000))
    parser.add_argument("--pages", type=int, default=50)
    given = parser.parse_args(arguments)
    browsers = Browsers()
    with serving(given.large) as service:
        hovering(browsers, service, given.large)
    with serving("umad") as service:
        for count in given.tasks:
            opening(browsers, service, count)
        answering(browsers, service, given.pages)
        line_of_text(browsers, service, given.pages)
        many_pages(browsers, service, given.pages)
    browsers.close()


if __name__ == "__main__":
    main()
