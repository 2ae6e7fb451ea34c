"""A script that is laid out otherwise is the same mission, or an error, and never another one."""

import re
import textwrap
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.diagnostics import DiagnosticError
from tests.argo_compiler.script.conftest import CATALOG
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

Steps = list[str]

SCRIPTS: list[Steps] = [
    [
        "Start in starting area 1.",
        "Check checkpoints 1, 4 and 8 to 10 with priority 3.",
        "Check all valves except R12 at 0.3 m/s.",
        "Patrol the first floor for 10 minutes.",
        "If a gas leak is detected, return to the docking station and end the mission.",
        "Check checkpoint 1. If the value is above 5, check checkpoint 4.",
        "Go home.",
    ],
    [
        "Start in starting area 2.",
        "Check #1 and #4.",
        "Check #8 within 10 minutes of the start. If it is abnormal, check #14.",
        "Repeat steps 2 to 3 twice.",
        "Keep reading checkpoint 4 until the value is below 3, at most 10 times.",
        "Go home.",
    ],
    [
        "Starte in Startbereich 1.",
        "Prüfe die Kontrollpunkte 1, 4 und 8 bis 10 mit Priorität 3.",
        "Wiederhole Schritt 2 dreimal.",
        "Prüfe die Ventile im 2. und 3. Stock.",
        "Wenn ein Gasleck erkannt wird, kehre zur Dockingstation zurück und beende die Mission.",
        "Prüfe Kontrollpunkt 1. Wenn der Wert über 4,5 liegt, prüfe Kontrollpunkt 14.",
        "Warte 90 s und fahre dann zur Dockingstation.",
    ],
]


def numbered(form: str) -> Callable[[Steps], str]:
    return lambda steps: "\n".join(form.format(i, step) for i, step in enumerate(steps, 1))


def changed(old: str, new: str) -> Callable[[Steps], str]:
    return lambda steps: numbered("{}. {}")(steps).replace(old, new)


def mission(text: str) -> object:
    """The mission; None if there is an error."""
    try:
        return unplaced(import_whole(text, CATALOG).mission)
    except DiagnosticError:
        return None


WANTED = [mission(numbered("{}. {}")(steps)) for steps in SCRIPTS]
ALIKE = {
    form: numbered(form)
    for form in (
        *("{}) {}", "({}) {}", "[{}] {}", "{}.) {}", "{}.{}", "{}: {}", "{} - {}", "{:02}. {}"),
        *("Step {}: {}", "STEP {}. {}", "Schritt {}: {}", "**{}.** {}", "## Step {}\n{}"),
        *("- {}. {}", "> {}. {}", ">> {}. {}", "{}. **{}**", "{}. _{}_", "{}. `{}`"),
        *("{}. {}\n", "    {}. {}", "\t{}. {}", "{}. {}  ", "{}. {}\t"),
    )
} | {
    "a line's end of two signs": changed("\n", "\r\n"),
    "blanks that do not break": changed(" ", "\u00a0"),
    "two blanks": changed(" ", "  "),
    "dashes": changed("-", "\u2013"),
    "without stops": lambda steps: numbered("{}. {}")([step.rstrip(".") for step in steps]),
    "in one line": lambda steps: numbered("{}. {}")(steps).replace("\n", " "),
    "small letters": lambda steps: numbered("{}. {}")(steps).lower(),
    "in a fence": lambda steps: f"```\n{numbered('{}. {}')(steps)}\n```",
    "a table": lambda steps: f"| Step | Action |\n|---|---|\n{numbered('| {} | {} |')(steps)}",
    "a boxed table": lambda steps: (
        f"+---+---+\n| Step | Action |\n+---+---+\n{numbered('| {} | {} |')(steps)}\n+---+---+"
    ),
    "a table of tabs": lambda steps: "Step\tAction\n" + numbered("{}\t{}")(steps),
    "semicolons": lambda steps: "Step;Action\n" + numbered("{};{}")(steps),
    "commas": lambda steps: "Step,Action\n" + numbered('{},"{}"')(steps),
}


@pytest.mark.parametrize("layout", ALIKE)
def test_what_is_laid_out_otherwise_is_the_same(layout: str) -> None:
    for steps, wanted in zip(SCRIPTS, WANTED, strict=True):
        assert wanted is not None
        assert mission(ALIKE[layout](steps)) == wanted


@pytest.mark.parametrize(
    "mark", ["- ", "* ", "• ", "– ", "-", "☐ ", "→ ", "[ ] ", "a) ", "No. {}: "]
)
@pytest.mark.parametrize("steps", SCRIPTS)
def test_other_marks_never_make_another_mission(mark: str, steps: Steps) -> None:
    text = numbered(mark + "{1}" if "{" not in mark else "No. {}: {}")(steps)
    assert mission(text) in (None, WANTED[SCRIPTS.index(steps)])


@given(
    st.sampled_from(range(len(SCRIPTS))),
    st.integers(14, 90),
    st.sampled_from(["", "   ", "\t"]),
    st.sampled_from(["", "> "]),
    st.sampled_from(["{}. {}", "- {1}", "Step {}: {}", "{}) {}"]),
)
def test_a_wrapped_step_loses_nothing(
    script: int, width: int, indent: str, quote: str, form: str
) -> None:
    lines = [
        line
        for step in numbered(form)([s.replace(" ", "\v") for s in SCRIPTS[script]]).split("\n")
        for line in textwrap.wrap(
            step.replace("\v", " "), width, subsequent_indent=indent, break_long_words=False
        )
    ]
    found = mission("\n".join(quote + line for line in lines))
    assert found in (None, WANTED[script])


@pytest.mark.parametrize("width", range(34, 90, 7))
@pytest.mark.parametrize("steps", SCRIPTS)
def test_a_step_may_be_wrapped(width: int, steps: Steps) -> None:
    text = "\n".join(
        textwrap.fill(f"{i}. {step}", width, break_long_words=False)
        for i, step in enumerate(steps, 1)
    )
    assert mission(text) == WANTED[SCRIPTS.index(steps)]


def test_a_sign_before_a_single_line_is_no_letters() -> None:
    text = "1. Start in starting area 1.\n2. Check #1. If it is\n> 5, check #4.\n3. Go home."
    assert mission(text) == mission(re.sub(r"\n>", " >", text))


@pytest.mark.parametrize(
    ("line", "cut"),
    [
        ("If the connection is lost, wait until it is restored, then go on.", "then"),
        ("On a gas leak wait for the all-clear and then go on.", "then"),
        ("If there is time, check checkpoint 14 as well.", "checkpoint"),
        ("Maximum duration: 4 min. When the time is up, drive to the dock in area 2.", "dock"),
    ],
)
def test_what_a_line_cuts_is_kept(line: str, cut: str) -> None:
    script = "{}\n\n1. Start in starting area 1.\n2. Check #1.\n3. Go home."
    whole = mission(script.format(line))
    assert whole is not None
    assert mission(script.format(line.replace(f" {cut} ", f" {cut}\n"))) == whole
