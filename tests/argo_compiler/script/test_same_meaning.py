"""Lines as many people write them mean what the plain ones mean, or are asked about."""

from collections.abc import Callable

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Action
from tests.argo_compiler.script.conftest import filled
from tests.whole_scripts import import_whole

_ENGLISH = "Start in starting area 1.\n"
_GERMAN = "Starte in Startbereich 1.\n"
_ROUNDS = "Check #1 and #4 three times.\n"
_LIMITED = "Check #1 and #4 three times for 5 minutes.\n"
_RUNDEN = "Prüfe #1 und #4 dreimal.\n"
_BEGRENZT = "Prüfe #1 und #4 dreimal für 5 Minuten.\n"
_TRIES = "Check #6. If it cannot be read, retry at most twice and then go on.\nCheck #9."
_WINDOW = "Check #9 not before 10 min and not later than 15 min."

ENGLISH = [
    (f"{_ROUNDS}Stop with it after 5 minutes.", _LIMITED),
    (f"{_ROUNDS}Stop with it after 5 minutes, even if it is not finished by then.", _LIMITED),
    (f"{_ROUNDS}Stop with it after 5 min, even when the rounds aren't completed yet", _LIMITED),
    *(
        (f"Check all valves on {said}.", "Check #4, #5, #10 and #11.")
        for said in ("floors 1 to 3", "floor 1 and on floors 2-3", "floor 1, floor 2 and floor 3")
    ),
    *(
        (
            f"Check #1. If it is above 4, check #4{one} #1 is above 2, check #8{two}",
            "Check #1.\nIf it is above 4, check #4.\nOtherwise, if #1 is above 2, check #8.\n"
            "Otherwise check #3.",
        )
        for one, two in (
            (". Else if", ". Else check #3."),
            (", else if", ", else check #3."),
            ("; otherwise if", "; otherwise check #3."),
        )
    ),
    *(
        (said, "Check #1. If it is above 4, check #4, then check #8. Check #3.")
        for said in (
            "1. Check #1. If it is above 4:\n   a) check #4\n   b) check #8\n2. Check #3.",
            "Check #1.\nIf it is above 4:\n- check #4;\n- check #8.\nCheck #3.",
            "1. Check #1.\n2. If it is above 4, do the following:\n   - check #4,\n   - check #8.\n"
            "3. Check #3.",
        )
    ),
    (_TRIES.replace("retry at most twice", "try again up to two more times"), _TRIES),
    (_TRIES.replace("retry at most twice", "retry it at most two more times"), _TRIES),
    ("Check #9 between minute 10 and minute 15 of the mission.", _WINDOW),
    ("Check #9 between minute 10 and 15 minutes into the mission.", _WINDOW),
    (
        "Check checkpoints 5 to 8. Then the same four in reverse order.",
        "Check checkpoints 5 to 8. Check #8, #7, #6 and #5.",
    ),
    (
        "Check #5. Check #6. Check #7. Check these three checkpoints once more.",
        "Check #5. Check #6. Check #7. Check #5, #6 and #7.",
    ),
    ("Go to floor 2 to valve R12 and check it.", "Check valve R12 on floor 2."),
    (
        "If a gas leak is detected:\n- return home\n- wait until all clear\n- resume\nCheck #1.",
        "Check #1.\nIf a gas leak is detected, return home, wait until all clear, resume.",
    ),
    ("Check all valves of the whole site.", "Check all valves."),
    ("The order of the checkpoints is free.\nCheck #1 and #4.", "Check #1 and #4 in any order."),
    ("Check #1.\n\npage 2 of 3\n\nCheck #4.", "Check #1.\nCheck #4."),
    (
        "Check #1.\n\nTo be obeyed always:\n- If a gas leak is detected, stop.",
        "Check #1.\nIf a gas leak is detected, stop.",
    ),
    (
        "Check valve R12. If it is at more than 4 degrees, check #7.",
        "Check valve R12. If it is above 4 degrees, check #7.",
    ),
    (
        "Check #1. If it is above 4, check #4. Otherwise it reads #3.",
        "Check #1. If it is above 4, check #4. Otherwise check #3.",
    ),
    (
        "pls read presure guage 3 frist\nthen chekc valve R12\n"
        "if the vavle is at more then 4 degrees, read liqiud level gauge 2 too\n"
        "aftr that back to the docking staton, thx",
        "Check #6.\nCheck #5.\nIf the valve is above 4 degrees, check #7.\n"
        "Return to the docking station.",
    ),
    (
        "Check #1 twice, with a pause of 10 minutes in between.",
        "Check #1. Wait 10 minutes. Check #1.",
    ),
    (
        "1. Do the following twice, waiting ten minutes between the rounds:\n   a) check #1\n"
        "   b) check #4\n2. Check #7.",
        "Check #1. Check #4. Wait 10 minutes. Check #1. Check #4. Check #7.",
    ),
    (
        "1. Check #1 and #4 twice. Between two readings wait for 1 minute.",
        "Check #1. Check #4. Wait 1 minute. Check #1. Check #4.",
    ),
    ("do three rounds over checkpoints 5 to 8", "Check checkpoints 5 to 8 three times."),
    ("Check #8. Stay there.", "Check #8. End the mission."),
    ("Check #8, the robot stays there", "Check #8. End the mission."),
    ("Check #8.\n\nThanks a lot and see you on Monday\nJonas", "Check #8."),
    (
        "The robot has to check these valves in any order:\n- R25\n- R12",
        "Check these valves in any order:\n- R25\n- R12",
    ),
    (
        "Check #1 and #4.\n#4 has to be read not later than 5 min after the start.",
        "Check #1.\nCheck #4 not later than 5 minutes after the start.",
    ),
    (
        "Check #5, #6 and #7 in this order. Then check the same ones again in reverse order.",
        "Check #5, #6 and #7 in this order. Check #7, #6 and #5.",
    ),
    (
        "Check #1. If it is above 5, check #4. In all other cases: check #5 instead.",
        "Check #1. If it is above 5, check #4. Otherwise check #5.",
    ),
    (
        "Check #4. When a gas leak is detected, stop where you are and wait until an operator "
        "lets you go on.",
        "Check #4. When a gas leak is detected, pause.",
    ),
    (
        "Check #4. Go back to the docking station of starting area 1, not 2.",
        "Check #4. Go back to the docking station in starting area 1.",
    ),
    ("Check #4. In any case, check #6.", "Check #4. Check #6."),
    (
        "Check #4; this has to be done not later than 4 minutes after the start.",
        "Check #4 not later than 4 minutes after the start.",
    ),
    ("Check #4 and #5. Once all of this is over, go straight home.", "Check #4 and #5. Go home."),
    ("Prüfe #1. Wenn es nicht fehlschlägt, prüfe #4.", "Check #1. Unless it fails, check #4."),
    (
        "1. Check #1. If it fails, go to step 2, otherwise check #4.\n2. Check #8.",
        "1. Check #1. If it fails, go to step 3.\n2. Check #4.\n3. Check #8.",
    ),
    ("Check both #1 and #4.", "Check #1 and #4."),
    ("Make three tours of the second floor.", "Patrol the second floor three times."),
    ("We check #1, thanks a lot.", "Check #1."),
    (
        "Check #1 and #4. If #1 and #4 are both abnormal, check #8.",
        "Check #1 and #4. If #1 and #4 are abnormal, check #8.",
    ),
    ("Check both checkpoints 1 and 4.", "Check #1 and #4."),
    ("Prüfe sowohl #1 als auch #4.", "Check #1 and #4."),
    ("Check #1, then optionally check #4.", "Check #1. Check #4 if there is time."),
    ("Check #1. Finish in starting area 2.", "Check #1. End in starting area 2."),
    (
        "Patrol the first floor and stop with it after 5 minutes.",
        "Patrol the first floor for 5 minutes.",
    ),
    ("Check PG 1, 5 and 8.", "Check pressure gauges 1, 5 and 8."),
    ("Check PG 3, LLG2 and V R12.", "Check #6, #7 and #5."),
    ("Prüfe PG 3.", "Check pressure gauge 3."),
    ("Please do the following:\n1. Check #1.\n2. Check #4.", "Check #1 and #4."),
    ("Bitte mach Folgendes:\n1. Prüfe #1.\n2. Prüfe #4.", "Check #1 and #4."),
    ("Check #8. Do this:\n- Check #1.\n- Check #4.", "Check #8, #1 and #4."),
    ("Check #1 before we leave.", "Check #1."),
    ("Prüfe #1, bevor wir gehen.", "Check #1."),
    ("Check CP4 and Ckpt 1.", "Check #4 and #1."),
    ("Prüfe Kontrollpunkt4.", "Check #4."),
    ("He must look first the valve R7 and after the valve R9.", "Check valve R7 and valve R9."),
    ("Check first pressure gauge 2, then #1.", "Check pressure gauge 2, then #1."),
    ("Check the checkp0int #4 and va1ve R25.", "Check checkpoint #4 and valve R25."),
    (
        "Prüfe Manometer 2. Lässt es sich nicht ablesen, versuche es zweimal.",
        "Check pressure gauge 2. If it cannot be read, retry twice.",
    ),
    (
        "Do the following twice, and wait one minute between the rounds:\n- #1\n- #4",
        "1. Do the following twice with a pause of one minute:\n  a) #1\n  b) #4",
    ),
    (
        "Mache Folgendes zweimal und warte zwischen den Runden eine Minute:\na) #1\nb) #4",
        "1. Do the following twice with a pause of one minute:\n  a) #1\n  b) #4",
    ),
    (
        "Check #1.\nDo the following twice:\n- check #4\n- check #8\nCheck #5.",
        "1. Check #1.\n2. Do the following twice:\n a) check #4\n b) check #8\n3. Check #5.",
    ),
]

FRAMED_ENGLISH = {
    ("Check #1. {}, check #4.", "Check #1. {}, check #4."): [
        ("If it shows more than 20 or less than 5", "If it is above 20 or below 5"),
        ("If none of them is abnormal", "If it is normal"),
        ("If it is outside the range from 3 to 4.5 bar", "If it is below 3 bar or above 4.5 bar"),
        ("If it is not outside of 3 to 4.5 bar", "If it is from 3 to 4.5 bar"),
        ("If it is 3 to 4.5 bar", "If it is from 3 to 4.5 bar"),
        ("If it is 3-4.5 bar", "If it is from 3 to 4.5 bar"),
        ("If it is not 3 to 4.5 bar", "If it is below 3 bar or above 4.5 bar"),
        ("On failure", "If it fails"),
        ("If the robot can't read it", "If it fails"),
        ("If it has not failed", "Unless it fails"),
        ("If it does not fail", "Unless it fails"),
        ("If it is not unreadable", "Unless it is unreadable"),
        ("If it is not readable", "Should it not be readable"),
    ],
    ("Check #1 and #3. If {}, check #4.", "Check #1 and #3. If {}, check #4."): [
        (
            "neither of the two is above 5 bar",
            "#1 is at most 5 bar and #3 is at most 5 bar",
        ),
        ("neither #1 nor #3 is outside its nominal range", "#1 is normal and #3 is normal"),
    ],
    ("Check all valves on {}.", "Check all valves on {}."): [
        ("the first and on the third floor", "floors 1 and 3"),
        ("the second, on the third and on the fourth floor", "floors 2, 3 and 4"),
    ],
}

GERMAN = [
    (f"{_RUNDEN}Höre damit auf nach 5 Minuten.", _BEGRENZT),
    (f"{_RUNDEN}Beende sie nach 5 Minuten, auch wenn sie nicht fertig sind.", _BEGRENZT),
    (
        "Prüfe #5 bis #8. Danach dieselben vier in umgekehrter Reihenfolge.",
        "Prüfe #5 bis #8. Prüfe #8, #7, #6 und #5.",
    ),
    ("Prüfe alle Ventile auf den Etagen 1 bis 3.", "Prüfe #4, #5, #10 und #11."),
    ("Prüfe alle Ventile auf Etage 1, Etage 2 und Etage 3.", "Prüfe #4, #5, #10 und #11."),
    (
        "Prüfe #1. Wenn er über 4 liegt, prüfe #4, sonst wenn er über 2 liegt, prüfe #8, sonst "
        "prüfe #3.",
        "Prüfe #1.\nWenn er über 4 liegt, prüfe #4.\nSonst, wenn er über 2 liegt, prüfe #8.\n"
        "Sonst prüfe #3.",
    ),
    (
        "1. Prüfe #1.\n2. Wenn er über 4 liegt:\n   a) prüfe #4\n   b) prüfe #8",
        "Prüfe #1. Wenn er über 4 liegt, prüfe #4, dann prüfe #8.",
    ),
    ("Prüfe alle Ventile der Anlage.", "Prüfe alle Ventile."),
    (
        "Prüfe #1.\n\nJederzeit zu beachten:\n- Wenn ein Gasleck erkannt wird, halte an.",
        "Prüfe #1.\nWenn ein Gasleck erkannt wird, halte an.",
    ),
    (
        "Prüfe #1.\nZum Schluss in die Dockingstation von Startbereich 2 fahren.",
        "Prüfe #1.\nFahre zur Dockingstation von Startbereich 2.",
    ),
    (
        "Prüfe #1 zweimal, mit einer Pause von 10 Minuten dazwischen.",
        "Prüfe #1. Warte 10 Minuten. Prüfe #1.",
    ),
    (
        "Prüfe #1 zweimal. Zwischen den Ablesungen 1 Minute warten.",
        "Prüfe #1. Warte 1 Minute. Prüfe #1.",
    ),
    (
        "Fahre drei Runden über die Kontrollpunkte 5 bis 8.",
        "Prüfe die Kontrollpunkte 5 bis 8 dreimal.",
    ),
    (
        "Prüfe alle Ventile im ersten und im dritten Stock.",
        "Prüfe alle Ventile im ersten und dritten Stock.",
    ),
    ("Prüfe #8 und bleibe dort.", "Prüfe #8. Beende die Mission."),
    (
        "Prüfe #1. Wenn der Wert größer als 20 oder kleiner als 5 ist, prüfe #4.",
        "Prüfe #1. Wenn der Wert über 20 oder unter 5 ist, prüfe #4.",
    ),
]

WITH_THEIR_START = [
    (f"{_GERMAN}Prüfe #9 zwischen Minute 10 und Minute 15 der Mission.", _ENGLISH + _WINDOW),
    (
        "The robot starts in starting area 1, and the mission may take at most 20 minutes.\n"
        "Check #1.",
        "Maximum duration: 20 min\nStart in starting area 1.\nCheck #1.",
    ),
    (
        "The mission may take at most 20 minutes and starts in starting area 1.\nCheck #1.",
        "Maximum duration: 20 min\nStart in starting area 1.\nCheck #1.",
    ),
    (
        "Der Roboter startet in Startbereich 1, und die Mission darf höchstens 20 Minuten "
        "dauern.\nPrüfe #1.",
        "Maximale Dauer: 20 min\nStarte in Startbereich 1.\nPrüfe #1.",
    ),
    (
        "Seite 1 von 2\nStarte in Startbereich 1.\nPrüfe #1.\nSeite 2/2",
        "Starte in Startbereich 1.\nPrüfe #1.",
    ),
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
        "Start area: 1\nOrder: any\nCheck #1 and #4.\nNote: #4 must be checked before #1.",
        "Start area: 1\nOrder: any\nCheck #1 and #4.\n#4 must be checked before #1.",
    ),
]
"""scripts that say themselves where they start"""


@pytest.mark.parametrize(
    ("said", "plain"),
    [
        *((_ENGLISH + said, _ENGLISH + plain) for said, plain in ENGLISH + filled(FRAMED_ENGLISH)),
        *((_GERMAN + said, _GERMAN + plain) for said, plain in GERMAN),
        *WITH_THEIR_START,
    ],
)
def test_other_words_mean_the_same(
    said: str, plain: str, meaning_of: Callable[[str], object]
) -> None:
    assert meaning_of(said) == meaning_of(plain)


@pytest.mark.parametrize(
    ("title", "rest"),
    [
        ("Versuch 7: Vergleich von zwei Manometern", f"{_GERMAN}#1."),
        ("Trial 7: comparison of two gauges", f"{_ENGLISH}#1."),
        ("# Tour of the pumps", f"{_ENGLISH}Check #8."),
        ("Round of the upper deck crew", f"{_ENGLISH}Check #8."),
        ("Work instruction WI-31 rev. B", "Start area: 1\n1. Check #1."),
        ("Arbeitsanweisung WI-31 Rev. B", "Start area: 1\n1. Check #1."),
    ],
)
def test_titles(title: str, rest: str, catalog: Catalog) -> None:
    mission = import_whole(f"{title}\n\n{rest}", catalog).mission
    assert mission.designation == title.removeprefix("# ")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Check checkpoints 5 to 8. Then the same three again.", "ambiguous-pronoun"),
        ("Check #1 and #4. Check the same two valves again.", "ambiguous-pronoun"),
        ("Check #1 twice for 5 minutes. Stop with it after 6 minutes.", "repeated-limit"),
        ("Check #1. Stop with it after 6 minutes.", "stray-clause"),
        ("Check #1. Wait 1 minute between two readings.", "stray-clause"),
        ("Check #1 three times. Wait between two readings.", "unfinished"),
        ("Check #1 for 20 minutes, with a pause of 1 minute in between.", "script.pause"),
        ("Check #1 three times every 5 min, with a pause of 1 min in between.", "script.pause"),
        ("Check #1.\nDrive back to the docking station.\nCheck #4.", "after-docking"),
        (
            "\n| Checkpoint | Needed |\n|---|---|\n| 4 | no |\n",
            "is optional, or that it is excluded",
        ),
        ("Check #8.\nWait until the operator confirms.", "a mission can't wait for a person"),
    ],
)
def test_what_does_not_fit_is_refused(text: str, said: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match=said):
        import_whole(_ENGLISH + text, catalog)


@pytest.mark.parametrize("how", ["three times", "until it is below 1 bar, at most 3 times"])
def test_pauses_are_between_rounds_only(how: str, catalog: Catalog) -> None:
    text = f"{_ENGLISH}Check #15 {how}. Wait 1 minute between two readings."
    mission = import_whole(text, catalog).mission
    done = [t for t in mission.tasks if t.action is not Action.START]
    waits = [t.wait.duration for t in done if t.wait is not None and t.wait.duration]
    assert waits == [60]
    assert [t.action for t in done][:3] == [Action.MEASURE, Action.WAIT, Action.MEASURE]


def test_wait_longer_than_the_mission(catalog: Catalog) -> None:
    text = f"Maximum duration: 10 min\n{_ENGLISH}Check #1.\nWait for 15 minutes.\nCheck #1."
    found = [d for d in import_whole(text, catalog).diagnostics if "long-wait" in str(d)]
    assert len(found) == 1
    assert found[0].span is not None
    assert found[0].span.line == 4


@pytest.mark.parametrize(
    ("line", "title"),
    [
        (
            "Work order 7781 / site UMAD / start: area 1 / end: area 2",
            "Work order 7781 / site UMAD",
        ),
        ("Evening tour | start area: 1 | end area: 2", "Evening tour"),
        ("Auftrag 12; Startbereich: 1; Endbereich: 2", "Auftrag 12"),
    ],
)
def test_fields_behind_a_title(line: str, title: str, catalog: Catalog) -> None:
    mission = import_whole(f"{line}\n\n#1.", catalog).mission
    assert (mission.designation, mission.start_area, mission.end_area) == (title, 1, 2)


def test_orders_before_fields_are_no_title(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError):
        import_whole("Read the oil meter / start: area 1\n\nCheck #1.", catalog)


@pytest.mark.parametrize(
    "text",
    [
        f"{_ENGLISH}Check #1.\nDrive back to the docking station and stay there for 5 minutes.\n"
        "Check #1 again.\nGo home.",
        f"{_GERMAN}Prüfe #1.\nFahre zur Dockingstation und warte dort 5 Minuten.\n"
        "Prüfe #1 noch einmal.\nFahre nach Hause.",
    ],
)
def test_a_stay_in_the_dock_is_followed_by_more(text: str, catalog: Catalog) -> None:
    tasks = import_whole(text, catalog).mission.tasks
    said = [t.action for t in tasks if t.action is not Action.START]
    back, stay, again = Action.WAYPOINT, Action.WAIT, Action.MEASURE
    assert said == [again, back, stay, again, back]


@pytest.mark.parametrize(
    ("needed", "optional"),
    [("yes", None), ("required", None), ("optional", True)],
)
def test_column_that_says_what_is_needed(
    needed: str, optional: bool | None, catalog: Catalog
) -> None:
    text = f"{_ENGLISH}\n| Checkpoint | Needed |\n|---|---|\n| 4 | {needed} |\n"
    (task,) = (t for t in import_whole(text, catalog).mission.tasks if t.object_id)
    assert bool(task.optional) is bool(optional)


def test_who_stays_before_the_end_is_asked_how_long(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError) as error:
        import_whole(f"{_ENGLISH}Check #8.\nStay there.\nCheck #4.", catalog)
    first = error.value.diagnostics[0]
    assert first.span is not None
    assert (first.span.line, first.code) == (3, "script.wait")


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("1. Check #1.\n2. Check #4.\n3. Repeat this three times.", "step-range", "all steps"),
        ("1. Prüfe #1.\n2. Prüfe #4.\n3. Wiederhole es dreimal.", "step-range", "all steps"),
        ("1. Check #1.\n2. #1 has to be read within 5 minutes.", "ambiguous-demand", "once more"),
        ("1. Check #1.\n2. Check #4.\nNote: #4 must be read before #1.", "precedence", "MEASURE"),
    ],
)
def test_what_stays_open_is_asked(text: str, code: str, said: str, catalog: Catalog) -> None:
    start = _GERMAN if "Prüfe" in text else _ENGLISH
    with pytest.raises(DiagnosticError) as error:
        import_whole(start + text, catalog)
    assert code in str(error.value)
    assert said in str(error.value)


def test_table_of_values_to_be_read(catalog: Catalog) -> None:
    text = (
        "Start area:\t1\n\nNo.\tCheckpoint\tDescription\tTask\n1\t1\tpressure gauge 1\tread value\n"
    )
    text += "2\t4\tvalve R25\tread position\n"
    mission = import_whole(text, catalog).mission
    assert [t.object_id for t in mission.tasks if t.object_id] == ["1", "4"]
