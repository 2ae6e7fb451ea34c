"""`argo plan` from a shell: a service, a mission copied into its folder, a page in the browser."""

import os
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest

from tests.e2e.conftest import read_errors_until, start_argo

AREAS = ("--start-area", "1", "--end-area", "2")


@contextmanager
def run_planner(*options: object, environment: dict[str, str] | None = None) -> Iterator[str]:
    """Yield the address that a process of `argo plan` prints; end the process with Ctrl-C."""
    environment = os.environ | (environment or {})
    process = start_argo("plan", *options, "--port", 0, stdout=None, env=environment)
    errors = read_errors_until(process, "Ctrl-C")
    try:
        match = re.search(r"http://\S+", errors)
        assert match, errors
        yield match[0]
    finally:
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=60)[1]
    assert process.returncode in (0, 130)
    assert "Traceback" not in rest


def fetch_mission(address: str) -> dict[str, object]:
    """Return the mission that the page opens at an address."""
    parts = urlsplit(address)
    token = parse_qs(parts.query)["token"][0]
    headers = {"authorization": f"Bearer {token}"}
    with httpx.Client(base_url=f"http://{parts.netloc}", headers=headers, timeout=60) as client:
        mission: dict[str, object] = client.get(f"/api{parts.fragment}").json()
        return mission


@pytest.mark.long
def test_a_script_is_put_into_the_folder_once(tmp_path: Path, missions: Path) -> None:
    script, folder = missions / "mission_1.txt", tmp_path / "missions"
    fragments = []
    for _ in range(2):
        with run_planner(script, "--folder", folder, "--no-browser", *AREAS) as address:
            fragments.append(urlsplit(address).fragment)
            opened = fetch_mission(address)
            assert opened["name"] == "mission_1"
            assert opened["mission"]["end_area"] == 2
    assert fragments[0] == fragments[1]
    assert len(list(folder.glob("*.plan"))) == 1


@pytest.mark.long
def test_another_mission_of_that_name_gets_another_name(tmp_path: Path, missions: Path) -> None:
    script, folder = missions / "mission_1.txt", tmp_path / "missions"
    with run_planner(script, "--folder", folder, "--no-browser", *AREAS):
        pass
    other = ("--start-area", "2", "--end-area", "2")
    with run_planner(script, "--folder", folder, "--no-browser", *other) as address:
        assert fetch_mission(address)["name"] == "mission_1 (2)"


@pytest.mark.long
def test_the_browser_is_opened_at_the_page(tmp_path: Path) -> None:
    address_file = tmp_path / "address"
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {address_file}\n', encoding="utf-8")
    browser.chmod(0o755)
    with run_planner("--folder", tmp_path / "m", environment={"BROWSER": str(browser)}) as address:
        assert address_file.read_text(encoding="utf-8").strip() == address


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("nothing.txt",), "nothing.txt"),
        (("--site", "nowhere"), "nowhere"),
        (("--port", "70000"), "65535"),
        ((__file__,), "test_plan.py"),
    ],
)
def test_wrong_arguments_are_refused(argo, tmp_path, options, message) -> None:
    result = argo("plan", *options, "--no-browser", "--folder", tmp_path / "m")
    assert result.returncode in (1, 2)
    assert message in result.stderr
    assert "Traceback" not in result.stderr
    assert not list((tmp_path / "m").glob("*.plan"))
