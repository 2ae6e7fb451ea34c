"""Tables that `argo evaluate` prints."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from argo_env.evaluation.row import RunOutcome
from argo_env.evaluation.score import read_scoring
from argo_planner.terminal.evaluation_tables import show_results
from tests.argo_env.evaluation.conftest import plan_of, results_with, short_mission


@pytest.mark.parametrize(
    ("files", "last"),
    [
        (30, "and 20 more, in out/failing"),
        (14, "and 20 more, 4 of them in out/failing"),
        (10, "and 20 more"),
        (0, "and 20 more"),
    ],
)
def test_only_files_that_were_written_are_listed(files, last):
    plan = plan_of(short_mission(), range(30))
    results = results_with(
        plan, lambda run: {"outcome": RunOutcome.FAILURE, "key": f"{run.seed:024x}"}
    )
    keys = [row.key for row in results.rows][:files]
    text = StringIO()
    console = Console(file=text, width=200)
    show_results(
        results, {key: Path(f"out/failing/{key}.json") for key in keys}, console, read_scoring()
    )
    lines = text.getvalue().splitlines()
    assert sum("argo run" in line for line in lines) == min(files, 10)
    assert last in [line.strip() for line in lines]
    assert any("to repeat one alone" in line for line in lines) is bool(files)
