"""Argo where PyBullet can't be imported: all that needs no physics works, the rest says so."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.e2e.conftest import read_run_record

WITHOUT = "import sys\nsys.modules['pybullet'] = None\n"
COMMAND = WITHOUT + "from argo_planner.entry import main\nmain()\n"
NEEDED = "this needs the physics engine PyBullet, which can't be imported"


def run(*arguments: object) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-c", *map(str, arguments)], capture_output=True, text=True, check=False
    )


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "short.txt"
    path.write_text(
        "Mission Protocol #3\n1. Set the starting point in starting area 1.\n2. Check #1.\n"
    )
    return path


def test_a_run_by_travel_times_has_a_report_with_a_picture(script, tmp_path) -> None:
    done = run(COMMAND, "run", script, "--drive", "route", "--report", tmp_path / "report")
    assert done.returncode == 0, done.stderr
    assert read_run_record(tmp_path / "report").result.success
    assert (tmp_path / "report" / "site.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "options",
    [(), ("--drive", "tracked"), ("--drive", "route", "--render", "film.gif")],
    ids=["kinematic", "tracked", "film"],
)
def test_what_needs_physics_says_so_in_one_line_before_the_run(script, tmp_path, options) -> None:
    done = run(COMMAND, "run", script, *options, "--report", tmp_path / "report")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith(f"argo: {NEEDED}")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "report").exists()


def test_environments() -> None:
    done = run(
        WITHOUT + "import gymnasium, argo_env\n"
        "for name in ('Route', 'Inspect'):\n"
        "    with gymnasium.make(f'argo/{name}-v0', render_mode='rgb_array') as env:\n"
        "        env.reset(seed=0)\n"
        "        env.step(int(env.unwrapped.action_masks().argmax()))\n"
        "        assert env.render().shape == (720, 1280, 3)\n"
        "gymnasium.make('argo/Drive-v0').reset(seed=0)\n"
    )
    assert done.stderr.splitlines()[-1].startswith(
        f"argo_compiler.base.errors.Unavailable: {NEEDED}"
    )


def test_the_doctor_says_what_is_missing() -> None:
    done = run(COMMAND, "doctor")
    assert f"PyBullet: does not work: {NEEDED}" in done.stdout
