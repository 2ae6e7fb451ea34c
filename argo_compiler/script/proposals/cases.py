"""Choices of a text with a case: a limit of a reading, a failure or an event.

The case and what is done are put together anew from what the text mentions, whatever its grammar:
`pressure gauge 3 over 6 bar -> straight home, whatever is left gets dropped`.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.il import EventKind
from argo_compiler.script.proposals.composing import PASSING_OVER, normal_end
from argo_compiler.script.proposals.demands import SPREADS
from argo_compiler.script.proposals.frames import Sentences, seconds_words
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
_OPPOSITES = {
    **{"above": "at most", "below": "at least", "at least": "below", "at most": "above"},
    **{"between": "outside", "outside": "from", "normal": "abnormal", "abnormal": "normal"},
}
_AMOUNTS = ("QUANTITY", "NUMBER")
_IFS = ("IF", "UNLESS", "IF_ONLY")
_NEGATIONS = ("NOT",)
_MOST_SUBJECTS = 3
"""checkpoints of which each may be the one whose reading decides"""
_TIMES = {1: "once", 2: "twice"}
_COUNTED = ("KIND", "UNIT_S", "RETRY", "TIMES", "ROUNDS_OF")
"""types of words behind a number that counts"""
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
    amount: str = ""
    """of a limit with one"""

    def fits(self, checkpoint: CheckpointInfo) -> bool:
        """Return True if the limit can be one of what a checkpoint shows."""
        return self.unit == "" or converted(1.0, self.unit, checkpoint.unit) is not None


def by_cases(of: OpenText) -> Iterator[Sentences]:
    """Yield what may be done in the case that a text has."""
    limit = _limit(of)
    if limit is not None:
        yield from _by_limit(of, limit)
    elif of.found.has("FAILS") or "FAILS" in of.types or of.tells("failing"):
        yield from _by_failure(of)
    elif times := _retries(of):
        yield from (
            (f"Check checkpoint {id}, retry {_TIMES.get(times, f'{times} times')}.",)
            for id in of.demands.asked[:1]
        )
    elif of.found.has("SPAN"):
        yield from _by_span(of)
    elif of.found.has("ELSE") and (acts := of.acts(of.found)):
        yield (f"Otherwise, {_joined(acts)}.",)
    yield from _by_event(of)


# ---- limits


def _by_limit(of: OpenText, limit: _Limit) -> Iterator[Sentences]:
    """Yield what is done if a reading is beyond a limit, or until it is."""
    before = _between(of.found, 0, limit.start)
    otherwise = next((m for m in of.found.of("ELSE") if m.start >= limit.end), None)
    end = len(of.text.content) if otherwise is None else otherwise.start
    after = _between(of.found, limit.end, end)
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
    asked = _first_of(_IFS, of)  # `check R7 and PG 1, and if it is above 5 bar, go home`
    ahead = [c for m in named if asked is not None and m.end <= asked for c in of.named_by(m)]
    for subject in subjects[:_MOST_SUBJECTS]:
        case = f"checkpoint {subject.id} is {limit.words}"
        ids = [c.id for c in ahead] if subject in ahead else [subject.id]
        read = [id for id in dict.fromkeys(ids) if id not in of.above]
        check = (f"Check {of.words_of(read)}.",) if read else ()
        if every is not None and "UNTIL" in of.types:
            check_every = f"heck checkpoint {subject.id} every {every} until it is"
            last = _until(of, limit)
            if last and "IF" in of.types:  # `if it is above 8, read it again until it is below`
                yield (*check, f"If {case}, c{check_every} {last}.")
            elif last:
                yield (f"C{check_every} {last}.",)
            continue
        acts = of.acts(rest, subject)
        others = of.acts(_between(of.found, end, len(of.text.content)), subject)
        yield from ((*check, *one) for one in _in_case(of, case, acts, others))


def _in_case(
    of: OpenText, case: str, acts: Sequence[str], others: Sequence[str]
) -> Iterator[Sentences]:
    """Yield what is done in a case, and what is done or left out otherwise. `others`: the acts
    behind `otherwise`."""
    spared = of.demands.spared
    homewards = any(act.startswith(("return", "abort")) for act in acts)
    asked = of.composer.known.asked | {*of.above}
    if spared and not homewards:
        names = of.words_of(spared)
        if asked.isdisjoint(spared):
            unless = (f"Check {names} unless {case}.",)
            otherwise = f"Otherwise, check {names}."
            yield (f"If {case}, {_joined(acts)}.", otherwise) if acts else unless
        elif not acts and spared == of.above[-1:]:
            yield (f"Delete {names}.", f"Check {names} unless {case}.")
        return
    if others:
        yield (f"If {case}, {_joined(acts or ['go on'])}.", f"Otherwise, {_joined(others)}.")
    elif acts:
        yield (f"If {case}, {_joined(acts)}.",)
    elif of.found.has("JUMP", "GO_ON", "NEXT_STEP"):
        yield (f"If {case}, go on.",)
    if not (others or of.found.has("JUMP", "GO_ON", "NEXT_STEP")):
        for act in (of.return_words, "abort the mission"):
            if [act] != acts and not any(a.startswith(("check", "wait")) for a in acts):
                yield (f"If {case}, {act}.",)


def _until(of: OpenText, limit: _Limit) -> str:
    """Return the limit behind `until`: `it is below` is below the amount of the first limit; empty
    if that is not clear."""
    words = of.composer.understanding.words(of.text)
    start = next(word.start for word in words if word.type == "UNTIL")
    if start < limit.start:
        return limit.words
    relations = [w for w in words if w.start > start and w.type in _RELATIONS]
    amounts = [w for w in words if w.start > start and w.type in _AMOUNTS]
    amount = _amount(amounts[0], of) if amounts else limit.amount
    if len(relations) != 1 or len(amounts) > 1 or not amount:
        return ""
    return f"{_relation(words, words.index(relations[0]))} {amount}"


def _relation(words: Sequence[Word], i: int) -> str:
    """Return the relation of a word, or its opposite behind a negation."""
    relation = _RELATIONS[words[i].type]
    negated = any(one.type in _NEGATIONS for one in words[max(0, i - _REACH) : i])
    return _OPPOSITES[relation] if negated else relation


def _by_span(of: OpenText) -> Iterator[Sentences]:
    """Yield a reading between two times after another: `at least 5 but at most 8 minutes after
    pressure gauge 6, read pressure gauge 7`."""
    span = of.found.of("SPAN")[0]
    behind = [m for m in of.found.of("checkpoints") if m.start >= span.end][:1]
    others = [c for m in behind for c in of.named_by(m)]
    ids = [id for id in of.demands.asked if id not in {c.id for c in others}]
    last = of.composer.known.memory.last
    if len(others) != 1 or len(ids) != 1 or (others[0].id in of.above and last[-1:] != (*others,)):
        return
    least_s, most_s = span.limits_s
    check = () if others[0].id in of.above else (f"Check checkpoint {others[0].id}.",)
    limit = f"taking at most {seconds_words(most_s - least_s)}"
    yield (
        *check,
        f"Wait for {seconds_words(least_s)}.",
        f"Check checkpoint {ids[0]}, {limit}.",
    )


def _retries(of: OpenText) -> int:
    """Return how often a reading is tried again: `up to three attempts`, of which the first is
    none; 0 if a text does not say that."""
    words = of.composer.understanding.words(of.text)
    figures = [w.value for w in words if w.type in ("NUMBER", "TIMES", "MOST_TIMES")]
    counts = [one.whole for one in figures if isinstance(one, Figure) and one.whole]
    tries = next((name for name in ("retrying", "trying") if of.tells(name)), "")
    if len(counts) != 1 or not (tries or of.found.has("RETRY")) or len(of.demands.asked) != 1:
        return 0
    again = tries != "trying" or of.found.has("MORE") or of.tells("again")
    return counts[0] if again else counts[0] - 1


def _limit(of: OpenText) -> _Limit | None:
    """Return the limit of a text, if it has one, also behind `unless`."""
    limit = _stated_limit(of)
    words = of.composer.understanding.words(of.text)
    cases = [w for w in words if limit and w.start < limit.start and w.type in _IFS][-1:]
    unless = any(one.type == "UNLESS" or one.value == "unless" for one in cases)
    if limit is None or not unless:
        return limit
    relation, _, rest = limit.words.partition(" ")
    if limit.amount:
        relation, rest = limit.words.removesuffix(f" {limit.amount}"), limit.amount
    opposite = _OPPOSITES.get(relation)
    rest = rest.replace(" and ", " to ")
    return None if opposite is None else replace(limit, words=f"{opposite} {rest}".strip())


def _stated_limit(of: OpenText) -> _Limit | None:
    """Return the limit that a text states: `over 6 bar`, `outside 40 to 50°`, `too high`."""
    words = of.composer.understanding.words(of.text)
    for i, word in enumerate(words):
        behind = words[i + 1 : i + 2 + _REACH]
        amounts = [one for one in behind if one.type in _AMOUNTS]
        ranged = [one.type for one in words[i + 1 : i + 5] if one.type not in ("IN", "FROM")]
        outside = word.type == "NOT" and ranged[1:2] == ["TO"] and ranged[0] in _AMOUNTS
        three = tuple(one.type for one in words[i : i + 3])
        spread = three in SPREADS and "IF" in of.types  # `if it reads 4 to 5 bar`
        if outside or spread or word.type == "BETWEEN":
            inside = words[i if spread else i + 1 : i + 6]
            spans = [one for one in inside if one.type in _AMOUNTS][:2]
            if len(spans) == 2:
                low, high = (_amount(one, of) for one in spans)
                unit = _unit(spans[1])
                range_ = f"between {low} and {high}"
                if outside or spread:
                    range_ = f"{'outside' if outside else 'from'} {low} to {high}"
                return _Limit(range_, word.start, spans[1].end, unit)
        elif word.type in _RELATIONS and amounts and not _counts(amounts[0], words, of):
            amount = _amount(amounts[0], of)
            words_of_it = f"{_relation(words, i)} {amount}"
            return _Limit(words_of_it, word.start, amounts[0].end, _unit(amounts[0]), amount)
        elif word.type == "STATE" and word.value in ("normal", "abnormal") and i > 0:
            negated = any(one.type == "NOT" for one in words[max(0, i - _REACH) : i])
            state = _OPPOSITES[word.value] if negated else word.value
            return _Limit(state, word.start, word.end)
    return _normal_limit(of)


def _counts(word: Word, words: Sequence[Word], of: OpenText) -> bool:
    """Return True for a number that counts something: `at most 3 attempts`, `more than two
    valves`, `at least 5 but at most 8 minutes`."""
    behind = sorted((one.start, one.type) for one in words if one.start >= word.end)
    next_type = behind[0][1] if behind else ""
    tries = of.found.has("RETRY") or of.tells("trying") or of.tells("retrying")
    return word.type == "NUMBER" and (
        of.found.has("SPAN") or next_type in _COUNTED or (tries and "IF" not in of.types)
    )


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
    if not named and "IT" in types and not of.demands.spared:
        named = [*known.memory.last]
    if not named:
        named, rest = _named_in(of.found, of), of.found.without("checkpoints")
    ids = [*dict.fromkeys(c.id for c in reversed(named))]
    if len(ids) != 1 and not known.memory.so_far:
        return
    asked = _first_of(_IFS, of)  # `check R7, and if it can't be read, go home`
    ahead = of.found.of("checkpoints")[:1]
    checks = bool(ahead and asked is not None and ahead[0].end <= asked and len(ids) == 1)
    check = (f"Check checkpoint {ids[0]}.",) if checks and ids[0] not in of.above else ()
    cases = [f"If checkpoint {id} fails" for id in ids[:_MOST_SUBJECTS]]
    cases += ["If a reading fails"] if len(ids) != 1 else []
    counts = of.counts("TIMES", "MORE", "MOST_TIMES", "NUMBER")
    times = _TIMES.get(counts[0] or 1, f"{counts[0]} times") if counts else "once"
    acts = [a for a in of.acts(rest) if not a.startswith("wait")]
    for case in cases:
        likely = [(f"{case}, {act}.",) for act in acts]
        others = acts or ([of.return_words, "abort the mission"] if len(ids) == 1 else [])
        if of.found.has("RETRY", "again", "MORE") or of.tells("trying"):
            again = f"{case}, try again {times}."
            yield from ((*check, again, f"If it still fails, {act}.") for act in others)
            yield (*check, again)
        yield from ((*check, *one) for one in likely)
        yield (*check, f"{case}, go on with the next checkpoint.")
        yield from ((*check, f"{case}, {act}.") for act in others)


def _first_of(types: Collection[str], of: OpenText) -> int | None:
    """Return where the first word of some types stands; None if there is none."""
    words = of.composer.understanding.words(of.text)
    return min((word.start for word in words if word.type in types), default=None)


def _behind_failure(of: OpenText) -> int:
    """Return where the words end that say that a reading fails."""
    words = of.composer.understanding.words(of.text)
    ends = [word.end for word in words if word.type == "FAILS"][:1]
    phrases = phrase_pattern(of.composer.understanding.language.prose.cues["failing"])
    said = phrases.search(of.text.content)
    return min([*ends, *([] if said is None else [said.end()])])


def _named_in(found: Mentions, of: OpenText) -> list[CheckpointInfo]:
    return [c for m in found.of("checkpoints") if _is_labelled(m) for c in of.named_by(m)]


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
