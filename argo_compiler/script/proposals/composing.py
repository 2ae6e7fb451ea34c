"""What a clause proposes: a sentence that uses all of it that means something.

A proposal never passes over a negation, a condition or a correction. Where parts are left that no
sentence uses, the clause stays open, and its checkpoints are what can be chosen.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from argo_compiler.base.catalog import Catalog, CheckpointInfo
from argo_compiler.script.documents.source import Diagnostics, RefusedError, ScriptText
from argo_compiler.script.proposals.mentions import (
    Mention,
    Mentions,
    checkpoint_words,
    is_pronoun,
    mentions_in,
)
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.nouns import Memory, NounResolver
from argo_compiler.script.sentences.tree.nouns import Nouns
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation, FloorName
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.prose import cue_pattern

_SIGNALS = frozenset(
    [
        *("IF", "IF_ONLY", "UNLESS", "ELSE", "UNTIL", "NOT", "EXCEPT", "BEFORE", "AFTER", "EVENT"),
        *("GREATER", "LESS", "BETWEEN", "STATE", "FAILS", "BATTERY", "OUTSIDE", "NEITHER", "NOR"),
        *("INSTEAD", "OR_NOUN", "OR_DO", "OR_TEST", "OR_NUMBER", "forbidding", "past", "question"),
        *("correction", "EVERY", "REPLACE", "MOVE", "ADD"),
    ]
)
_CHECKING = ("MEASURE", "BE_MEASURED", "TIMES", "last", "first", "GO", "checkpoints", "place", "IT")


STATEMENT = "a statement that names nothing of the mission"


@dataclass(frozen=True)
class Proposal:
    """What is proposed for a text; without sentences and without `aside` it stays open."""

    sentences: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    aside: str = ""
    """why the text has no effect"""
    choices: tuple[tuple[str, ...], ...] = ()
    """for an open text: what it may become"""
    doubt: str = ""
    """for an open text: what is not clear"""
    differences: tuple[str, ...] = ()
    """what the text says otherwise than the site"""
    certain: bool = False
    """whether every word of it is used, so that nobody has to confirm it"""


class Composer:
    """Proposes sentences for clauses, one after the other. Mutable: a pronoun means what was
    measured last."""

    def __init__(self, understanding: Understanding, catalog: Catalog) -> None:
        self.understanding = understanding
        self.catalog = catalog
        self.memory = Memory()

    def propose(self, text: ScriptText) -> Proposal:
        """Return what a sentence or a line proposes."""
        found = mentions_in(text, self.understanding)
        states = self._states(text.content, found)
        if not found.mentions:
            return Proposal(aside=STATEMENT) if states else Proposal(choices=((),))
        if states:
            return Proposal(choices=self._choices(found) or ((),))
        for frame in (self._leave_out, _duration, _start_and_end, _order, _wait, self._check):
            sentences = frame(found)
            if sentences is not None:
                return Proposal(sentences, _unused(text, found))
        return Proposal(choices=self._choices(found))

    def _states(self, content: str, found: Mentions) -> bool:
        """Whether a text states a fact about a thing that is none of the mission's, and asks for
        nothing: `The crane is at the dock`."""
        cues = self.understanding.language.prose.cues
        begins = cue_pattern("subject", cues["subject"]).match(content)
        if begins is None or cue_pattern("asking", cues["asking"]).search(content) is not None:
            return False
        verb = cue_pattern("stating", cues["stating"]).search(content, begins.end())
        return verb is not None and any(word.end <= verb.start() for word in found.unknown)

    def measured(self, checkpoints: Sequence[CheckpointInfo]) -> None:
        """Remember what was measured, as an earlier line says."""
        self.memory.measured(checkpoints)

    def checkpoints(self, mentions: Sequence[Mention]) -> list[CheckpointInfo]:
        """Return the checkpoints that parts of a text name. Raises RefusedError if that is not
        clear."""
        source = self.understanding.diagnostics.source
        diagnostics = Diagnostics(source)
        lookup = Lookup(self.catalog, diagnostics, None, None)
        resolver = NounResolver(lookup, diagnostics, self.memory)
        found: list[CheckpointInfo] = []
        for mention in mentions:
            assert isinstance(mention.value, Nouns)
            found += [c for c in resolver.all(mention.value) if c not in found[-1:]]
        return found

    def _leave_out(self, found: Mentions) -> tuple[str, ...] | None:
        """`skip PG 7`, `valve R12 is not needed`"""
        cue = found.has("leave_out", "SPARE", "DELETE")
        if not cue or not found.only(
            "leave_out", "SPARE", "DELETE", "checkpoints", "place", "BE_MEASURED"
        ):
            return None
        with suppress(RefusedError):
            named = self.checkpoints(found.of("checkpoints"))
            if named:
                return (f"Do not check {checkpoint_words(named)}.",)
        return None

    def _check(self, found: Mentions) -> tuple[str, ...] | None:
        """Checkpoints, and nothing else than that they are read, and how often."""
        named = found.of("checkpoints")
        if not named or not found.only(*_CHECKING, "MORE", "again", "OF", "VALUE"):
            return None
        if all(map(is_pronoun, named)) and not found.has("MEASURE", "again", "MORE"):
            return None
        if _verb_before(found, named[-1]):
            return None
        with suppress(RefusedError):
            checkpoints = self.checkpoints(named)
            floors = [s.value for s in found.of("place")]
            if not _fit(checkpoints, floors):
                return None
            times = found.of("TIMES")
            often = f" {times[0].value.whole} times" if times else ""  # type: ignore[attr-defined]
            if len(times) > 1 or (times and len(checkpoints) > 1):
                return None
            self.measured(checkpoints)
            return (f"Check {checkpoint_words(checkpoints)}{often}.",)
        return None

    def floors(self, floors: Sequence[FloorName]) -> set[int]:
        """Return the numbers of floors. Raises RefusedError if one is not on the site."""
        diagnostics = Diagnostics(self.understanding.diagnostics.source)
        return {*Lookup(self.catalog, diagnostics, None, None).numbers(floors)}

    def _choices(self, found: Mentions) -> tuple[tuple[str, ...], ...]:
        """Return what an open text may become: its checkpoints are read, or they are not."""
        named: list[CheckpointInfo] = []
        for mention in found.of("checkpoints"):
            with suppress(RefusedError):
                named += self.checkpoints([mention])
        if not named:
            return ()
        words = checkpoint_words(list({c.id: c for c in named}.values()))
        return ((f"Check {words}.",), (f"Do not check {words}.",), ())


def _unused(text: ScriptText, found: Mentions) -> tuple[str, ...]:
    return tuple(text.content[word.start : word.end] for word in found.unknown)


# ---- frames: each returns its sentences, or None if the text has anything else


def _duration(found: Mentions) -> tuple[str, ...] | None:
    """`keep it under 15 minutes`"""
    lengths = found.of("DURATION", "MOST_TIME")
    others = (
        "limit",
        "DURATION",
        "MOST_TIME",
        "LESS",
        "TOTAL",
        "MAX_DURATION",
        "WITHIN",
        "AT_MOST",
    )
    limited = found.has("limit", "MOST_TIME", "LESS", "MAX_DURATION", "WITHIN", "AT_MOST")
    if len(lengths) != 1 or not limited or not found.only(*others, "IT", "EVERYTHING"):
        return None
    text = _length(lengths[0].value)
    return None if text is None else (f"Maximum duration: {text}.",)


def _start_and_end(found: Mentions) -> tuple[str, ...] | None:
    """`start in area 1`, `from area 2, back to its dock`"""
    allowed = ("place", "start", "home", "START", "FROM", "HOME", "DOCK", "END", "last", "GO", "IT")
    if not found.only(*allowed):
        return None
    areas = [s for s in found.of("place") if isinstance(s.value, AreaLocation | DockLocation)]
    if len(areas) != len(found.of("place")):
        return None
    starts, homes = found.of("start", "START", "FROM"), found.of("home", "HOME", "END")
    if starts and not homes and len(areas) == 1:
        area = _area_of(areas[0])
        return None if area is None else (f"Start in starting area {area}.",)
    if homes and not starts and len(areas) <= 1:
        area = _area_of(areas[0]) if areas else None
        where = f" in starting area {area}" if area is not None else ""
        return (f"Return to the docking station{where}.",)
    if starts and homes and starts[0].start < homes[0].start and 1 <= len(areas) <= 2:
        first, last = _area_of(areas[0]), _area_of(areas[-1])
        if first is None:
            return None
        where = f" in starting area {last}" if last is not None else ""
        return (f"Start in starting area {first}.", f"Return to the docking station{where}.")
    return None


def _order(found: Mentions) -> tuple[str, ...] | None:
    """`any order is fine`"""
    if found.has("ANY_ORDER", "ORDER_FREE") and found.only("ANY_ORDER", "ORDER_FREE"):
        return ("Order: any.",)
    if found.has("THIS_ORDER") and found.only("THIS_ORDER", "MEASURE", "KIND", "DO_FOLLOWING"):
        return ("Order: precise.",)
    return None


def _wait(found: Mentions) -> tuple[str, ...] | None:
    lengths = found.of("DURATION")
    if len(lengths) == 1 and found.has("WAIT", "PAUSE") and found.only("WAIT", "PAUSE", "DURATION"):
        text = _length(lengths[0].value)
        return None if text is None else (f"Wait for {text}.",)
    return None


def _verb_before(found: Mentions, last: Mention) -> bool:
    """Whether an unknown word stands where the verb of an order does: `paint valve R25`."""
    before = [word for word in found.unknown if word.end <= last.start]
    return bool(before) and not found.has("MEASURE", "BE_MEASURED")


def _fit(checkpoints: Sequence[CheckpointInfo], places: Sequence[object]) -> bool:
    """Whether checkpoints are on the floors that are named with them."""
    for place in places:
        if not isinstance(place, tuple):
            return False
        floors = {f.number for f in place if isinstance(f, FloorName)}
        if not {c.floor for c in checkpoints} <= floors:
            return False
    return True


def _area_of(mention: Mention) -> int | None:
    place = mention.value
    if isinstance(place, AreaLocation):
        return place.area
    if isinstance(place, DockLocation) and place.area is not None:
        return place.area.area
    return None


def _length(value: object) -> str | None:
    assert isinstance(value, Length)
    if value.other is not None or value.seconds <= 0:
        return None
    minutes = value.seconds / 60
    return f"{minutes:g} minutes" if minutes == int(minutes) else f"{value.seconds:g} s"
