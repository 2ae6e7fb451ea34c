"""Small words: each has a meaning, is asked about or told, or stands where it has no effect."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Severity
from argo_compiler.il import ConditionType, Order
from argo_compiler.script import Draft, LineState, import_script
from tests.argo_compiler.script.conftest import measured_in

START = "Start in starting area 1.\n"


def draft_of(text: str, catalog: Catalog) -> Draft:
    return import_script(f"{START}{text}", catalog)


def measured(text: str, catalog: Catalog) -> list[str]:
    return measured_in(draft_of(text, catalog).require_mission())


def conditions(text: str, catalog: Catalog) -> list[tuple[str | None, ConditionType, object]]:
    mission = draft_of(text, catalog).require_mission()
    ways = (way for task in mission.tasks for way in task.transitions)
    return [(c.object_id, c.type, c.param1) for way in ways for c in way.conditions]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Check valve R25. Check the next valve.", "`next`"),
        ("Check #1. If it is a normal, check #4.", "`a`"),
        ("Check #1. If it is also above 4, check #4.", "`also`"),
        ("Don't just check #9.", "`Don't`"),
        ("Check #1 at the same time, then #4.", "`at`"),
        ("Check #1 and #4. First check #8.", "come first"),
        ("Prüfe #1 und #4. Prüfe zuerst #8.", "come first"),
        ("Check #1 and then #4 twice.", "last item, or of all"),
        ("Check #1, then #4 at 0.2 m/s.", "last item, or of all"),
        ("Prüfe #1 und dann #4 zweimal.", "last item, or of all"),
        ("Check #1 and #4 and go home twice.", "the way only"),
        ("Patrol floor 1 three times for 10 minutes.", "each round"),
        ("Check #1. Check #3 and check #6 if it is above 4.", "an earlier one"),
        ("Check #1. Should the robot check #4?", "`Should`"),
        ("Check #1. Does it have to check #4?", "`Does"),
        ("Check #1. Is checkpoint 4 checked?", ""),
        ("Check #1. Check #4?", "a question"),
        ("Prüfe #1. Prüfe #4?", "a question"),
        ("Check #4 again.", "is not measured before"),
        ("Once again: check #4.", "is not measured before"),
        ("Check gauge 8.", "pressure gauge 5 (#8)"),
        ("Check all level gauges except number 3.", "liquid level gauge 3, which is"),
        ("Today check #1 and #2. Tomorrow check #3.", "another day than `today`"),
        ("Check #16 on Monday. Check #17 on Tuesday.", "another day than `on monday`"),
        ("Day 1: #4. Day 2: #5.", "no field `Day 1`"),
        ("Hour 1: #4. Hour 2: #5.", "no field `Hour 1`"),
        ("3. Check #1\n1. Check #3\n2. Check #2", "the order of their numbers"),
        ("Check #4 in reverse order.", "no reverse order"),
        ("Check the valves on floor 3 and the gauges.", "on all floors"),
        # what a remark says of checkpoints or their order, labelled or not
        ("Read #1, #2, #3 - the 2 is a slip, 4 was meant.", "a change, or a remark"),
        ("Read #1, #2 and #3 (that one is a mistake).", "a change, or a remark"),
        ("- #4\n- #1 (before that)", "a change, or a remark"),
        ("- #4\n- #1 (vorher)", "a change, or a remark"),
        ("Gauges (pressure)\n1, 2, 5", "a change, or a remark"),
        ("Note: the order on the sheet is wrong.\n#18, #17, #16", "a change, or a remark"),
        ("Note: reversed!\n#18, #17, #16", "a change, or a remark"),
        ("Bemerkung: richtig ist umgekehrt.\n#18, #17, #16", ""),
        # numbers that are of something else
        ("Contact: ext. 14\nCheck valve R40.", "or have no meaning"),
        ("Robot #2 shall read #6 and #8.", ""),
        ("Roboter Nr. 2 soll #6 prüfen.", ""),
        # remarks that deny, add to, or are about who does it
        ("- #6 (ok)\n- #7 (no access)", "a change, or a remark"),
        ("R25 - y\nR12 - n", "a change, or a remark"),
        ("#1 - nein\n#2 - ja", "a change, or a remark"),
        ("#7 - me\n#8 - you", "a change, or a remark"),
        ("Pressure gauges 1, 2 and 3 - levels too.", "a change, or a remark"),
        ("Manometer 1 und 2 - Füllstände auch.", ""),
        ("R25 | yes\nR12 | no", "the row is not meant"),
        ("Point\tread?\nR25\tyes\nR12\tn", ""),
        # marks that give another order
        ("1st: #20\n3rd: #14\n2nd: #17", "the order of their numbers"),
        ("First: #20\nThird: #14\nSecond: #17", "the order of their marks"),
        ("c) #20\na) #14\nb) #17", "the order of their marks"),
        ("Top down:\n#1\n#9\n#20", "`Top down:`"),
        ("Von oben nach unten:\n#1\n#9", ""),
        # headings, greetings and fields that name something
        ("Deferred\n- R18\nNow\n- #13, #15", "are not tasks"),
        ("Point 3, pressure gauge 3 and level gauge 3.", ""),
        ("Lieber R31 als R7, und das zuerst, dann #12.", ""),
        ("Dear R31, then #12.", ""),
        ("Level gauges 1 to 5\nless: 3", "`less`"),
        ("#17, and the one after that.", "`the`"),
        # kinds without a verb over what names some of them, and several of a value at the end
        ("Floor 2 valves\n- R12\n- R25", "a heading of those below it, or a command"),
        ("Ventile, Stockwerk 2\n- R12", "a heading of those below it, or a command"),
        ("Gauges\nPG 3\n#8\nValves\nR12", "a heading of those below it, or a command"),
        ("Check the valves on floor 2\n- R12", "a heading of those below it, or a command"),
        ("Check all gauges on floor 1.\n- PG 1\n- PG 2", "a heading of those below it, or"),
        ("Inspect floor 2\nR12\nPG 3", "a heading of those below it, or a command"),
        ("Check on floor 1.", "what is read there"),
        ("Take a reading on floor 2.\nCheck #1.", ""),
        ("Check all valves\n#3", "a heading of those below it, or a command"),
        ("Check all valves:\n- #3\n- R12", "there is no valve 3"),
        ("All valves R12 and R25", ""),
        ("Check #1.\nPressures", "`Pressures`"),
        ("Check #1.\n\nPressures", "`Pressures`"),
        # marks of answers, signs for the same as above, the order of the lines
        ("(y) pressure gauge 7\n(n) R18\n(y) pressure gauge 6", "which of them are meant"),
        ('floor 2: pressure gauge 3\n   "   : pressure gauge 5\n   "   : R12', "repeat"),
        ("Oben anfangen.\nEtage 1: #2\nEtage 3: #12", "`Oben`"),
        ("Sheet is upside down, so last line first:\nR25\nR31", "`Sheet`"),
        ("A. #1\nB. #6\nC. #9\nOrder: C, A, B", "is not a valid order"),
        # columns with unknown headings, who does it, letters and figures
        ("what; times\nR31; 2\n#20; 1", "`what`"),
        ("Team A takes:\n#1, #4\nRobot takes:\n#14, #17", "who does what is below"),
        ("Ma 6, R18, dann heim.", "`Ma`"),
        # number and name side by side, and numbers that count
        ("#8, pressure gauge 8", "or only one of them"),
        ("Pressure gauge 8, #8, R7", "or only one of them"),
        ("Pressure gauge number four is #9 and number three is #6.", "`is`"),
        ("Read the pressure gauges 2-4, so three of them.", "`of them`"),
        ("Check the seven.", "`the`"),
        ("Pressure gauge 5 - #8", "or number and name"),
        # numbers that may count, and pronouns of more than two readings
        ("Check PG 1, LLG 1 and PG 2.\nIf two are out of range abort.", "`two`"),
        ("Prüfe #1, #2 und #3.\nWenn zwei über 4 liegen, abbrechen.", "`zwei`"),
        ("Check #1.\nCheck #6.\nCheck #8.\nIf any of them is out of range, abort.", "or all"),
        # no proposal over a condition, a range, or without a name
        ("Check R9.\nShould the way to floor 6 be blocked, leave out R9.", ""),
        ("R9 prüfen.\nSollte Etage 6 gesperrt sein, R9 auslassen.", ""),
        ("PG 1 to PG 4", ""),
        ("Check PG 1 - PG 4.", ""),
        ("Read LLG 2\nRead level gauge XX", ""),
        # requests among the entries of a log
        ("SHIFT LOG\n18:20 pump B tripped\n22:00 check R31\nCheck #1.", "`check`"),
        ("SHIFT LOG\n18:20 pump B tripped\n22:10 R7 looked odd\nCheck #1.", ""),
        # boxes behind a name
        ("Valve R7: read it? yes [ ] no [x]\nCheck #1.", "ticked"),
        ("Valve R7 [x] yes [ ] no\nCheck #1.", "ticked"),
        ("(x)  Valve R12\n( )  Pressure gauge 3", "ticked"),
        ("1. (X) Valve R12\n2. ( ) Pressure gauge 3", "ticked"),
        ("Valve R12 (x)\nPressure gauge 3", "`x`"),
        # what may be the occasion of a return, or what ends
        ("Check #1.\nSiren: back to the dock at once", ""),
        ("Check #1.\nThunderstorm - return to the docking station", ""),
        ("Check #1.\nSpecial: in heavy rain return to the dock", ""),
        ("Check #1.\nEND OF LIST", ""),
        ("Prüfe #1.\nEnde der Liste", ""),
        # kinds with lists behind a colon
        ("Check #1.\nLevels: 4, 5", "no field `Levels`"),
        ("Check #1.\nGauges: see list", "no field `Gauges`"),
        ("Level gauges: all on floor 1\nCheck #1.", "no field `Level gauges`"),
        ("Number of checkpoints: 3\nCheckpoints: 14, 15", "no field `Number of checkpoints`"),
        # a duty that may not be one, counts behind lists, limits of several tasks
        ("Could: #5, #6, #7", "in some cases only, or always"),
        ("Could:\n- #5\n- #6", "not tasks, or not always"),
        ("PG1, then PG2 (3x)", "last item, or of all"),
        ("Manometer 1, danach Manometer 2 (3x)", "last item, or of all"),
        ("Check #1 and #4. At most 30 minutes.", "or of the whole mission"),
        (
            "Prüfe R7 und R31. Nicht länger als eine Stunde, und wenn ein Gasleck erkannt wird, "
            "fahre heim.",
            "or of the whole mission",
        ),
        ("Check R31 - in case of smoke: call the guard", ""),
        ("Check #1.\nAll gauges on floor 2, but level gauge 2 last", "`last`"),
        # items to go back to, ticks and strokes
        ("a) R12\nb) R7\nc) go back to a)", ""),
        ("1. valve R25\n2. valve R12 (crossed out)", "a change, or a remark"),
        ("#17\n#18 – durchgestrichen", "a change, or a remark"),
        ("As ticked.\n#13 #14 #15", ""),
        ("Nr   CP   Remark\n1    13   after the 14th of May\n2    15", "a change, or a remark"),
        ("Seq.\tCheckpoint\tFloor\n20\t1\t1\n10\t19\t6", "another order of the rows"),
        ("nr;checkpoint;position in the order\n1;R31;2\n2;R7;1", "another order of the rows"),
        # the same reading, or one more
        ("Check #7. Read it.", "or one more"),
        ("1. #7 and #8\n2. Read them.", "or one more"),
        ("Prüfe #7. Lies es ab.", "or one more"),
        ("Valves\nR31, R7\nGauges\nnone today", "the line above"),
        # a word of its own is not a misspelt one
        ("Alles auf Etage 1 außer den Manometern, #1 aber doch.", "`doch`"),
        ("Check all valves and all gauges on floor 3.", "the last one only"),
        ("Check everything except the valves on floor 2 and floor 3.", "a further exception"),
        ("Check #1. If it is above 4 bara, check #4.", "absolute"),
        ("Check #1. If it is above 60 psia, check #4.", "absolute"),
        ("Check #1. If it is open, check #4.", "no valve"),
        (
            "Check pressure gauges 1 and 2, then valve R25. If the pressure is above 4, go home.",
            "or",
        ),
        ("Check valve R25. If the level is above 4, go home.", "is measured before"),
        ("Checkpoint | Action\n4 | -\n8 | read", "`-`"),
        ("Checkpoint | Remark\n4 | N/A\n8 | ok", "`N/A`"),
        ("Check #13 or you check #15.", "`you`"),
        ("Check #1, or if it is above 4, check #4.", "or`"),
        ("Start in starting area 1, or the mission may take at most 20 minutes.", "or`"),
        ("Check #1 at 0.3 m/s or twice.", "`or`"),
        ("Wait an hour or a half.", "`or`"),
        ("Wait 1 hour but 30 minutes.", "`but`"),
        ("Warte 1 Stunde oder 30 Minuten.", "`oder`"),
        ("- Check #1 or\n- Check #4", "`or`"),
        ("- #1 oder\n- #4", "`oder`"),
        ("Check everything on floor 6 (that is, the gauge; the valve can wait).", "a change"),
    ],
)
def test_what_is_asked_about(text: str, words: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    assert draft.mission is None
    opened = [line for line in draft.lines if line.state is LineState.OPEN]
    assert opened
    assert any(words in line.reason for line in opened), [line.reason for line in opened]


@pytest.mark.parametrize(
    "title",
    [
        "R25 is locked out.",
        "CANCELLED: round of floor 2",
        "Skip:\n- #1",
        "DRAFT - ask Tom before use",
        "EXAMPLE ONLY",
        "Superseded by sheet 2",
        "Checklist [void]",
        "Nur zur Information",
        "Forbidden: floor 6",
        "Too high: #3?",
        "Round for three robots; yours is the second part",
        "In reverse order:",
        "Half as often #13 as #15, and #15 four times",
    ],
)
def test_a_first_line_that_may_change_the_plan_is_no_title(title: str, catalog: Catalog) -> None:
    draft = import_script(f"{title}\n{START}Check #5.", catalog)
    assert draft.mission is None


@pytest.mark.parametrize(
    ("first", "checkpoints"),
    [("Floor 2, valves", ["5"]), ("Valves floor 3", ["10", "11"]), ("Ventile, Etage 2", ["5"])],
)
def test_a_first_line_that_lists_kinds_on_a_floor_is_an_order(
    first: str, checkpoints: list[str], catalog: Catalog
) -> None:
    mission = import_script(f"{first}\nCheck #9.", catalog, start_area=1).require_mission()
    assert [task.object_id for task in mission.tasks if task.object_id] == [*checkpoints, "9"]


@pytest.mark.parametrize(
    ("text", "checkpoints"),
    [
        ("Please check the valve R25 now, then go to floor 2 and check #5 as well.", ["4", "5"]),
        ("Check the valves and gauges on floor 3.", ["10", "11", "9", "12"]),
        ("Check all gauges and valves on floor 3.", ["9", "12", "10", "11"]),
        ("Prüfe die Ventile und Manometer im dritten Stock.", ["10", "11", "9"]),
        ("Could you check #1, please?", ["1"]),
        ("- #1,\n- #4 and\n- #8", ["1", "4", "8"]),
        ("Könntest du bitte #1 prüfen?", ["1"]),
        ("Check PG 1, then R25, then PG 5.", ["1", "4", "8"]),
        ("On floor 2, first check #5, then #7.", ["5", "7"]),
        ("First check #8.\nCheck #1.", ["8", "1"]),
        ("#8, pressure gauge 5, R7", ["8", "11"]),
        ("#8 and pressure gauge 8", ["8", "18"]),
        ("Floor 2: valves\nFloor 3: both valves", ["5", "10", "11"]),
        # kinds and floors over a list are its heading
        ("Check the valves on floor 2:\n- R12\n- R25", ["5", "4"]),
        ("Valves and gauges on floor 2:\n- R12\n- PG 3", ["5", "6"]),
        ("Inspect floor 2:\n- R12\n- PG 3", ["5", "6"]),
        ("Prüfe Etage 2:\n- R12", ["5"]),
        # a name with a blank in it
        ("PG 6\nLG 2\nR 18", ["13", "7", "14"]),
        ("R-12, R 7 and R31", ["5", "11", "10"]),
        # floors as objects
        ("Inspect floor 2.", ["5", "6", "7", "8"]),
        ("Check floors 2 and 3 except R12.", ["6", "7", "8", "9", "10", "11", "12"]),
        ("Prüfe das zweite Stockwerk.\nDanach #1.", ["5", "6", "7", "8", "1"]),
    ],
)
def test_what_is_read(text: str, checkpoints: list[str], catalog: Catalog) -> None:
    assert measured(text, catalog) == checkpoints


@pytest.mark.parametrize(
    ("text", "checkpoints"),
    [
        ("Valves: R25, R12\nPressure gauges: 4, 5", ["4", "5", "9", "8"]),
        ("Ventile: R25, R12\nManometer: 4 und 5", ["4", "5", "9", "8"]),
    ],
)
def test_a_kind_before_a_colon_is_that_of_the_list(
    text: str, checkpoints: list[str], catalog: Catalog
) -> None:
    assert measured(text, catalog) == checkpoints


def test_what_comes_then_in_any_order_comes_after_the_first(catalog: Catalog) -> None:
    mission = draft_of("Check #14, then #1, #4 and #8 in any order.", catalog).require_mission()
    assert mission.order is Order.ANY
    assert {pair[0] for pair in mission.before} == {"MEASURE 14"}
    assert len(mission.before) == 3


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Check #2. Check #1. If the level is above 50, go home.", "2"),
        ("Check #1. Check #4. If the pressure is above 4, go home.", "1"),
        ("Check #4. Check #1. If the position is above 45, go home.", "4"),
        ("Prüfe #1. Prüfe #4. Wenn der Druck über 4 liegt, fahre nach Hause.", "1"),
    ],
)
def test_a_quantity_is_of_what_shows_it(text: str, asked: str, catalog: Catalog) -> None:
    assert conditions(text, catalog)[0][0] == asked


@pytest.mark.parametrize(
    ("state", "type_", "bound"),
    [
        ("is open", ConditionType.GREATER, 80),
        ("is not open", ConditionType.LESS, 80),
        ("is closed", ConditionType.LESS, 10),
        ("isn't closed", ConditionType.GREATER, 10),
        ("is half open", ConditionType.WITHIN, 35),
    ],
)
def test_positions_of_valves(
    state: str, type_: ConditionType, bound: float, catalog: Catalog
) -> None:
    found = conditions(f"Check valve R25. If it {state}, check #8.", catalog)
    assert found[0] == ("4", type_, bound)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Check #1. If it is just above 4, check #4.", "`just`"),
        ("Only check #1.", "`Only`"),
        ("Check #1 carefully.", "`carefully`"),
        ("Check #1 tonight.", "`tonight`"),
        ("Dear Paul,\nCheck #1.", "`Dear Paul,`"),
        ("Check the valves in this order:\n- #6\n- #1", "`Check the valves in this order:`"),
        ("Prüfe #1. Danach soll er noch Manometer 5 prüfen.", "`noch`"),
        ("Kontrollpunkt #4: Druck des Ventils R25 ablesen", "no pressure"),
        ("Point | Normal range\nliquid level gauge 1 | 20 - 80 bar", "is in bar here"),
        ("Check the valves in any order:\n- #6\n- #1", "`valves`"),
    ],
)
def test_what_has_no_effect_is_a_warning(text: str, words: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    assert draft.mission is not None
    warnings = [d for d in draft.diagnostics if d.severity is Severity.WARNING]
    assert any(words in d.message for d in warnings)


def test_letters_with_accents_of_their_own_are_read(catalog: Catalog) -> None:
    composed = "Prüfe alle Ventile im dritten Stock außer R31."
    decomposed = composed.replace("ü", "u\u0308")
    assert measured(decomposed, catalog) == measured(composed, catalog) == ["11"]
