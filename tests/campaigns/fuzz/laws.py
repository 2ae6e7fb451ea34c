"""Laws of the script front end, checked on sentences that are generated from the grammar.

- Each input results in a mission or in diagnostics.
- Each parsed word has an effect: another number, unit, event, state or relation in its place
  results in another mission or another message.
- A mission that is written as a script and read again is the same mission.
"""

import random
from dataclasses import dataclass

from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.il import Mission
from argo_compiler.script import format_script
from tests.argo_compiler.script.conftest import CATALOG
from tests.campaigns.fuzz.sentences import SentenceGenerator, Word, text_of
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

FRAME = """\
Mission Protocol #1
1. Start in starting area 1.
2. Check checkpoints 1 to 8.
3. {}.
4. Check checkpoint 3.
5. Go home.
"""
LONGEST = 30
"""words; most longer sentences have an error somewhere"""
REPLACEMENTS = {
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
    """Result of a sentence: a mission or None, and the messages."""

    mission: object
    """mission without its spans in the source; None: there is none"""
    messages: tuple[str, ...]


@dataclass(frozen=True)
class Breach:
    """Law that a sentence breaks."""

    law: str
    sentence: str


def import_sentence(words: list[Word]) -> tuple[Outcome, Mission | None]:
    """Return the result of a sentence in a script, and its mission, if there is one.

    All exceptions but diagnostics are raised.
    """
    text = FRAME.format(text_of(words))
    try:
        resolved = import_whole(text, CATALOG)
    except DiagnosticError as error:
        return Outcome(None, (str(error),)), None
    messages = tuple(f"{d.code} {d.message}" for d in resolved.diagnostics)
    return Outcome(unplaced(resolved.mission), messages), resolved.mission


def try_sentence(
    words: list[Word], generator: SentenceGenerator, rng: random.Random
) -> tuple[str, list[Breach]]:
    """Return `mission` or `refused` for a sentence, and the laws that it breaks."""
    outcome, mission = import_sentence(words)
    if mission is None:
        return "refused", []
    breaches: list[Breach] = []
    if len(words) <= LONGEST:
        breaches += words_without_effect(words, outcome, generator, rng)
    if not has_errors(check(mission, CATALOG)):
        again = import_whole(format_script(mission, CATALOG), CATALOG).mission
        if unplaced(again) != outcome.mission:
            breaches.append(Breach("the mission that is read back is another one", text_of(words)))
    return "mission", breaches


def words_without_effect(
    words: list[Word], outcome: Outcome, generator: SentenceGenerator, rng: random.Random
) -> list[Breach]:
    """Return a breach for each word without effect."""
    breaches: list[Breach] = []
    for i, word in enumerate(words):
        others = [other for other in REPLACEMENTS.get(word.type, ()) if other != word.text]
        others = others or (
            generator.phrases_with_other_meaning(word) if word.type in PHRASES else []
        )
        if not others:
            continue
        replacements = rng.sample(others, min(3, len(others)))
        if all(
            import_sentence([*words[:i], Word(word.type, other), *words[i + 1 :]])[0] == outcome
            for other in replacements
        ):
            breaches.append(Breach(f"`{word.text}` has no effect", text_of(words)))
    return breaches
