"""Speed of the page with a long draft: a line is confirmed by key until the page shows it.

    python -m benchmarks.draft_page                   # 500 lines, of which 100 are confirmed
    python -m benchmarks.draft_page --lines 50 --confirm 5 --language en-GB

The page is used by keyboard alone, in German unless `--language` names another one. It prints the
time (ms) from each key to the end of the frame that shows the line as confirmed, and the time until
the decision is on disk, which the page does not wait for: the median, the 95th percentile and the
longest. The page has to be built, and Chromium installed.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import httpx
from playwright.sync_api import expect

from benchmarks.service import HEADERS, TOKEN, start_service
from tests.e2e.page.person import Browsers, Person

WATCH = """() => {
  const grid = document.querySelector("argo-app").shadowRoot
    .querySelector("argo-draft").shadowRoot;
  window.times = { shown: [], saved: [] };
  const begun = new Map();
  let at = 0;
  grid.addEventListener("keydown", (event) => {
    if (event.key !== "c") return;
    at = event.timeStamp;
    begun.set(event.target.dataset.label, at);
  }, true);
  const seen = new MutationObserver((changes) => {
    const now = changes.some((change) => change.attributeName === "data-state"
      && change.oldValue === "proposed" && change.target.dataset.state === "understood");
    if (!now || at === 0) return;
    const from = at;
    at = 0;
    const channel = new MessageChannel();
    channel.port1.onmessage = () => window.times.shown.push(performance.now() - from);
    requestAnimationFrame(() => channel.port2.postMessage(null));
  });
  seen.observe(grid, { subtree: true, attributes: true, attributeOldValue: true,
    attributeFilter: ["data-state"] });
  const observeSaved = new MutationObserver((changes) => {
    for (const { target } of changes) {
      const from = begun.get(target.dataset.label);
      if (from === undefined || target.hasAttribute("aria-busy")) continue;
      begun.delete(target.dataset.label);
      window.times.saved.push(performance.now() - from);
    }
  });
  observeSaved.observe(grid, { subtree: true, attributes: true, attributeFilter: ["aria-busy"] });
}"""
"""script that notes when keys are pressed, and when the page shows their effect"""


def make_script(lines: int) -> str:
    """Return a script of so many lines: one of six is to be confirmed, one of a hundred is open.

    With more than a hundred of these together the script is not read to its end.
    """

    def step(k: int) -> str:
        if k % 100 == 50:
            return f"Photograph pump {k}."
        words = "I'd like to have checkpoint" if k % 6 == 0 else "Check checkpoint"
        return f"{words} {k % 20 + 1}."

    middle = [step(k) for k in range(1, lines - 1)]
    return "\n".join(["Start in starting area 1.", *middle, "End in starting area 1."])


def open_draft(person: Person, address: str, script: str) -> dict[str, Any]:
    """Upload a script, open its draft by the page, and return the service's answer."""
    params = {"filename": "round.txt"}
    with httpx.Client(base_url=f"http://{address}", headers=HEADERS, timeout=180) as client:
        answer = client.post("/api/imports", params=params, content=script)
    assert answer.status_code == 202, answer.text
    draft: dict[str, Any] = answer.json()
    person.open(f"/drafts/{draft['id']}")
    expect(person.page.locator("argo-draft .line:focus")).to_have_count(1)
    return draft


def confirm_lines(person: Person, count: int, pause_ms: int) -> None:
    """Confirm so many lines by keyboard; each key leads on to the next line that is left."""
    row = "argo-draft .line:focus"
    for _ in range(count):
        while person.page.locator(row).get_attribute("data-state") != "proposed":
            person.key("n")
        person.key("c")
        person.page.wait_for_timeout(pause_ms)
    expect(person.page.locator("argo-draft .line[aria-busy]")).to_have_count(0)


def times_text(times: Sequence[float]) -> str:
    """Return the median, the 95th percentile and the longest of times (ms)."""
    last = quantiles(times, n=20)[-1] if len(times) > 1 else times[0]
    return f"{median(times):8.0f} {last:8.0f} {max(times):8.0f}  ({len(times)} lines)"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print how long confirming lines takes."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--lines", type=int, default=500)
    parser.add_argument("--confirm", type=int, default=100, help="lines that are confirmed")
    parser.add_argument("--pause", type=int, default=150, help="ms between two of them")
    parser.add_argument("--language", default="de-DE")
    given = parser.parse_args(arguments)
    browsers = Browsers()
    with tempfile.TemporaryDirectory() as folder, start_service(Path(folder)) as (address, _):
        person = browsers.person(f"http://{address}/?token={TOKEN}", locale=given.language)
        draft = open_draft(person, address, make_script(given.lines))
        confirming, answering = draft["to_confirm"], draft["to_answer"]
        print(f"{len(draft['lines'])} lines: {confirming} to confirm, {answering} to answer")
        person.evaluate(WATCH)
        confirm_lines(person, min(given.confirm, confirming), given.pause)
        times = person.evaluate("() => window.times")
        print(f"{'ms':24} {'median':>8} {'95 %':>8} {'longest':>8}")
        print(f"{'key to shown':24} {times_text(times['shown'])}")
        print(f"{'key to stored':24} {times_text(times['saved'])}")
        browsers.close_windows()
    browsers.close()


if __name__ == "__main__":
    main(sys.argv[1:])
