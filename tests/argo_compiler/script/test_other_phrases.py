"""Floors told one by one, attempts, times of the mission, letters' ends, titles."""

from collections.abc import Callable

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import import_script

_ENGLISH = "Start in starting area 1.\n"
_GERMAN = "Starte in Startbereich 1.\n"
_TRIES = f"{_ENGLISH}Check #6. If it cannot be read, retry at most twice and then go on.\nCheck #9."
_WINDOW = f"{_ENGLISH}Check #9 not before 10 min and not later than 15 min."


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        (
            f"{_ENGLISH}Check all valves on the first and on the third floor.",
            f"{_ENGLISH}Check all valves on floors 1 and 3.",
        ),
        (
            f"{_ENGLISH}Check all valves on the second, on the third and on the fourth floor.",
            f"{_ENGLISH}Check all valves on floors 2, 3 and 4.",
        ),
        (
            f"{_GERMAN}Prüfe alle Ventile im ersten und im dritten Stock.",
            f"{_GERMAN}Prüfe alle Ventile im ersten und dritten Stock.",
        ),
        (_TRIES.replace("retry at most twice", "try again up to two more times"), _TRIES),
        (_TRIES.replace("retry at most twice", "retry it at most two more times"), _TRIES),
        (f"{_ENGLISH}Check #9 between minute 10 and minute 15 of the mission.", _WINDOW),
        (f"{_ENGLISH}Check #9 between minute 10 and 15 minutes into the mission.", _WINDOW),
        (f"{_GERMAN}Prüfe #9 zwischen Minute 10 und Minute 15 der Mission.", _WINDOW),
        (f"{_ENGLISH}Check #8. Stay there.", f"{_ENGLISH}Check #8. End the mission."),
        (f"{_ENGLISH}Check #8, the robot stays there", f"{_ENGLISH}Check #8. End the mission."),
        (f"{_GERMAN}Prüfe #8 und bleibe dort.", f"{_GERMAN}Prüfe #8. Beende die Mission."),
        (
            f"{_ENGLISH}Check #8.\n\nThanks a lot and see you on Monday\nJonas",
            f"{_ENGLISH}Check #8.",
        ),
    ],
)
def test_other_words_mean_the_same(
    said: str, plain: str, meaning_of: Callable[[str], object]
) -> None:
    assert meaning_of(said) == meaning_of(plain)


@pytest.mark.parametrize(
    ("needed", "optional"),
    [("yes", None), ("required", None), ("optional", True)],
)
def test_column_that_says_what_is_needed(
    needed: str, optional: bool | None, catalog: Catalog
) -> None:
    text = f"{_ENGLISH}\n| Checkpoint | Needed |\n|---|---|\n| 4 | {needed} |\n"
    (task,) = (t for t in import_script(text, catalog).mission.tasks if t.object_id)
    assert bool(task.optional) is bool(optional)


def test_what_is_not_needed_is_asked_about(catalog: Catalog) -> None:
    text = f"{_ENGLISH}\n| Checkpoint | Needed |\n|---|---|\n| 4 | no |\n"
    with pytest.raises(DiagnosticError) as error:
        import_script(text, catalog)
    assert "may be left out, or that it is left out" in str(error.value)


def test_who_stays_before_the_end_is_asked_how_long(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError) as error:
        import_script(f"{_ENGLISH}Check #8.\nStay there.\nCheck #4.", catalog)
    first = error.value.diagnostics[0]
    assert first.span is not None
    assert (first.span.line, first.code) == (3, "script.wait")


@pytest.mark.parametrize("title", ["# Tour of the pumps", "Round of the upper deck crew"])
def test_round_in_a_title(title: str, catalog: Catalog) -> None:
    mission = import_script(f"{title}\n\n{_ENGLISH}Check #8.", catalog).mission
    assert mission.designation == title.strip("# ")


def test_mission_does_not_wait_for_a_person(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match="a mission does not wait for a person"):
        import_script(f"{_ENGLISH}Check #8.\nWait until the operator confirms.", catalog)
