"""How long a reaction holds, and what happens then."""

import pytest

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Afterwards, EventKind, Response
from tests.whole_scripts import import_whole

RESUME, END, WAIT = Afterwards.RESUME, Afterwards.END, Afterwards.WAIT
CLEAR = "until the all-clear"


def read(catalog, said):
    lines = ["Start in starting area 1.", f"If a gas leak is detected, {said}.", "Check #4."]
    (reaction,) = import_whole("\n".join(lines), catalog).mission.reactions
    return reaction


@pytest.mark.parametrize(
    ("said", "until", "limit", "on_limit"),
    [
        ("pause for 5 minutes", None, 300, RESUME),
        ("pause for 5 minutes and go on", None, 300, RESUME),
        (f"wait {CLEAR} for at most 5 minutes and go on", EventKind.ALL_CLEAR, 300, RESUME),
        (f"wait {CLEAR} for at most 5 minutes or else wait", EventKind.ALL_CLEAR, 300, WAIT),
        (f"wait {CLEAR} for at most 5 minutes or else end", EventKind.ALL_CLEAR, 300, END),
        (f"wait {CLEAR}", EventKind.ALL_CLEAR, None, WAIT),
    ],
)
def test_a_pause(catalog, said, until, limit, on_limit):
    found = read(catalog, said)
    assert found.response is Response.PAUSE
    assert (found.until, found.hold_limit, found.on_limit) == (until, limit, on_limit)


def test_a_return(catalog):
    found = read(catalog, f"return, wait {CLEAR} for at most 5 minutes, then go on")
    assert (found.afterwards, found.hold_limit, found.on_limit) == (RESUME, 300, RESUME)


@pytest.mark.parametrize(
    "said",
    [
        "return, wait 10 minutes and go on",
        f"wait {CLEAR} for at most 5 minutes",
        "abort the mission and go on",
        "recharge until the all-clear",
    ],
)
def test_what_can_not_be_or_is_open_is_an_error(catalog, said):
    with pytest.raises(DiagnosticError) as error:
        read(catalog, said)
    assert {d.code for d in error.value.diagnostics} == {"script.reaction"}


CHARGED = EventKind.BATTERY_CHARGED


@pytest.mark.parametrize(
    ("said", "response"),
    [
        ("recharge to 60 % and resume", Response.RETURN),
        ("pause, recharge to 60 % and resume", Response.RETURN),
        ("pause until the battery is charged", Response.PAUSE),
        ("go to starting area 2, recharge to 60 % and resume", Response.SAFE_AREA),
    ],
)
def test_recharging_is_done_in_the_dock_unless_the_script_names_a_place(catalog, said, response):
    text = f"1. Start in starting area 1.\n2. Check #4.\nIf the battery is low, {said}."
    (found,) = import_whole(text, catalog).mission.reactions
    assert (found.response, found.until) == (response, CHARGED)


@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("said", "charge", "time", "limit"),
    [
        ("recharge", None, None, None),
        ("recharge to 60 %", 0.6, None, None),
        ("charge up to 60 percent", 0.6, None, None),
        ("recharge to at least 60 %", 0.6, None, None),
        ("recharge until 60 %", 0.6, None, None),
        ("recharge for at least 10 minutes", None, 600, None),
        ("recharge to 60 % for at least 10 minutes", 0.6, 600, None),
        ("recharge to 60 % for at most 20 minutes", 0.6, None, 1200),
        ("recharge to 100 %", 1.0, None, None),
        ("wait until the battery is charged to 60 %", 0.6, None, None),
        ("wait until the battery is above 60 %", 0.6, None, None),
        ("wait until the battery is at 60 %", 0.6, None, None),
        ("wait until the battery reaches 60 %", 0.6, None, None),
        ("wait until the battery is charged for at least 10 minutes", 1.0, 600, None),
        ("lade auf 60 %", 0.6, None, None),
        ("lade den Akku auf 60 % auf", 0.6, None, None),
        ("lade mindestens 10 Minuten", None, 600, None),
        ("warte, bis der Akku auf 60 % geladen ist,", 0.6, None, None),
        ("warte, bis der Akku über 60 % liegt,", 0.6, None, None),
    ],
)
def test_a_charge_and_a_time_of_charging(catalog, said, charge, time, limit):
    low = f"If the battery drops below 30 %, return, {said} and resume."
    is_german = said.startswith(("lade", "warte"))
    if is_german:
        low = f"Fällt der Akku unter 30 %, kehre zur Ladestation zurück, {said} und fahre fort."
    start, check = (
        ("Start in Startbereich 1.", "Prüfe #4.")
        if is_german
        else ("Start in starting area 1.", "Check #4.")
    )
    text = "\n".join([start, low, check])
    mission = import_whole(text, catalog).mission
    (found,) = mission.reactions
    assert (found.response, found.until, found.afterwards) == (Response.RETURN, CHARGED, RESUME)
    assert (found.charge_to, found.charge_for, found.hold_limit) == (charge, time, limit)


@pytest.mark.rule("R12")
@pytest.mark.parametrize(
    ("said", "charge", "time"),
    [
        ("Recharge", None, None),
        ("Recharge to 80 %", 0.8, None),
        ("Recharge for at least 5 minutes", None, 300),
        ("Wait until the battery is charged to 80 %", 0.8, None),
        ("Wait until the battery is above 80 %", 0.8, None),
    ],
)
def test_a_step_that_charges_in_the_dock(catalog, said, charge, time):
    steps = ["Check #4.", "Go home.", f"{said}.", "Check #1.", "Go home."]
    text = "\n".join(["Start in starting area 1.", *steps])
    mission = import_whole(text, catalog).mission
    (rule,) = (task.wait for task in mission.tasks if task.wait)
    assert (rule.event, rule.charge_to, rule.charge_for) == (CHARGED, charge, time)


@pytest.mark.parametrize(
    ("said", "code"),
    [
        ("recharge to 130 %", "battery"),
        ("recharge to 0 %", "battery"),
        ("recharge to 60 bar", "battery"),
        ("wait until the battery is below 60 %", "battery"),
        ("wait until the all-clear to 60 %", "battery"),
        ("recharge to 60 % and recharge to 80 %", "reaction"),
    ],
)
def test_a_charge_that_can_not_be_is_an_error(catalog, said, code):
    lines = ["Start in starting area 1.", f"If the battery is low, return, {said} and resume."]
    with pytest.raises(DiagnosticError) as error:
        import_whole("\n".join([*lines, "Check #4."]), catalog)
    assert {d.code for d in error.value.diagnostics} == {f"script.{code}"}


def test_a_wait_with_two_times_is_asked_about(catalog):
    with pytest.raises(DiagnosticError, match="ambiguous-manner"):
        read(catalog, f"wait {CLEAR} for 5 minutes for at most 6 minutes")
