"""What a clause proposes: sentences that use all of it that means something.

A proposal never passes over a negation, a condition or a correction. Where parts are left that no
sentence uses, the clause stays open, and what it may become are choices.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from argo_compiler.base.catalog import Catalog, CheckpointInfo
from argo_compiler.script.documents.source import Diagnostics, RefusedError, ScriptText
from argo_compiler.script.proposals.evidence import evidence
from argo_compiler.script.proposals.mentions import (
    Mention,
    Mentions,
    checkpoint_words,
    mentions_in,
)
from argo_compiler.script.proposals.paraphrasing import paraphrases
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.nouns import Memory, NounResolver
from argo_compiler.script.sentences.tree.nouns import AllOf, Nouns
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation, FloorName
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import cue_pattern

_SIGNALS = (
    *("forbidding", "past", "question", "correction", "leave_out", "IF", "IF_ONLY", "UNLESS"),
    *("ELSE", "UNTIL", "NOT", "EXCEPT", "pronoun", "STATE", "MORE", "again", "TIMES", "GREATER"),
    *("INCLUDED", "RECHARGE"),
)
"""kinds of mentions without which a text is looked at for choices"""
_DOCKING = ("home", "HOME", "DOCK", "END", "place")
_COMMA = re.compile(r"\s*[,;:]\s+|\s+-\s+")
_PLAIN = frozenset(
    [
        *("AND_NOUN", "AND_DO", "AND_PLACE", "AND_ON", "NEXT", "COLON", "JOINT", "HE", "NAMELY"),
        *("LPAR", "RPAR", "TO", "IN", "AT", "ON", "FOR", "IS"),
    ]
)
"""words that join others, of which none changes what a whole clause means"""
_UNSURE = ("pronoun", "last", "first", "later", "again", "past", "over", "limit", "LESS", "WITHIN")
"""mentions beside which a proposal has to be confirmed"""
_LIKE_CHECKS = re.compile(r"(?:Check|Order:|Maximum|Start|Return|End)")
_MOST_CLAUSES = 14
_MOST_READINGS = 10
"""of one checkpoint, one after the other"""

Sentences = tuple[str, ...]


@dataclass(frozen=True)
class Proposal:
    """What is proposed for a text; without sentences and without `aside` it stays open."""

    sentences: Sentences = ()
    unused: tuple[str, ...] = ()
    aside: str = ""
    """why the text has no effect"""
    choices: tuple[Sentences, ...] = ()
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
        self.spared: set[int] = set()
        """the checkpoints that are to be left out"""
        self.before = ""
        """the text before, in words of the language"""

    def propose(self, text: ScriptText) -> Proposal:
        """Return what a sentence or a line proposes."""
        found = mentions_in(text, self.understanding)
        reason = evidence(text, found, self.understanding.language)
        if reason:
            return Proposal(aside=reason)
        made = self._composed(text, found)
        if made is None or made.unused:
            made = self._readable(text) or made
        if made is None and found.mentions:
            made = self._of_clauses(text)
        return made if made is not None else Proposal(choices=self._choices(text, found))

    def _readable(self, text: ScriptText) -> Proposal | None:
        """Return what a text is in words that the grammar takes."""
        text = self._alike(text)
        return next(
            (Proposal((said,)) for said in paraphrases(text, self.understanding)),
            None,
        )

    def _alike(self, text: ScriptText) -> ScriptText:
        """Return a condition that ends in `likewise` with the orders of the one before it."""
        cues = self.understanding.language.prose.cues
        likewise = re.compile(
            rf"[,:]?\s*{cue_pattern('likewise', cues['likewise']).pattern}\W*$", re.IGNORECASE
        )
        found = likewise.search(text.content)
        _, comma, orders = self.before.partition(",")
        if found is None or not comma:
            return text
        return text.replace(found.start(), len(text.content), f", {orders.strip(' .')}")

    def _composed(self, text: ScriptText, found: Mentions) -> Proposal | None:
        if not found.mentions or self._depends(text, found):
            return None
        sentences = self._sentences(found)
        if sentences is None:
            return None
        unused = tuple(text.content[word.start : word.end] for word in found.unknown)
        bidden = found.has("MEASURE", "BE_MEASURED") or "courtesy" not in found.joining
        plain = bidden and found.joining <= {*_PLAIN, "courtesy"}
        whole = plain and not unused and not found.has(*_UNSURE)
        certain = whole and all(map(_LIKE_CHECKS.match, sentences))
        return Proposal(sentences, unused, certain=certain)

    def _of_clauses(self, text: ScriptText) -> Proposal | None:
        """Return what the clauses of a text propose, if each of them proposes something or names
        nothing of the mission."""
        cues = self.understanding.language.prose.cues
        cuts = [m.span() for m in cue_pattern("clause", cues["clause"]).finditer(text.content)]
        cuts += [m.span() for m in _COMMA.finditer(text.content)]
        starts = [0, *sorted({a for a, _ in cuts} | {b for _, b in cuts}), len(text.content)]
        if not 2 < len(starts) <= _MOST_CLAUSES:
            return None
        before = self.memory.last
        sentences: list[str] = []
        unused: list[str] = []
        i = 0
        while i < len(starts) - 1:
            for k in range(len(starts) - 1, i, -1):
                part = text[starts[i] : starts[k]].strip()
                found = mentions_in(part, self.understanding)
                if evidence(part, found, self.understanding.language):
                    unused.append(part.content)
                    break
                made = self._composed(part, found)
                if made is not None:
                    sentences += made.sentences
                    unused += made.unused
                    break
                if not found.mentions and k == i + 1:
                    unused += [part.content] if part.content.strip(" ,.;") else []
                    break
            else:
                self.measured(before)
                return None
            i = k
        return Proposal(tuple(sentences), tuple(unused)) if sentences else None

    def measured(self, checkpoints: Sequence[CheckpointInfo]) -> None:
        """Remember what was measured, as an earlier line says."""
        self.memory.measured(checkpoints)

    def checkpoints(self, mentions: Sequence[Mention]) -> list[CheckpointInfo]:
        """Return the checkpoints that parts of a text name; number and name of one point, side by
        side, are one. Raises RefusedError if that is not clear."""
        resolver = self._resolver()
        found: list[CheckpointInfo] = []
        for mention in mentions:
            assert isinstance(mention.value, Nouns)
            found += [c for c in resolver.all(mention.value) if c not in found[-1:]]
        return found

    def floors(self, floors: Sequence[FloorName]) -> set[int]:
        """Return the numbers of floors. Raises RefusedError if one is not on the site."""
        return {*self._resolver().lookup.numbers(floors)}

    def _resolver(self) -> NounResolver:
        diagnostics = Diagnostics(self.understanding.diagnostics.source)
        lookup = Lookup(self.catalog, diagnostics, None, None)
        return NounResolver(lookup, diagnostics, self.memory)

    def _sentences(self, found: Mentions) -> Sentences | None:
        frames: tuple[Callable[[Mentions], Sentences | None], ...] = (
            self._replace,
            self._leave_out,
            _duration,
            _start_and_end,
            _order,
            _wait,
            self._later,
            self._spaced,
            self._check,
        )
        made = (frame(found) for frame in frames)
        return next((sentences for sentences in made if sentences is not None), None)

    def _choices(self, text: ScriptText, found: Mentions) -> tuple[Sentences, ...]:
        """Return what an open text may become: each of its readings, what it would be without what
        is not clear, that its checkpoints are read or not read, and nothing."""
        choices: list[Sentences] = list(self._readings(text, found))
        for bare in (found.without(*_SIGNALS), found.without(*_SIGNALS, *_DOCKING)):
            said = self._sentences(bare) if bare.mentions else None
            if said is not None:
                choices.append(said)
        named: dict[int, CheckpointInfo] = {}
        for mention in found.of("checkpoints"):
            with suppress(RefusedError):
                named |= {c.id: c for c in self.checkpoints([mention])}
        if 0 < len(named) < len(self.catalog.checkpoints):
            words = checkpoint_words(list(named.values()))
            choices += [(f"Check {words}.",), (f"Do not check {words}.",)]
        for mention in found.of("place"):
            if isinstance(mention.value, AreaLocation) and not named:
                area = mention.value.area
                choices += [(f"Start in starting area {area}.",)]
                choices += [(f"Return to the docking station in starting area {area}.",)]
        return (*dict.fromkeys(choices), ())

    def _readings(self, text: ScriptText, found: Mentions) -> Iterator[Sentences]:
        """Yield the text with each checkpoint that its pronoun may be, where it makes sense then;
        of `too high` with the limit of that checkpoint."""
        pronouns = found.of("pronoun", "THIS")[:1]
        candidates = {c.id: c for c in self.memory.last}
        for checkpoint in candidates.values():
            said = text
            for mention in pronouns:
                said = said.replace(mention.start, mention.end, f"checkpoint {checkpoint.id}")
            said = self._within(said, checkpoint)
            if said is not text:
                yield from ((one,) for one in paraphrases(said, self.understanding, changed=True))

    def _within(self, text: ScriptText, checkpoint: CheckpointInfo) -> ScriptText:
        """Return a text with `too high` as a limit."""
        prose = self.understanding.language.prose
        limits = (("too_high", checkpoint.nominal.high), ("too_low", checkpoint.nominal.low))
        for name, limit in limits:
            found = cue_pattern(name, prose.cues[name]).search(text.content)
            if found is not None:
                said = prose.say[name].format(f"{limit:g}")
                text = text.replace(*found.span(), said)
        return text

    def _depends(self, text: ScriptText, found: Mentions) -> bool:
        """Return True if a text may begin with a case that it depends on: `On smoke, go home`."""
        cases = self.understanding.language.prose.cues["in_case"]
        begins = cue_pattern("in_case", cases).match(text.content)
        if begins is None or not found.unknown:
            return False
        return not any(m.start <= found.unknown[0].start for m in found.mentions if m.start)

    # ---- frames: each returns its sentences, or None if the text has anything else

    def _leave_out(self, found: Mentions) -> Sentences | None:
        """`skip PG 7, no ladder there`, `valve R12 is not needed`"""
        if not found.has("leave_out", "SPARE", "DELETE"):
            return None
        idle = [m for m in found.of("forbidding", "correction") if _before_unknown(m, found)]
        kept = Mentions(tuple(m for m in found.mentions if m not in idle), found.unknown)
        allowed = ("leave_out", "SPARE", "DELETE", "checkpoints", "place", "BE_MEASURED")
        if not kept.only(*allowed):
            return None
        with suppress(RefusedError):
            named = self.checkpoints(kept.of("checkpoints"))
            if named:
                self.spared |= {c.id for c in named}
                return (f"Do not check {checkpoint_words(named)}.",)
        return None

    def _replace(self, found: Mentions) -> Sentences | None:
        """`sorry, not R25 but R12 in step 2`"""
        named = found.of("checkpoints")
        denials = ("correction", "forbidding", "NOT", "BUT", "EXCEPT")
        allowed = ("checkpoints", "STEP", "NUMBER", "place", *denials)
        if len(named) != 2 or not found.has("correction") or not found.only(*allowed):
            return None
        said = found.of(*denials)
        denied = [m for m in said if m.end <= named[0].start]
        between = [m for m in said if named[0].end <= m.start < named[1].start]
        if not denied or len(between) > 1:
            return None
        with suppress(RefusedError):
            (first,), (second,) = (self.checkpoints([one]) for one in named)
            return (f"Replace checkpoint {first.id} by checkpoint {second.id}.",)
        return None

    def _later(self, found: Mentions) -> Sentences | None:
        """`Ten minutes later read valve R18`"""
        lengths, named = found.of("DURATION"), found.of("checkpoints")
        if len(lengths) != 1 or not found.has("later") or not named:
            return None
        if not found.only("DURATION", "later", "checkpoints", "MEASURE"):
            return None
        text = _length(lengths[0].value)
        checked = self._check(found.without("DURATION", "later"))
        if text is None or checked is None or lengths[0].start > named[0].start:
            return None
        return (f"Wait for {text}.", *checked)

    def _spaced(self, found: Mentions) -> Sentences | None:
        """`pressure gauge 3: two readings, ten minutes apart`"""
        lengths, counts = found.of("DURATION"), found.of("NUMBER", "TIMES")
        spacing = ("later", "IN_BETWEEN", "PAUSE_OF")
        if len(lengths) != 1 or len(counts) != 1 or not found.has(*spacing):
            return None
        allowed = ("DURATION", "NUMBER", "TIMES", "checkpoints", "MEASURE", "pronoun", *spacing)
        count = counts[0].value
        text = _length(lengths[0].value)
        if not found.only(*allowed) or not isinstance(count, Figure) or text is None:
            return None
        checked = self._check(found.without("DURATION", "NUMBER", "TIMES", "pronoun", *spacing))
        if checked is None or count.whole is None or not 1 < count.whole <= _MOST_READINGS:
            return None
        return (*checked, *((f"Wait for {text}.", *checked) * (count.whole - 1)))

    def _check(self, found: Mentions) -> Sentences | None:
        """Checkpoints, and nothing else than that they are read, and how often."""
        named = found.of("checkpoints")
        allowed = ("MEASURE", "BE_MEASURED", "TIMES", "last", "first", "GO", "place", "OF", "VALUE")
        if not found.only("checkpoints", "pronoun", "MORE", "again", *allowed):
            return None
        if not named:
            named = found.of("pronoun")
            if not named or not found.has("MEASURE", "again", "MORE"):
                return None
        if _verb_before(found, named[-1]):
            return None
        with suppress(RefusedError):
            checkpoints = self._placed(named, found.of("place"))
            times = found.of("TIMES")
            if checkpoints is None or len(times) > 1 or (times and len(checkpoints) > 1):
                return None
            often = ""
            if times and isinstance(times[0].value, Figure) and times[0].value.whole != 1:
                often = f" {times[0].value.whole} times"
            self.measured(checkpoints)
            return (f"Check {checkpoint_words(checkpoints)}{often}.",)
        return None

    def _placed(
        self, named: Sequence[Mention], places: Sequence[Mention]
    ) -> list[CheckpointInfo] | None:
        """Return the checkpoints, each of which is on the floor named beside it; None if one is
        not. A floor before `all valves` says which are meant."""
        floors = [place for place in places if isinstance(place.value, tuple)]
        if len(floors) < len(places):
            return None
        if len(floors) == 1 and len(named) == 1 and isinstance(named[0].value, Nouns):
            nouns = named[0].value
            if all(isinstance(noun, AllOf) and not noun.floors for noun in nouns.nouns):
                resolver = self._resolver()
                return resolver.all(resolver.on(_floor_names(floors[0]), nouns))
        checkpoints = self.checkpoints(named)
        for place in floors:
            before = [m for m in named if m.start < place.start] or list(named)
            near = self.checkpoints(before[-1:]) if len(floors) > 1 else checkpoints
            if not {c.floor for c in near} <= self.floors(_floor_names(place)):
                return None
        return checkpoints


def _floor_names(place: Mention) -> list[FloorName]:
    assert isinstance(place.value, tuple)
    return [floor for floor in place.value if isinstance(floor, FloorName)]


def _duration(found: Mentions) -> Sentences | None:
    """`keep it under 15 minutes`, `the whole test must be over after 90 minutes`"""
    lengths = found.of("DURATION", "MOST_TIME")
    limits = ("limit", "MOST_TIME", "LESS", "MAX_DURATION", "WITHIN", "AT_MOST")
    allowed = ("DURATION", "TOTAL", "pronoun", "everything", "MEASURE", *limits)
    if found.has("over") and found.has("forbidding", "NOT"):  # `not longer than`
        found = found.without("over", "forbidding", "NOT")
    elif not found.has(*limits):
        return None
    if len(lengths) != 1 or not found.only(*allowed):
        return None
    text = _length(lengths[0].value)
    return None if text is None else (f"Maximum duration: {text}.",)


def _start_and_end(found: Mentions) -> Sentences | None:
    """`start in area 1`, `from area 2, back to its dock`"""
    allowed = ("place", "start", "home", "START", "FROM", "HOME", "DOCK", "END", "last", "GO")
    if not found.only(*allowed, "pronoun"):
        return None
    areas = [m for m in found.of("place") if isinstance(m.value, AreaLocation | DockLocation)]
    if len(areas) != len(found.of("place")):
        return None
    docks = [m for m in areas if isinstance(m.value, DockLocation)]
    starts, homes = found.of("start", "START", "FROM"), found.of("home", "HOME", "END")
    if starts and not homes and len(areas) == 1:
        area = _area_of(areas[0])
        return None if area is None else (f"Start in starting area {area}.",)
    if (homes or docks) and not starts and len(areas) <= 1:
        area = _area_of(areas[0]) if areas else None
        where = f" in starting area {area}" if area is not None else ""
        return (f"Return to the docking station{where}.",)
    if starts and homes and starts[0].start < homes[0].start and 1 <= len(areas) <= 2:
        first, last = _area_of(areas[0]), _area_of(areas[-1])
        if first is None:
            return None
        end = last if last is not None else first
        return (f"Start in starting area {first}.", f"End of the mission: starting area {end}.")
    return None


def _order(found: Mentions) -> Sentences | None:
    """`any order is fine`"""
    if found.has("ANY_ORDER", "ORDER_FREE") and found.only("ANY_ORDER", "ORDER_FREE"):
        return ("Order: any.",)
    allowed = ("THIS_ORDER", "MEASURE", "DO_FOLLOWING", "KIND", "STEP", "TIME_WORD", "ROUNDS_OF")
    if found.has("THIS_ORDER") and found.only(*allowed):
        return ("Order: precise.",)
    return None


def _wait(found: Mentions) -> Sentences | None:
    lengths = found.of("DURATION")
    if len(lengths) == 1 and found.has("WAIT", "PAUSE") and found.only("WAIT", "PAUSE", "DURATION"):
        text = _length(lengths[0].value)
        return None if text is None else (f"Wait for {text}.",)
    return None


def _before_unknown(mention: Mention, found: Mentions) -> bool:
    """Whether an unknown word follows at once, as in `no ladder`."""
    return any(0 <= word.start - mention.end <= 1 for word in found.unknown)


def _verb_before(found: Mentions, last: Mention) -> bool:
    """Whether an unknown word stands where the verb of an order does: `paint valve R25`."""
    before = [word for word in found.unknown if word.end <= last.start]
    return bool(before) and not found.has("MEASURE", "BE_MEASURED")


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
