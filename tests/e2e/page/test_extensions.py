"""The page offers what installed packages offer, under its names."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Browsers
from tests.e2e.test_extensions import MISSION, example, path_with
from tests.e2e.test_service import TOKEN, ServiceProcess

pytestmark = [pytest.mark.long, pytest.mark.physics]

__all__ = ["example"]


@pytest.fixture
def extended_service(
    example: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[httpx.Client]:
    """Start a service with the example package, and return a client."""
    monkeypatch.setenv("PYTHONPATH", path_with(example))
    process = ServiceProcess(tmp_path / "missions")
    process.begin()
    with process.client() as client:
        yield client
    process.process.kill()
    process.process.communicate()


def names(select: Any) -> list[str]:
    """Return the texts of the options of a choice."""
    return select.locator("option").all_inner_texts()  # type: ignore[no-any-return]


def test_choices_have_the_names_of_extensions(
    browsers: Browsers, extended_service: httpx.Client
) -> None:
    params = {"filename": "m.txt", "start_area": 1}
    made = extended_service.post("/api/imports", params=params, content=MISSION)
    address = f"{extended_service.base_url}/?token={TOKEN}"
    ann = browsers.person(address)
    ann.open(f"/missions/{made.json()['id']}")
    page = ann.page
    expect(ann.button("Add")).to_be_enabled()

    ann.click(ann.button("Mission: copy, print, export, versions"))
    expect(page.locator("argo-mission-menu")).to_contain_text("checklist")
    ann.key("Escape")

    page.locator("#tab-run").click()
    page.get_by_text("Run settings").click()
    settings = page.locator("argo-run-start")
    assert "cautious" in names(settings.locator("select[name=drive]"))
    assert "haze" in names(settings.locator("select[name=sensor]"))
    settings.get_by_label("Add a fault").select_option("fogged_lens")
    expect(settings.locator("argo-faults li")).to_contain_text(["fogged_lens"])
    settings.locator("select[name=drive]").select_option("cautious")
    settings.locator("select[name=speed]").select_option("null")
    ann.click(page.locator("#start"))

    def run() -> Any:
        runs = extended_service.get("/api/runs").json()["runs"]
        return runs and runs[0]

    ended = ann.wait_until(lambda: run() if run() and run()["status"] == "ended" else None, "end")
    assert ended["drive"] == "cautious"
    report = f"/api/runs/{ended['id']}/report/report.json"
    ann.wait_until(lambda: extended_service.get(report).status_code == 200, "the report")
    assert [fault["kind"] for fault in extended_service.get(report).json()["faults"]] == [
        "fogged_lens"
    ]
