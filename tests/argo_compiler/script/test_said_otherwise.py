"""Lines as many people write them mean what the plain ones mean, or are asked about."""

from collections.abc import Callable

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import import_script

_GERMAN = "Starte in Startbereich 1.\n"
_ENGLISH = "Start in starting area 1.\n"


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        ("Start area 1\nCheck #1.", "Start area: 1\nCheck #1."),
        ("Starting area 2\n\n1. Check #1.", "Start area: 2\n1. Check #1."),
        ("Startbereich 2\nPrüfe Kontrollpunkt 1.", "Startbereich: 2\nPrüfe Kontrollpunkt 1."),
        ("Start area 1\nEnding area: 2\nCheck #1.", "Start area: 1\nEnd area: 2\nCheck #1."),
        ("Signed: B. Adeyemi, HSE\nStart area: 1\nCheck #1.", "Start area: 1\nCheck #1."),
        ("Prepared by: M. Lindqvist\nStart area: 1\nCheck #1.", "Start area: 1\nCheck #1."),
        ("Geprüft von: M. Weiß\nStartbereich: 1\nPrüfe #1.", "Startbereich: 1\nPrüfe #1."),
        (
            "Start area: 1\nCheck #1. The mission ends when the robot is docked in area 2.",
            "Start area: 1\nCheck #1. Park in area 2.",
        ),
        (
            f"{_ENGLISH}The robot has to check these valves in any order:\n- R25\n- R12",
            f"{_ENGLISH}Check these valves in any order:\n- R25\n- R12",
        ),
        (
            f"{_ENGLISH}Check #1. If it shows more than 20 or less than 5, check #4.",
            f"{_ENGLISH}Check #1. If it is above 20 or below 5, check #4.",
        ),
        (
            f"{_GERMAN}Prüfe #1. Wenn der Wert größer als 20 oder kleiner als 5 ist, prüfe #4.",
            f"{_GERMAN}Prüfe #1. Wenn der Wert über 20 oder unter 5 ist, prüfe #4.",
        ),
        (
            f"{_ENGLISH}Check #1 and #4.\n#4 has to be read not later than 5 min after the start.",
            f"{_ENGLISH}Check #1.\nCheck #4 not later than 5 minutes after the start.",
        ),
        (
            "Start area: 1\nOrder: any\nCheck #1 and #4.\nNote: #4 must be checked before #1.",
            "Start area: 1\nOrder: any\nCheck #1 and #4.\n#4 must be checked before #1.",
        ),
    ],
)
def test_other_words_mean_the_same(
    said: str, plain: str, meaning_of: Callable[[str], object]
) -> None:
    assert meaning_of(said) == meaning_of(plain)


@pytest.mark.parametrize(
    "text",
    ["Work instruction WI-31 rev. B", "Arbeitsanweisung WI-31 Rev. B"],
)
def test_title_with_a_revision(text: str, catalog: Catalog) -> None:
    mission = import_script(f"{text}\n\nStart area: 1\n1. Check #1.", catalog).mission
    assert mission.designation == text


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (
            "1. Check #1.\n2. Check #4.\n3. Repeat this three times.",
            "step-range",
            "all steps",
        ),
        ("1. Prüfe #1.\n2. Prüfe #4.\n3. Wiederhole es dreimal.", "step-range", "all steps"),
        ("1. Check #1.\n2. #1 has to be read within 5 minutes.", "ambiguous-demand", "once more"),
        ("1. Check #1.\n2. Check #4.\nNote: #4 must be read before #1.", "precedence", "MEASURE"),
    ],
)
def test_what_stays_open_is_asked(text: str, code: str, said: str, catalog: Catalog) -> None:
    start = _GERMAN if "Prüfe" in text else _ENGLISH
    with pytest.raises(DiagnosticError) as error:
        import_script(start + text, catalog)
    assert code in str(error.value)
    assert said in str(error.value)


def test_table_of_values_to_be_read(catalog: Catalog) -> None:
    text = (
        "Start area:\t1\n\nNo.\tCheckpoint\tDescription\tTask\n1\t1\tpressure gauge 1\tread value\n"
    )
    text += "2\t4\tvalve R25\tread position\n"
    mission = import_script(text, catalog).mission
    assert [t.object_id for t in mission.tasks if t.object_id] == ["1", "4"]
