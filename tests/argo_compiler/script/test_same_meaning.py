"""What is said beside orders: limits of what was ordered, the mission's time, counts, headings."""

from collections.abc import Callable

import pytest

from argo_compiler.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import import_script

_ENGLISH = "Start in starting area 1.\n"
_GERMAN = "Starte in Startbereich 1.\n"
_ROUNDS = f"{_ENGLISH}Check #1 and #4 three times.\n"
_LIMITED = f"{_ENGLISH}Check #1 and #4 three times for 5 minutes.\n"
_RUNDEN = f"{_GERMAN}Prüfe #1 und #4 dreimal.\n"
_BEGRENZT = f"{_GERMAN}Prüfe #1 und #4 dreimal für 5 Minuten.\n"


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        (f"{_ROUNDS}Stop with it after 5 minutes.", _LIMITED),
        (f"{_ROUNDS}Stop with it after 5 minutes, even if it is not finished by then.", _LIMITED),
        (f"{_ROUNDS}Stop with it after 5 min, even when the rounds aren't completed yet", _LIMITED),
        (f"{_RUNDEN}Höre damit auf nach 5 Minuten.", _BEGRENZT),
        (f"{_RUNDEN}Beende sie nach 5 Minuten, auch wenn sie nicht fertig sind.", _BEGRENZT),
        (
            f"{_ENGLISH}Check checkpoints 5 to 8. Then the same four in reverse order.",
            f"{_ENGLISH}Check checkpoints 5 to 8. Check #8, #7, #6 and #5.",
        ),
        (
            f"{_ENGLISH}Check #5. Check #6. Check #7. Check these three checkpoints once more.",
            f"{_ENGLISH}Check #5. Check #6. Check #7. Check #5, #6 and #7.",
        ),
        (
            f"{_GERMAN}Prüfe #5 bis #8. Danach dieselben vier in umgekehrter Reihenfolge.",
            f"{_GERMAN}Prüfe #5 bis #8. Prüfe #8, #7, #6 und #5.",
        ),
        (
            "The robot starts in starting area 1, and the mission may take at most 20 minutes.\n"
            "Check #1.",
            f"Maximum duration: 20 min\n{_ENGLISH}Check #1.",
        ),
        (
            "The mission may take at most 20 minutes and starts in starting area 1.\nCheck #1.",
            f"Maximum duration: 20 min\n{_ENGLISH}Check #1.",
        ),
        (
            "Der Roboter startet in Startbereich 1, und die Mission darf höchstens 20 Minuten "
            "dauern.\nPrüfe #1.",
            f"Maximale Dauer: 20 min\n{_GERMAN}Prüfe #1.",
        ),
        (f"{_ENGLISH}Check #1.\n\npage 2 of 3\n\nCheck #4.", f"{_ENGLISH}Check #1.\nCheck #4."),
        (f"Seite 1 von 2\n{_GERMAN}Prüfe #1.\nSeite 2/2", f"{_GERMAN}Prüfe #1."),
        (
            f"{_ENGLISH}Check #1.\n\nTo be obeyed always:\n- If a gas leak is detected, stop.",
            f"{_ENGLISH}Check #1.\nIf a gas leak is detected, stop.",
        ),
        (
            f"{_GERMAN}Prüfe #1.\n\nJederzeit zu beachten:\n- Wenn ein Gasleck erkannt wird, "
            "halte an.",
            f"{_GERMAN}Prüfe #1.\nWenn ein Gasleck erkannt wird, halte an.",
        ),
        (
            f"{_ENGLISH}Check valve R12. If it is at more than 4 degrees, check #7.",
            f"{_ENGLISH}Check valve R12. If it is above 4 degrees, check #7.",
        ),
        (
            f"{_ENGLISH}Check #1. If it is above 4, check #4. Otherwise it reads #3.",
            f"{_ENGLISH}Check #1. If it is above 4, check #4. Otherwise check #3.",
        ),
        (
            f"{_ENGLISH}pls read presure guage 3 frist\nthen chekc valve R12\n"
            "if the vavle is at more then 4 degrees, read liqiud level gauge 2 too\n"
            "aftr that back to the docking staton, thx",
            f"{_ENGLISH}Check #6.\nCheck #5.\nIf the valve is above 4 degrees, check #7.\n"
            "Return to the docking station.",
        ),
        (
            f"{_GERMAN}Prüfe #1.\nZum Schluss in die Dockingstation von Startbereich 2 fahren.",
            f"{_GERMAN}Prüfe #1.\nFahre zur Dockingstation von Startbereich 2.",
        ),
    ],
)
def test_other_words_mean_the_same(
    said: str, plain: str, meaning_of: Callable[[str], object]
) -> None:
    assert meaning_of(said) == meaning_of(plain)


@pytest.mark.parametrize(
    ("title", "start"),
    [
        ("Versuch 7: Vergleich von zwei Manometern", _GERMAN),
        ("Trial 7: comparison of two gauges", _ENGLISH),
    ],
)
def test_title_with_a_colon(title: str, start: str, catalog: Catalog) -> None:
    assert import_script(f"{title}\n\n{start}#1.", catalog).mission.designation == title


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Check checkpoints 5 to 8. Then the same three again.", "ambiguous-pronoun"),
        ("Check #1 and #4. Check the same two valves again.", "ambiguous-pronoun"),
        ("Check #1 twice for 5 minutes. Stop with it after 6 minutes.", "repeated-limit"),
        ("Check #1. Stop with it after 6 minutes.", "stray-clause"),
    ],
)
def test_what_does_not_fit_is_refused(text: str, code: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match=code):
        import_script(_ENGLISH + text, catalog)
