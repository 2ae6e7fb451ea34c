"""How long a reaction holds, and what happens then."""

import pytest

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import Afterwards, EventKind, Response
from argo_compiler.script import import_script

RESUME, END, WAIT = Afterwards.RESUME, Afterwards.END, Afterwards.WAIT
CLEAR = "until the all-clear"


def read(catalog, said):
    lines = ["Start in starting area 1.", f"If a gas leak is detected, {said}.", "Check #4."]
    (reaction,) = import_script("\n".join(lines), catalog).mission.reactions
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


def test_a_wait_with_two_times_is_asked_about(catalog):
    with pytest.raises(DiagnosticError, match="ambiguous-manner"):
        read(catalog, f"wait {CLEAR} for 5 minutes for at most 6 minutes")
