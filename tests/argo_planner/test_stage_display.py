"""Only stages that take long are shown, on standard error."""

import io

import pytest
from rich.console import Console

from argo_env.planning.opening import forget_sites
from argo_planner.terminal import stage_display, verbosity
from argo_planner.terminal.stage_display import StageDisplay
from tests.argo_planner.conftest import argo
from tests.yard import yard


class Watch:
    """A clock that the test sets."""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture(autouse=True)
def after(no_stages, monkeypatch):  # noqa: ARG001 - it comes first
    monkeypatch.setattr(stage_display, "AFTER", 2.0)


@pytest.fixture
def watch():
    return Watch()


def display(watch, terminal=False):
    file = io.StringIO()
    console = Console(file=file, force_terminal=terminal, width=100)
    return StageDisplay(console, watch, watched=False), file


def test_lines_come_after_two_seconds_and_then_every_ten(watch):
    shown, file = display(watch)
    for second in range(100, 125):
        watch.now = float(second)
        shown("searching", (second - 100) / 25, f"{second} tried")
    assert file.getvalue().splitlines() == [
        "searching, 102 tried, 8% …",
        "searching, 112 tried, 48% …",
        "searching, 122 tried, 88% …",
    ]


def test_a_silent_stage_is_shown_by_a_refresh(watch):
    shown, file = display(watch)
    shown("finding [the surface]", None, "")
    watch.now += 1.9
    shown.refresh()
    assert file.getvalue() == ""
    watch.now += 0.2
    shown.refresh()
    assert file.getvalue() == "finding [the surface] …\n"
    shown.close()


def test_short_stages_are_shown_only_if_they_follow_each_other_without_a_break(watch):
    shown, file = display(watch)
    for _ in range(20):
        shown("short", None, "")
        watch.now += 0.5
        shown(None, None, "")
        watch.now += 5.0  # of other work
    assert file.getvalue() == ""
    for _ in range(5):
        shown("short", None, "")
        watch.now += 0.5
        shown(None, None, "")
    assert file.getvalue() == "short …\n"


def test_a_bar_is_shown_on_a_terminal_and_goes_with_its_stage(watch):
    shown, file = display(watch, terminal=True)
    shown("searching", 0.0, "")
    watch.now += 3.0
    shown("searching", 0.5, "two found")
    assert "searching, two found" in file.getvalue()
    shown(None, None, "")
    assert file.getvalue().endswith("\x1b[2K")
    shown.close()


def test_quiet_is_quiet(watch):
    shown, file = display(watch)
    verbosity.set_verbosity(quiet=True)
    try:
        shown("searching", None, "")
        watch.now += 30.0
        shown.refresh()
    finally:
        verbosity.set_verbosity()
    assert file.getvalue() == ""


@pytest.fixture
def argo_on_new_sites(tmp_path, monkeypatch):
    """Return a function that runs `argo` in this process, without a cache, and shows all stages."""

    def drawn(*_):
        navigator = yard()
        assert navigator.lattice
        return navigator

    monkeypatch.setattr("argo_env.planning.generated.generate_navigator", drawn)
    monkeypatch.setattr(stage_display, "AFTER", 0.0)
    monkeypatch.setattr(stage_display, "EVERY", 0.0)

    def call(name, *arguments):
        forget_sites()
        monkeypatch.setenv("ARGO_CACHE_DIR", str(tmp_path / name))
        return argo(*arguments, status=0)

    yield call
    forget_sites()
    verbosity.set_verbosity()


def test_the_generation_of_a_site_is_shown_on_standard_error(argo_on_new_sites):
    told = argo_on_new_sites("told", "sites", "generated:seed=7")
    lines = list(dict.fromkeys(told.stderr.splitlines()))  # the refreshing thread may repeat one
    assert lines[0].startswith("making the site generated:")
    assert lines[0].endswith(",seed=7 …")
    assert lines[1] == lines[0].removesuffix(" …") + ": finding the walkable surface …"
    assert any(line.startswith("looking for views of all checkpoints, ") for line in lines)
    quiet = argo_on_new_sites("quiet", "sites", "generated:seed=7", "-q")
    assert quiet.stderr == ""
    assert quiet.stdout == told.stdout
    assert quiet.stdout.count("\n") == 1
