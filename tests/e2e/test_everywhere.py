"""A short use of all modules, commands and drives, and of the service, on each supported Python."""

import re
from pathlib import Path
from urllib.parse import urljoin

import httpx
import pytest

from argo_planner.cli import ArgoCommands
from tests.e2e.conftest import read_run_record
from tests.e2e.test_plan import fetch_mission, run_planner
from tests.processes import run_python
from tests.yard import measure, mission, waypoint, write_yard

pytestmark = pytest.mark.everywhere

SHORT = mission(measure(1), waypoint("A", 2.05, 2.05))
EVALUATION = "missions: [short.json]\nsites: [yard.yaml]\ndrives: [route]\nseeds: 0..1\n"
SITE = ("--site", "yard.yaml")

IMPORTS = """
from importlib import import_module
from pkgutil import walk_packages

for package in map(import_module, ("argo_compiler", "argo_env", "argo_planner", "baselines")):
    for module in walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith("__main__"):
            try:
                import_module(module.name)
            except ModuleNotFoundError as error:
                # FlexBE's own, and those of the extra `learned`.
                if error.name not in ("flexbe_core", "sb3_contrib", "stable_baselines3", "torch"):
                    raise
"""
"""program that imports all modules"""


def test_all_modules_are_imported_without_a_warning() -> None:
    run_python("-W", "error", "-c", IMPORTS)


@pytest.fixture(scope="module")
def folder(argo, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a site, a mission, a script, an evaluation and the report of a run."""
    folder = tmp_path_factory.mktemp("everywhere")
    write_yard(folder, short=SHORT)
    (folder / "evaluation.yaml").write_text(EVALUATION, encoding="utf-8")
    argo("format", "short.json", "-o", "short.txt", *SITE, cwd=folder, status=0)
    run = ("run", "short.json", *SITE, "--drive", "route")
    argo(*run, "--report", "run", "--record", "run.mcap", cwd=folder, status=0)
    return folder


COMMANDS = {
    "import": ("short.txt", "-o", "imported.json", *SITE),
    "check": ("short.txt", *SITE),
    "explain": ("short.txt", *SITE),
    "compile": ("short.json", *SITE, "-o", "machine.json"),
    "format": ("short.json", *SITE),
    "export": ("short.json", *SITE, "--to", "scxml", "-o", "machine.scxml"),
    "route": ("short.json", *SITE, "-o", "ordered.json"),
    "run": ("short.json", *SITE, "--drive", "route"),
    "resume": ("run/run.journal",),
    "replay": ("run.mcap", "--report", "replayed"),
    "evaluate": ("evaluation.yaml",),
    "sites": ("yard.yaml",),
    "examples": (),
    "new": ("site", "plant"),
    "schema": ("mission",),
    "docs": (),
    "doctor": (),
}
"""arguments of each command that ends by itself"""


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_works(argo, folder: Path, command: str) -> None:
    argo(command, *COMMANDS[command], cwd=folder, status=0)


@pytest.mark.parametrize("command", [command.name for command in ArgoCommands.lazy_commands])
def test_each_command_has_a_help(argo, command: str) -> None:
    assert command in COMMANDS or command in ("plan", "serve")
    assert f"argo {command} " in argo(command, "--help", status=0).stdout


@pytest.mark.parametrize(
    "drive",
    ["route", *(pytest.param(d, marks=pytest.mark.physics) for d in ("kinematic", "tracked"))],
)
def test_a_run_with_each_drive(argo, folder: Path, drive: str) -> None:
    report = folder / drive
    run = ("run", "short.json", *SITE, "--drive", drive)
    argo(*run, "--report", report, cwd=folder, status=0)
    assert read_run_record(report).result.success
    assert (report / "site.png").read_bytes().startswith(b"\x89PNG")


def test_the_planner_serves_a_mission_and_the_page(folder: Path, tmp_path: Path) -> None:
    options = ("--site", folder / "yard.yaml", "--folder", tmp_path, "--no-browser")
    with run_planner(folder / "short.json", *options) as address:
        assert fetch_mission(address)["name"] == "short"
        with httpx.Client(timeout=60, follow_redirects=True) as browser:
            page = browser.get(address)
            (script,) = re.findall(r'src="([^"]+\.js)"', page.text)
            assert browser.get(urljoin(address, script)).status_code == 200
