"""Choices of a text with a case: a limit of a reading, a failure or an event.

The case and what is done are put together anew from what the text mentions, whatever its grammar:
`pressure gauge 3 over 6 bar -> straight home, whatever is left gets dropped`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.il import EventKind
from argo_compiler.script.proposals.composing import PASSING_OVER, normal_end
from argo_compiler.script.proposals.frames import Sentences
from argo_compiler.script.proposals.mentions import Mention, Mentions
from argo_compiler.script.proposals.open_text import ENDS, HOME, OpenText
from argo_compiler.script.resolve.units import converted
from argo_compiler.script.sentences.tree.nouns import Labelled
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.word import Word
from argo_compiler.script.write.conditions import EVENTS

_RELATIONS = {
    "GREATER": "above",
    "LESS": "below",
    "AT_LEAST": "at least",
    "AT_MOST": "at most",
}
_OPPOSITES = {"above": "at most", "below": "at least", "at least": "below", "at most": "above"}
_AMOUNTS = ("QUANTITY", "NUMBER")
_NEGATIONS = ("NOT", "UNLESS")
_MOST_SUBJECTS = 3
"""checkpoints of which each may be the one whose reading decides"""
_REACH = 2
"""words between a relation and its amount"""
_OVER = frozenset([EventKind.ALL_CLEAR, EventKind.BATTERY_CHARGED, EventKind.CONNECTION_RESTORED])
"""events that only tell that another one is over"""


@dataclass(frozen=True)
class _Limit:
    """A limit in words of the mission language, and where it is in its text."""

    words: str
    start: int
    end: int
    unit: str = ""

    def fits(self, checkpoint: CheckpointInfo) -> bool:
        """Return True if the limit can be one of what a checkpoint shows."""
        return self.unit == "" or converted(1.0, self.unit, checkpoint.unit) is not None


def by_cases(of: OpenText) -> Iterator[Sentences]:
    """Yield what may be done in the case that a text has."""
    limit = _limit(of)
    if limit is not None:
        yield from _by_limit(of, limit)
    elif of.found.has("FAILS") or _tells("failing", of):
        yield from _by_failure(of)
    elif of.found.has("ELSE") and (acts := of.acts(of.found)):
        yield (f"Otherwise, {_joined(acts)}.",)
    yield from _by_event(of)


# ---- limits


def _by_limit(of: OpenText, limit: _Limit) -> Iterator[Sentences]:
    """Yield what is done if a reading is beyond a limit, or until it is."""
    before = _between(of.found, 0, limit.start)
    after = _between(of.found, limit.end, len(of.text.content))
    named = before.of("checkpoints")
    rest = after
    if not of.acts(after):  # `go home if pressure gauge 3 is above 6 bar`
        rest = before.without("checkpoints")
        rest = replace(rest, mentions=(*named[:-1], *rest.mentions))
    known = of.composer.known
    subjects = of.named_by(named[-1]) if named else list(known.memory.last)
    subjects = [one for one in subjects if limit.fits(one)]
    if not (named or subjects):
        subjects = [one for one in known.memory.so_far.values() if limit.fits(one)][-1:]
    every = next(iter(of.lengths("DURATION")), None)
    for subject in subjects[:_MOST_SUBJECTS]:
        case = f"checkpoint {subject.id} is {limit.words}"
        check = () if subject.id in known.memory.so_far else (f"Check checkpoint {subject.id}.",)
        if every is not None and "UNTIL" in of.types:
            yield (f"Check checkpoint {subject.id} every {every} until it is {limit.words}.",)
        acts = of.acts(rest, subject)
        if acts:
            yield (*check, f"If {case}, {_joined(acts)}.")
        for act in (of.return_words, "abort the mission"):
            if [act] != acts and not any(a.startswith(("check", "wait")) for a in acts):
                yield (*check, f"If {case}, {act}.")


def _limit(of: OpenText) -> _Limit | None:
    """Return the limit of a text, if it has one: `over 6 bar`, `outside 40 to 50°`, `too high`."""
    words = of.composer.understanding.words(of.text)
    for i, word in enumerate(words):
        behind = words[i + 1 : i + 2 + _REACH]
        amounts = [one for one in behind if one.type in _AMOUNTS]
        ranged = [one.type for one in words[i + 1 : i + 5] if one.type not in ("IN", "FROM")]
        outside = word.type == "NOT" and ranged[1:2] == ["TO"] and ranged[0] in _AMOUNTS
        if outside or word.type == "BETWEEN":
            spans = [one for one in words[i + 1 : i + 6] if one.type in _AMOUNTS][:2]
            if len(spans) == 2:
                low, high = (_amount(one, of) for one in spans)
                name = "outside" if outside else "from"
                unit = _unit(spans[1])
                return _Limit(f"{name} {low} to {high}", word.start, spans[1].end, unit)
        elif word.type in _RELATIONS and amounts:
            relation = _RELATIONS[word.type]
            if any(one.type in _NEGATIONS for one in words[max(0, i - _REACH) : i]):
                relation = _OPPOSITES[relation]
            words_of_it = f"{relation} {_amount(amounts[0], of)}"
            return _Limit(words_of_it, word.start, amounts[0].end, _unit(amounts[0]))
    return _normal_limit(of)


def _amount(word: Word, of: OpenText) -> str:
    """Return an amount as a number with its unit."""
    figure, unit = word.value if isinstance(word.value, tuple) else (word.value, "")
    if not isinstance(figure, Figure) or figure.other is not None:
        return of.text.content[word.start : word.end]
    return f"{figure.value:g} {unit}".strip()


def _unit(word: Word) -> str:
    return str(word.value[1]) if isinstance(word.value, tuple) else ""


def _normal_limit(of: OpenText) -> _Limit | None:
    """Return the end of the normal range that `too high` names, of the checkpoint before it."""
    prose = of.composer.understanding.language.prose
    for name in ("too_high", "too_low"):
        found = phrase_pattern(prose.cues[name]).search(of.text.content)
        if found is None:
            continue
        named = _between(of.found, 0, found.start()).of("checkpoints")
        subjects = of.named_by(named[-1]) if named else list(of.composer.known.memory.last)
        if len(subjects) == 1:
            relation = "above" if name == "too_high" else "below"
            words = f"{relation} {normal_end(subjects[0], name)} {subjects[0].unit}"
            return _Limit(words, *found.span())
    return None


# ---- failures and events


def _by_failure(of: OpenText) -> Iterator[Sentences]:
    """Yield what is done if a checkpoint can't be read: that one, or each of them; first, if it is
    to be tried again."""
    known, behind = of.composer.known, _behind_failure(of)
    before = _between(of.found, 0, behind)
    rest = _between(of.found, behind, len(of.text.content))
    named = _named_in(before, of)
    types = of.composer.understanding.types(of.text[:behind])
    if not named and "IT" in types and len(known.memory.last) == 1:
        named = [*known.memory.last]
    if not named:
        named, rest = _named_in(of.found, of), of.found.without("checkpoints")
    one = len({c.id for c in named}) == 1
    if not one and not known.memory.so_far:
        return
    case = f"If checkpoint {named[0].id} fails" if one else "If a reading fails"
    counts = of.counts("TIMES", "MORE", "MOST_TIMES", "NUMBER")
    times = {1: "once", 2: "twice"}.get(counts[0] or 1, f"{counts[0]} times") if counts else "once"
    acts = [a for a in of.acts(rest) if not a.startswith("wait")]
    likely = [(f"{case}, {act}.",) for act in acts]
    acts = acts or [of.return_words, "abort the mission"] if one else acts
    if of.found.has("RETRY", "again", "MORE") or _tells("trying", of):
        again = f"{case}, try again {times}."
        yield from ((again, f"If it still fails, {act}.") for act in acts)
        yield (again,)
    yield from likely
    yield (f"{case}, go on with the next checkpoint.",)
    yield from ((f"{case}, {act}.",) for act in acts)


def _behind_failure(of: OpenText) -> int:
    """Return where the words end that say that a reading fails."""
    ends = [mention.end for mention in of.found.of("FAILS")[:1]]
    phrases = phrase_pattern(of.composer.understanding.language.prose.cues["failing"])
    said = phrases.search(of.text.content)
    return min([*ends, *([] if said is None else [said.end()])])


def _named_in(found: Mentions, of: OpenText) -> list[CheckpointInfo]:
    return [c for m in found.of("checkpoints") if _is_labelled(m) for c in of.named_by(m)]


def _tells(name: str, of: OpenText) -> bool:
    """Return True if a text has one of the phrases that say something of a case."""
    phrases = of.composer.understanding.language.prose.cues[name]
    return phrase_pattern(phrases).search(of.text.content) is not None


def _by_event(of: OpenText) -> Iterator[Sentences]:
    """Yield what the robot may do where an event is named."""
    events = of.found.of("EVENT")
    event = events[0].value if events else None
    if not isinstance(event, EventKind) or event in _OVER:
        return
    when = f"If {EVENTS[event]}"
    length = next(iter(of.lengths("DURATION")), None)
    within = f" for at most {length}, and resume" if length is not None else ""
    paused = f"pause{within or ' until all clear is given, and resume'}"
    charged = f"{of.return_words}, charge and continue"
    answers: dict[tuple[str, ...], str] = {
        ("RECHARGE",): charged if event is EventKind.LOW_BATTERY else "",
        (*HOME, "place"): of.return_words,
        ("PAUSE", "WAIT"): paused,
        ENDS: "abort the mission",
        ("REPORT",): "report it",
    }
    likely = [answer for kinds, answer in answers.items() if of.found.has(*kinds)]
    skips = event is EventKind.POSITIVE_OBSTACLE and of.found.has("leave_out", "GO_ON", "NEXT_STEP")
    if skips:
        yield (PASSING_OVER,)
    for answer in dict.fromkeys(filter(None, (*likely, *answers.values()))):
        yield (f"{when}, {answer}.",)


# ---- parts


def _is_labelled(mention: Mention) -> bool:
    """Return True for `valve R7`; False for `a gauge`, which may be any."""
    return all(isinstance(noun, Labelled) for noun in mention.nouns)


def _between(found: Mentions, start: int, end: int) -> Mentions:
    """Return the mentions between two places of a text."""
    inside: Sequence[Mention] = [m for m in found.mentions if start <= m.start and m.end <= end]
    return replace(found, mentions=tuple(inside))


def _joined(acts: Sequence[str]) -> str:
    """Return acts one after the other: `wait for 3 minutes and check checkpoint 6 again`."""
    again = [b for a, b in pairwise(["", *acts]) if a != b]
    return again[0] if len(again) == 1 else f"{', '.join(again[:-1])} and {again[-1]}"
