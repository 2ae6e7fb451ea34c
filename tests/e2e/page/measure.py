"""Speed of the page: `python -m tests.e2e.page.measure` prints it, and no test asserts it."""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from http.client import HTTPConnection
from itertools import pairwise
from multiprocessing import Process
from pathlib import Path
from statistics import quantiles
from threading import Barrier
from typing import Any

from playwright.sync_api import expect
from websockets.sync.client import connect

from argo_env.planning.opening import open_site
from tests.argo_planner.service.served import ALL, Served, served
from tests.e2e.page.person import Browsers, Person


def mission(count: int, site: str) -> dict[str, Any]:
    tasks: list[dict[str, Any]] = [
        {"name": f"T{n}", "action": "MEASURE", "object_id": str(n % 3 + 1)} for n in range(count)
    ]
    for task, after in pairwise(tasks):
        task["transitions"] = [{"target": after["name"]}]
    return {"version": 4, "site": site, "tasks": tasks}


@contextmanager
def serving(site: str) -> Iterator[Served]:
    opened = open_site(site).prepare()
    with tempfile.TemporaryDirectory() as folder, served(Path(folder), opened) as service:
        yield service


def wait_for_rows(person: Person) -> None:
    expect(person.page.get_by_role("treeitem").first).to_be_visible()
    expect(person.button("Add")).to_be_enabled()


def measure_opening(browsers: Browsers, service: Served, count: int) -> None:
    """Print the seconds until a mission can be edited and until it is drawn.

    It is opened twice, as the first time fills the caches of the service.
    """
    id = service.create(f"{count} tasks", mission(count, "umad"))
    for attempt in ("first", "again"):
        person = browsers.person(f"http://{service.address}/?token={ALL}")
        begun = time.perf_counter()
        person.open(f"/missions/{id}")
        wait_for_rows(person)
        usable = time.perf_counter() - begun
        person.wait_for_scene()
        drawn = time.perf_counter() - begun
        print(f"{count:5} tasks, {attempt}: usable in {usable:.2f} s, all drawn in {drawn:.2f} s")
        browsers.close_windows()


def measure_many_pages(browsers: Browsers, service: Served, count: int, tasks: int) -> None:
    """Print the seconds that many pages of one mission take to open at once."""
    id = service.create("Together", mission(tasks, "umad"))
    people = [browsers.person(f"http://{service.address}/?token={ALL}") for _ in range(count)]
    begun = time.perf_counter()
    for person in people:
        person.page.goto(f"{person.address}#/missions/{id}", wait_until="commit")
    for person in people:
        wait_for_rows(person)
    took = time.perf_counter() - begun
    print(f"{count} pages with {tasks} tasks: the last one usable in {took:.1f} s")
    # One browser process draws all scenes; its messages about that are no problems of the page.
    print(*sorted({text for person in people for text in person.problems}), sep="\n")
    for person in people:
        person.problems.clear()
    browsers.close_windows()


def record_requests(browsers: Browsers, service: Served, id: str) -> list[str]:
    """Return the paths of all requests of a page until it has drawn everything."""
    person = browsers.person(f"http://{service.address}/?token={ALL}")
    paths: list[str] = []
    person.page.on("request", lambda request: paths.append(request.url.split(service.address)[1]))
    person.open(f"/missions/{id}")
    wait_for_rows(person)
    person.wait_for_scene()
    browsers.close_windows()
    return paths


def request_all(address: str, paths: list[str], id: str, start: Barrier) -> None:
    """Send the requests of a page on one connection, and open its event feed."""
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


def measure_requests(address: str, paths: list[str], id: str, count: int) -> None:
    """Print the seconds for the requests of many pages at once, with a thread for each page."""
    start = Barrier(count + 1)
    with ThreadPoolExecutor(count) as pool:
        asked = [pool.submit(request_all, address, paths, id, start) for _ in range(count)]
        start.wait()
        begun = time.perf_counter()
        for one in asked:
            one.result()
        took = time.perf_counter() - begun
    print(f"{count} times all of the {len(paths)} answers that a page needs: {took:.1f} s")


def measure_service(browsers: Browsers, service: Served, count: int, tasks: int) -> None:
    """Print the seconds that the service needs for many pages at once, without their browsers."""
    id = service.create("Answers", mission(tasks, "umad"))
    paths = record_requests(browsers, service, id)
    asking = Process(target=measure_requests, args=(service.address, paths, id, count))
    asking.start()
    asking.join()


def measure_text_page(browsers: Browsers, service: Served, count: int) -> None:
    """Print the seconds that many pages with a line of text take to open: a lower limit."""
    people = [browsers.person(f"http://{service.address}/api/service") for _ in range(count)]
    begun = time.perf_counter()
    for person in people:
        person.page.goto(person.address, wait_until="commit")
    for person in people:
        expect(person.page.locator("body")).to_be_visible()
    print(f"{count} pages with a line of text: {time.perf_counter() - begun:.1f} s")
    for person in people:
        person.problems.clear()
    browsers.close_windows()


def measure_hover(browsers: Browsers, service: Served, site: str, moves: int) -> None:
    """Print the duration (ms) of verdicts under the pointer, and the number of requests."""
    id = service.create("Ghost", mission(3, site))
    person = browsers.person(f"http://{service.address}/?token={ALL}")
    person.open(f"/missions/{id}")
    wait_for_rows(person)
    person.wait_for_scene()
    person.key("n")
    person.page.wait_for_timeout(3000)
    asked: list[str] = []
    person.page.on("request", lambda request: asked.append(request.url))
    box = person.page.locator("argo-scene").bounding_box()
    assert box is not None
    for k in range(moves):
        x = box["x"] + box["width"] * (0.25 + 0.5 * k / moves)
        person.page.mouse.move(x, box["y"] + box["height"] * (0.4 + 0.3 * (k % 10) / 10))
    took = sorted(person.evaluate("() => window.argo.figures().hover"))
    solids = sum(len(element.solids) for element in open_site(site).site.elements)
    last = took[int(0.95 * len(took))]
    print(f"{solids} solids: verdict p95 {last:.2f} ms of {len(took)}, {len(asked)} requests")
    browsers.close_windows()


# Returns a promise of the ms from the next key or click until a condition holds. The list is asked
# again and again between other work, so that what delays the page counts.
LAP = """(condition) => {
    const app = document.querySelector("argo-app").shadowRoot;
    const list = app.querySelector("argo-list").shadowRoot;
    const row = (name) => list.querySelector(`[role=treeitem][data-name="${name}"]`);
    const holds = new Function("row", `return ${condition}`);
    const channel = new MessageChannel();
    let begun = null;
    const begin = (event) => (begun ??= event.timeStamp);
    for (const kind of ["keydown", "pointerdown"])
        addEventListener(kind, begin, { capture: true, once: true });
    window.lap = new Promise((done) => {
        channel.port1.onmessage = () => {
            if (begun !== null && holds(row)) done(performance.now() - begun);
            else channel.port2.postMessage(null);
        };
        channel.port2.postMessage(null);
    });
}"""
REPEATS = 15


def measure_edits(browsers: Browsers, service: Served, counts: Sequence[int]) -> None:
    """Print the ms that edits take until the list shows them, for missions of several sizes."""
    people = {}
    for count in counts:
        id = service.create(f"Edits of {count}", mission(count, "umad"))
        person = people[count] = browsers.person(f"http://{service.address}/?token={ALL}")
        person.open(f"/missions/{id}")
        wait_for_rows(person)
        person.wait_for_scene()
    laps: dict[tuple[str, int], list[float]] = {}
    for repeat in range(REPEATS):
        for count, person in people.items():
            for act, took in _edit_laps(person, f"new {repeat}"):
                laps.setdefault((act, count), []).append(took)
    print("ms: median and p95, by number of tasks")
    for act in dict.fromkeys(act for act, _ in laps):
        took = {count: quantiles(laps[act, count], n=20) for count in counts}
        parts = [f"{count:5}: {took[count][9]:6.0f} {took[count][18]:6.0f}" for count in counts]
        ratio = took[counts[-1]][9] / took[counts[0]][9]
        print(f"{act:10} {'   '.join(parts)}   ratio {ratio:.2f}")
    browsers.close_windows()


def _edit_laps(person: Person, name: str) -> Iterator[tuple[str, float]]:
    """Yield the ms of some edits, each of which is undone."""
    rows = person.page.locator("argo-list [role=treeitem]")

    def lap(condition: str, act: Callable[[], object]) -> float:
        person.evaluate(LAP, condition)
        act()
        took = float(person.evaluate("() => window.lap"))
        expect(person.save_status).to_have_text("Saved")
        person.page.wait_for_timeout(1500)  # until what follows an edit later has ended
        return took

    rows.nth(0).click()
    yield "select", lap("row('T2').ariaSelected === 'true'", lambda: rows.nth(2).click())
    person.key("F2")
    person.type(name)
    yield "rename", lap(f"row('{name}') !== null", lambda: person.key("Enter"))
    yield "undo", lap("row('T2') !== null", lambda: person.key("Control+z"))
    first = "row('T1').dataset.index > row('T2').dataset.index"
    yield "move", lap(first, lambda: person.key("Alt+ArrowUp"))
    yield "undo move", lap(f"!({first})", lambda: person.key("Control+z"))


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--large", default="generated:floors=6,seed=7", metavar="SITE")
    parser.add_argument("--moves", type=int, default=200, help="moves of the pointer")
    parser.add_argument("--tasks", type=int, nargs="+", default=(200, 2_000))
    parser.add_argument("--pages", type=int, default=50, help="pages of the first mission")
    parser.add_argument("--edits", type=int, nargs="+", metavar="TASKS", help="time edits only")
    given = parser.parse_args(arguments)
    browsers = Browsers(scale=0.5, scene=0.1)
    if given.edits:
        with serving("umad") as service:
            measure_edits(browsers, service, given.edits)
        browsers.close()
        return
    with serving(given.large) as service:
        measure_hover(browsers, service, given.large, given.moves)
    with serving("umad") as service:
        for count in given.tasks:
            measure_opening(browsers, service, count)
        measure_service(browsers, service, given.pages, given.tasks[0])
        measure_text_page(browsers, service, given.pages)
        measure_many_pages(browsers, service, given.pages, given.tasks[0])
    browsers.close()


if __name__ == "__main__":
    main()
