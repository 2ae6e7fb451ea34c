"""Laws of the script front end, tried on sentences that are made from the grammar.

- No input ends otherwise than in a mission or in diagnostics.
- Nothing is parsed and not used: a number, a unit, an event, a state or a relation that is
  exchanged for another one makes another mission, or another message.
- What is read back is the same mission.
"""

import random
from dataclasses import dataclass

from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.il import Mission
from argo_compiler.script import format_script, import_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.fuzz.sentences import Said, Sayer, text_of
from tests.mission_writing import unplaced

FRAME = """\
Mission Protocol #1
1. Start in starting area 1.
2. Check checkpoints 1 to 8.
3. {}.
4. Check checkpoint 3.
5. Go home.
"""
LONGEST = 30
"""words; most sentences with more have a mistake somewhere"""
EXCHANGED = {
    "NUMBER": ("2", "3", "4", "6", "8"),
    "IDENT": ("R25", "R12", "R7"),
    "DURATION": ("10 minutes", "90 s", "35 min"),
    "QUANTITY": ("5 bar", "4 bar", "30 %", "10 deg"),
    "SPEED": ("0.3 m/s", "0.2 m/s"),
    "TIMES": ("twice", "three times", "5 times"),
    "ORDINAL": ("first", "second", "third"),
}
PHRASES = ("EVENT", "STATE", "FLOOR_NAME", "KIND")


@dataclass(frozen=True)
class Outcome:
    """What became of a sentence: a mission, or none, and what was said."""

    mission: object
    """without the places in its source; None if there is none"""
    said: tuple[str, ...]


@dataclass(frozen=True)
class Breach:
    """A law that a sentence breaks."""

    law: str
    sentence: str


def outcome_of(words: list[Said]) -> tuple[Outcome, Mission | None]:
    """What becomes of a sentence within a protocol; anything else than a mission and diagnostics
    is raised."""
    text = FRAME.format(text_of(words))
    try:
        resolved = import_script(text, CATALOG)
    except DiagnosticError as error:
        return Outcome(None, (str(error),)), None
    said = tuple(f"{d.code} {d.message}" for d in resolved.diagnostics)
    return Outcome(unplaced(resolved.mission), said), resolved.mission


def try_sentence(words: list[Said], sayer: Sayer, rng: random.Random) -> tuple[str, list[Breach]]:
    """What became of a sentence, `mission` or `refused`, and the laws that it breaks."""
    outcome, mission = outcome_of(words)
    if mission is None:
        return "refused", []
    breaches: list[Breach] = []
    if len(words) <= LONGEST:
        breaches += unused(words, outcome, sayer, rng)
    if not has_errors(check(mission, CATALOG)):
        again = import_script(format_script(mission, CATALOG), CATALOG).mission
        if unplaced(again) != outcome.mission:
            breaches.append(Breach("what is read back is another mission", text_of(words)))
    return "mission", breaches


def unused(words: list[Said], outcome: Outcome, sayer: Sayer, rng: random.Random) -> list[Breach]:
    """The words that make no difference."""
    found: list[Breach] = []
    for i, word in enumerate(words):
        others = [other for other in EXCHANGED.get(word.type, ()) if other != word.text]
        others = others or (sayer.others(word) if word.type in PHRASES else [])
        if not others:
            continue
        tried = rng.sample(others, min(3, len(others)))
        if all(
            outcome_of([*words[:i], Said(word.type, other), *words[i + 1 :]])[0] == outcome
            for other in tried
        ):
            found.append(Breach(f"`{word.text}` is not used", text_of(words)))
    return found
