"""Drafts of scripts that other people wrote: each line gets a state that a careful reader allows,
and after confirming and answering, the mission is the right one."""

import os
from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from tests.argo_compiler.script.judging.drafts import Verdict, judge_draft, load_cases

ACTS_PER_LINE = 0.25
WITHOUT_WORDS = {
    "cond_standing_orders": frozenset([5, 6]),
    "cond_unless_and_failures": frozenset([6]),
    "timing_until_level": frozenset([6]),
}
"""lines that are open because the mission language has no words for what they mean: retries after a
wait as a reaction, a count of failures in all; they may only become fewer"""


@pytest.fixture(scope="module")
def verdicts() -> dict[str, Verdict]:
    folder = os.environ.get("ARGO_DRAFTS")
    if not folder:
        pytest.skip("ARGO_DRAFTS names no folder: no other people's drafts are tried")
    from argo_env.planning.opening import open_site

    catalog: Catalog = open_site("umad").catalog
    found = {
        case.name: judge_draft(case, catalog, WITHOUT_WORDS.get(case.name, frozenset()))
        for case in load_cases(Path(folder))
    }
    assert found, f"{folder} has no scripts"
    return found


def test_drafts_of_other_people_come_right(verdicts: dict[str, Verdict]) -> None:
    wrong = {name: v.problems for name, v in verdicts.items() if v.problems}
    assert not wrong, "\n".join(f"{name}: {problems}" for name, problems in wrong.items())


def test_a_person_decides_on_one_line_of_four_at_most(verdicts: dict[str, Verdict]) -> None:
    acts = sum(verdict.acts for verdict in verdicts.values())
    assert acts <= ACTS_PER_LINE * sum(verdict.lines for verdict in verdicts.values())
