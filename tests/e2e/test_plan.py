"""`argo plan` as people run it: a service, a mission put into its folder, a page in the browser."""

import os
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest

from tests.e2e.conftest import started, told_until

AREAS = ("--start-area", "1", "--end-area", "2")


@contextmanager
def planning(*options: object, environment: dict[str, str] | None = None) -> Iterator[str]:
    """A process of `argo plan`; the address that it names. Ended with Ctrl-C."""
    environment = os.environ | (environment or {})
    process = started("plan", *options, "--port", 0, stdout=None, env=environment)
    said = told_until(process, "Ctrl-C")
    try:
        found = re.search(r"http://\S+", said)
        assert found, said
        yield found[0]
    finally:
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=60)[1]
    assert process.returncode in (0, 130)
    assert "Traceback" not in rest


def mission_at(address: str) -> dict[str, object]:
    """The mission that the page opens there."""
    parts = urlsplit(address)
    token = parse_qs(parts.query)["token"][0]
    headers = {"authorization": f"Bearer {token}"}
    with httpx.Client(base_url=f"http://{parts.netloc}", headers=headers, timeout=60) as client:
        found: dict[str, object] = client.get(f"/api{parts.fragment}").json()
        return found


@pytest.mark.long
def test_a_script_is_put_into_the_folder_once(tmp_path: Path, missions: Path) -> None:
    script, folder = missions / "mission_1.txt", tmp_path / "missions"
    places = []
    for _ in range(2):
        with planning(script, "--folder", folder, "--no-browser", *AREAS) as address:
            places.append(urlsplit(address).fragment)
            opened = mission_at(address)
            assert opened["name"] == "mission_1"
            assert opened["mission"]["end_area"] == 2
    assert places[0] == places[1]
    assert len(list(folder.glob("*.plan"))) == 1


@pytest.mark.long
def test_another_mission_of_that_name_gets_another_name(tmp_path: Path, missions: Path) -> None:
    script, folder = missions / "mission_1.txt", tmp_path / "missions"
    with planning(script, "--folder", folder, "--no-browser", *AREAS):
        pass
    other = ("--start-area", "2", "--end-area", "2")
    with planning(script, "--folder", folder, "--no-browser", *other) as address:
        assert mission_at(address)["name"] == "mission_1 (2)"


@pytest.mark.long
def test_the_browser_is_opened_at_the_page(tmp_path: Path) -> None:
    noted = tmp_path / "address"
    browser = tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\necho "$1" > {noted}\n', encoding="utf-8")
    browser.chmod(0o755)
    with planning("--folder", tmp_path / "m", environment={"BROWSER": str(browser)}) as address:
        assert noted.read_text(encoding="utf-8").strip() == address


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("nothing.txt",), "nothing.txt"),
        (("--site", "nowhere"), "nowhere"),
        (("--port", "70000"), "65535"),
        ((__file__,), "test_plan.py"),
    ],
)
def test_what_can_not_be_planned_is_said(argo, tmp_path, options, said) -> None:
    ended = argo("plan", *options, "--no-browser", "--folder", tmp_path / "m")
    assert ended.returncode in (1, 2)
    assert said in ended.stderr
    assert "Traceback" not in ended.stderr
    assert not list((tmp_path / "m").glob("*.plan"))
