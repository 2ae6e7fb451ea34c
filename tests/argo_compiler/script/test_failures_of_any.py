"""Rules on the failure of any reading: `if a gauge can't be read, try it once more`."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Action, OnFailure
from tests.whole_scripts import import_whole

TASKS = "Check #3.\nCheck #4.\nCheck #8.\n"


def failures(text: str, catalog: Catalog) -> list[tuple[int, OnFailure]]:
    """Return the retries of each reading, and what it does if it fails for good."""
    tasks = import_whole(text, catalog, start_area=1).mission.tasks
    return [(t.retries, t.on_failure) for t in tasks if t.action is Action.MEASURE]


@pytest.mark.parametrize(
    ("rule", "retries", "policy"),
    [
        ("If a reading fails, try it once more.", 1, OnFailure.CONTINUE),
        ("If a checkpoint cannot be read, try again twice, then go on.", 2, OnFailure.CONTINUE),
        ("If a measurement fails, abort the mission.", 0, OnFailure.ABORT),
        (
            "If a checkpoint can't be read, retry once, then return to the docking station.",
            1,
            OnFailure.RETURN,
        ),
        ("If a reading fails, go on with the next checkpoint.", 0, OnFailure.CONTINUE),
        ("If a checkpoint is unreachable, skip it.", 0, OnFailure.CONTINUE),
        ("Retry all twice.", 2, OnFailure.CONTINUE),
        (
            "Wenn ein Messpunkt nicht gemessen werden kann, versuche es noch einmal.",
            1,
            OnFailure.CONTINUE,
        ),
    ],
)
def test_a_rule_applies_to_each_reading(
    rule: str, retries: int, policy: OnFailure, catalog: Catalog
) -> None:
    assert failures(TASKS + rule, catalog) == [(retries, policy)] * 3


def test_a_rule_applies_to_readings_below_it(catalog: Catalog) -> None:
    rule = "If a checkpoint cannot be read, abort the mission.\n"
    assert failures(rule + TASKS, catalog) == [(0, OnFailure.ABORT)] * 3
    assert failures(f"Check #1.\n{rule}{TASKS}", catalog) == [(0, OnFailure.ABORT)] * 4


def test_a_rule_of_a_kind_applies_to_that_kind(catalog: Catalog) -> None:
    found = failures(f"{TASKS}If a gauge cannot be read, try again twice.", catalog)
    assert [retries for retries, _ in found] == [2, 0, 2]


def test_what_is_ordered_for_a_reading_has_precedence(catalog: Catalog) -> None:
    text = "Check #3, retry 3 times. Check #4; if it fails, go home. Check #8.\n"
    rule = "If a reading fails, try it once more, then abort the mission."
    assert failures(text + rule, catalog) == [
        (3, OnFailure.ABORT),
        (1, OnFailure.RETURN),
        (1, OnFailure.ABORT),
    ]


@pytest.mark.parametrize(
    "rule",
    [
        "If a reading fails, check checkpoint 5.",
        "If a gauge is unreadable, go home.",
        "Unless a reading fails, abort the mission.",
        "If a reading fails or a gauge is above 4, abort the mission.",
        "If a reading does not fail, abort the mission.",
    ],
)
def test_what_can_not_apply_to_each_is_asked_about(rule: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError):
        import_whole(TASKS + rule, catalog, start_area=1)


def test_the_failure_of_one_named_reading_is_its_own(catalog: Catalog) -> None:
    found = failures(f"{TASKS}If checkpoint 8 cannot be read, try again twice.", catalog)
    assert found == [(0, OnFailure.CONTINUE), (0, OnFailure.CONTINUE), (2, OnFailure.CONTINUE)]
