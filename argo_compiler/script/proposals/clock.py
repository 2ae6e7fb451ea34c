"""Plans by the clock: times of day become minutes from the start, if a line says when that is."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from argo_compiler.script.documents.signs import CLOCK, DATE
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.proposals.mentions import Mentions, mentions_in
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.prose import phrase_pattern

NO_DATES = "a mission has no date: it begins when it is started"
_DAY_MIN = 24 * 60
_STARTS = ("start", "START")
_SIGNS = " \t:,;-–|"


@dataclass(frozen=True)
class Timed:
    """A text without its time of day."""

    text: ScriptText
    minute: int
    """of the day"""
    until: bool = False
    """whether it lasts until then, or has to be done by then"""


@dataclass(frozen=True)
class ClockPlan:
    """Times of day, counted from the start."""

    start_min: int

    def since_start(self, timed: Timed) -> int:
        """Return the minutes from the start to a time of day."""
        return (timed.minute - self.start_min) % _DAY_MIN


def timed(text: ScriptText, understanding: Understanding) -> Timed | None:
    """Return a text with one time of day, at its beginning or behind `until`, without it."""
    found = list(CLOCK.finditer(text.content))
    if len(found) != 1 or int(found[0]["hour"]) > 24 or int(found[0]["minute"]) > 59:
        return None
    start, end = found[0].span()
    cues = understanding.language.prose.cues
    before = re.compile(rf"(?:{phrase_pattern(cues['by_then']).pattern})\s*$", re.IGNORECASE)
    until = before.search(text.content[:start])
    behind = re.compile(rf"\s*(?:{phrase_pattern(cues['latest']).pattern})", re.IGNORECASE)
    latest = behind.match(text.content, end)  # `08:00 at the latest`
    at = re.compile(rf"(?:{phrase_pattern(cues['at_time']).pattern})\s*$", re.IGNORECASE)
    said = until or at.search(text.content[:start])
    end = latest.end() if latest is not None else end
    rest = text.without(said.start() if said is not None else start, end).strip()
    left = len(rest.content) - len(rest.content.lstrip(_SIGNS))
    rest = rest[left : max(left, len(rest.content.rstrip(_SIGNS)))]
    minute = int(found[0]["hour"]) * 60 + int(found[0]["minute"])
    return Timed(rest, minute, (until or latest) is not None) if rest.content else None


def find_plan(texts: Iterable[ScriptText], understanding: Understanding) -> ClockPlan | None:
    """Return the plan of a script in which a line says at which time of day the mission starts."""
    for text in texts:
        found = timed(text, understanding) if CLOCK.search(text.content) else None
        if found is not None and mentions_in(found.text, understanding).has(*_STARTS):
            return ClockPlan(found.minute)
    return None


def has_date(text: ScriptText) -> bool:
    """Return True if a text names a day."""
    return DATE.search(text.content) is not None


def windowed(sentences: tuple[str, ...], minutes: int, by_then: bool) -> tuple[str, ...] | None:
    """Return sentences at a time: each check begins not before it, a return is over by then."""
    made: list[str] = []
    for sentence in sentences:
        said = sentence.removesuffix(".")
        if said.startswith(("Start in", "Order:")):
            made.append(sentence)
        elif said.startswith("Return ") or (by_then and said.startswith("Check ")):
            made.append(f"{said}, not later than {minutes} minutes after the start.")
        elif said.startswith("Check ") and minutes > 0:
            made.append(f"{said}, not before {minutes} minutes after the start.")
        else:
            return None
    return tuple(made) or None


def wait_until(minutes: int) -> str:
    """Return the sentence of a wait that ends at a time."""
    return f"Wait for 1 s, not before {minutes} minutes after the start."


def waits(found: Mentions) -> bool:
    """Return True if a text only says that the robot waits, perhaps where it is."""
    return found.has("WAIT", "PAUSE") and found.only("WAIT", "PAUSE", "place")
