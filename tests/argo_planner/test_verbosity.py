"""`-q` and `-v` change the messages, but not the results."""

import logging

import pytest

from argo_planner.terminal.verbosity import set_verbosity
from tests.argo_planner.conftest import argo

# The misspelt word is worth a warning.
SCRIPT = (
    "Mission Protocol: one\n1. Set the starting point in starting area 1.\n2. Chek checkpoint 1.\n"
)


@pytest.fixture(autouse=True)
def folder(yard_site, monkeypatch, tmp_path):
    """Return the working folder, which contains the script of a mission in the yard."""
    for command in ("run", "check", "import_script"):
        monkeypatch.setattr(f"argo_planner.commands.{command}.open_site", lambda _: yard_site)
    (tmp_path / "plan.txt").write_text(SCRIPT)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    set_verbosity()


RUN = ("run", "plan.txt", "--drive", "route")


def test_a_quiet_run_shows_its_results_only():
    usual, quiet = argo(*RUN), argo("-q", *RUN)
    assert "shows" in usual.stderr
    assert "warning: " in usual.stderr
    assert "Loading took" in usual.stdout
    assert quiet.stderr == ""
    assert quiet.exit_code == usual.exit_code
    kept = [line for line in usual.stdout.splitlines() if "took" not in line and "real" not in line]
    assert quiet.stdout.splitlines() == kept


def test_quiet_commands_still_report_errors():
    assert "no drive `rocket`" in str(argo("-q", "run", "plan.txt", "--drive", "rocket").exception)


@pytest.mark.parametrize("arguments", [("-v", *RUN), (*RUN, "-v"), ("run", "--verbose", *RUN[1:])])
def test_verbose_runs_show_their_stages(arguments):
    result = argo(*arguments)
    assert "INFO argo_env.run.session: a run on yard: drive route" in result.stderr
    assert "INFO argo_env.run.simulation: the run has ended at" in result.stderr
    assert "Success" in result.stdout


def test_verbosity_lasts_for_one_command():
    argo("-vv", *RUN)
    assert "INFO" not in argo(*RUN).stderr
    argo(*RUN, "--quiet")
    assert "shows" in argo(*RUN).stderr


def test_libraries_log_without_a_handler_of_their_own():
    for package in ("argo_compiler", "argo_env"):
        handlers = logging.getLogger(package).handlers
        assert any(isinstance(handler, logging.NullHandler) for handler in handlers)
