"""Choices of an open text: its nearest readings, of which a person takes one.

A choice may pass over words that a proposal must not pass over, as it counts only once a person has
taken it. The likeliest comes first.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import ScriptText
from argo_compiler.script.proposals.cases import by_cases
from argo_compiler.script.proposals.composing import Composer
from argo_compiler.script.proposals.edits import (
    by_corrections,
    by_edits,
    by_leaving_out,
    by_numbers,
    by_sequence,
    by_swaps,
)
from argo_compiler.script.proposals.frames import KINDS, Sentences, sentences_of
from argo_compiler.script.proposals.mentions import (
    Mention,
    checkpoint_words,
    mentions_in,
)
from argo_compiler.script.proposals.open_text import HOME, OpenText, as_sentences
from argo_compiler.script.proposals.paraphrasing import reads, rephrased, sentence
from argo_compiler.script.proposals.parts import by_parts
from argo_compiler.script.proposals.rounds import by_rounds
from argo_compiler.script.proposals.taking import is_understood
from argo_compiler.script.sentences.tree.nouns import AllOf, Pronoun, TheOne
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.without_effect import MISPLACED

_MOST_CHOICES = 9
_MOST_CHOSEN = 10
"""checkpoints of a text that may be chosen together"""
_FEW = 3
"""checkpoints of a text each of which may be meant alone"""
_LONGEST = 500
"""characters of a text that is taken apart"""
_LONGEST_LOOKED_AT = 5_000
"""characters of a text whose mentions are looked at; a longer one can only be set aside"""
_SIGNALS = (
    *("forbidding", "past", "question", "correction", "leave_out", "IF", "IF_ONLY", "UNLESS"),
    *("ELSE", "UNTIL", "NOT", "EXCEPT", "pronoun", "STATE", "MORE", "again", "TIMES", "GREATER"),
    *("INCLUDED", "RECHARGE", "in_place_of", MISPLACED),
)
"""kinds of mentions without which a text is looked at"""
_DOCKING = (*HOME, "END", "place")
_LISTED = re.compile(r"(?<![\w.,#-])\d{1,3}(?:(?:\s*[,;/>+–-]\s*|\s+)\d{1,3}){2,}(?![\w.,]*\d)")
"""three or more bare numbers, one after the other"""
_DASHED = re.compile(r"#?\d{1,3}(?:\s*[-–>]\s*#?\d{1,3}){2,}(?![\w.,]*\d)")
"""three or more numbers with dashes in between: a list, or ranges"""
_RETURN = "Return to the docking station"
_Way = Callable[[OpenText], Iterator[Sentences]]
_ENDLESS = re.compile(r"(?:one |a round )?(?:every|alle) [\w.]+ \w+\.", re.IGNORECASE)
_AREA = re.compile(r"(?<![\w#-])([^\W\d_])\s?([1-9])(?![\w-])")
"""an area by its initial: `A2`"""
_ARTICLE = re.compile(r"\b(?:the|der|die|das)\s+$", re.IGNORECASE)


def choices_of(
    text: ScriptText, composer: Composer, likeliest: Sequence[Sentences] = ()
) -> tuple[Sentences, ...]:
    """Return what an open text may become, the likeliest first; at the end that nothing comes of
    it. `likeliest`: the choices of a row, before all others."""
    made: dict[Sentences, None] = dict.fromkeys(filter(None, likeliest))
    if len(text.content) > _LONGEST_LOOKED_AT:
        return (*made, ())
    text = composer.understanding.rewritten(composer.understanding.figures(text))
    text = composer.with_names(text)
    text = _with_areas(text, composer)
    found = mentions_in(text, composer.understanding)
    open_text = OpenText(text, found, composer, (*composer.known.memory.so_far,))
    with composer.known.unchanged():
        demands = open_text.demands
    others: dict[Sentences, None] = {}
    for way in _WAYS if len(text.content) <= _LONGEST else (_by_mentions,):
        with composer.known.unchanged():
            possible = filter(_is_possible, way(open_text))
            others |= dict.fromkeys(one for one in possible if _has_sense(one, way, open_text))
    others.pop((sentence(text),), None)  # it is open as it is
    if demands.spared:
        made = dict.fromkeys(filter(demands.met_by, made))
    made |= dict.fromkeys(sorted(filter(demands.met_by, others), key=demands.missing))
    return (*list(made)[: _MOST_CHOICES - 1], ())


def _is_possible(sentences: Sentences) -> bool:
    """Return False for nothing, for tasks behind the return to the docking station, and for what
    never ends: `Every 5 minutes.`"""
    endless = any(map(_ENDLESS.fullmatch, sentences))
    return (
        bool(sentences) and not endless and not any(s.startswith(_RETURN) for s in sentences[:-1])
    )


def _has_sense(sentences: Sentences, way: _Way, of: OpenText) -> bool:
    """Return False for a choice in the words of the text that would stay open, or that reads what
    may be no checkpoint: `Read one, then the other.`"""
    if way not in (_by_pronouns, by_parts):
        return True
    types = (of.composer.understanding.types(of.text.replaced(one)) for one in sentences)
    counts = any(("MEASURE", "NUMBER") in pairwise(one) for one in types)
    return not counts and is_understood(sentences, of.composer.known)


# ---- with pronouns replaced


def _by_pronouns(of: OpenText) -> Iterator[Sentences]:
    """Yield the text with each checkpoint that its pronoun may be, if it makes sense then."""
    pronouns = [m for m in of.found.of("pronoun") if _is_single(m)]
    for checkpoint in {c.id: c for c in _candidates(pronouns, of.composer)}.values():
        meant = of.text
        for mention in reversed(pronouns):
            article = _ARTICLE.search(of.text.content[: mention.start])
            start = mention.start if article is None else article.start()
            meant = meant.replace(start, mention.end, f"checkpoint {checkpoint.id}")
        meant = rephrased(of.composer.within(meant), of.composer.understanding).text
        if pronouns and reads(meant, of.composer.understanding):
            yield (sentence(meant),)


def _candidates(pronouns: Sequence[Mention], composer: Composer) -> Sequence[CheckpointInfo]:
    """Return what a pronoun may be: `the pressure` is that of any gauge that was read."""
    first = next((noun for mention in pronouns[:1] for noun in mention.nouns), None)
    kind = KINDS.get(first.quantity) if isinstance(first, Pronoun) else None
    if kind is None:
        return composer.known.memory.last
    return [c for c in composer.known.memory.so_far.values() if c.kind is kind]


def _is_single(mention: Mention) -> bool:
    """Return True for a pronoun that means one checkpoint: `it`, `the level`."""
    return all(isinstance(noun, Pronoun) and not noun.every for noun in mention.nouns)


def _with_areas(text: ScriptText, composer: Composer) -> ScriptText:
    """Return a text with `area 2` for `A2`, if the site has that area."""
    phrases = composer.understanding.language.lexicon.phrases["AREA", None]
    for found in reversed(list(_AREA.finditer(text.content))):
        names = [phrase for phrase in phrases if phrase.startswith(found[1].lower())]
        if names and composer.known.catalog.area(int(found[2])):
            text = text.replace(*found.span(), f"{names[0]} {found[2]}")
    return text


# ---- by what is mentioned


def _by_acts(of: OpenText) -> Iterator[Sentences]:
    """Yield what a text asks for, one after the other: `tank 5, a short break of 2 min, home`."""
    acts = of.acts(of.found, of.composer.known.last_named)
    if len(acts) > 1 and not of.found.has("IF", "UNLESS", "UNTIL", "ELSE", "EVENT"):
        yield as_sentences(acts)
    elif (
        not of.found.has("checkpoints", "EVENT")
        and of.found.has(*HOME, "END")
        and not any(of.lengths("DURATION", "MOST_TIME"))
    ):
        yield as_sentences([of.return_words])


def _by_mentions(of: OpenText) -> Iterator[Sentences]:
    """Yield what a text would be without what is not clear, and that its checkpoints are read."""
    for bare in (of.found.without(*_SIGNALS), of.found.without(*_SIGNALS, *_DOCKING)):
        made = sentences_of(bare, of.composer.known) if bare.mentions else None
        if made:
            yield made
    named: dict[int, CheckpointInfo] = {}
    for mention in of.found.of("checkpoints"):
        found = of.named_by(mention)
        named |= {c.id: c for c in found}
        alike = () if found else of.composer.known.alike(mention)
        yield from ((f"Check checkpoint {c.id}.",) for c in alike)
    again = of.composer.known.memory.last if of.found.has("pronoun") and not named else ()
    counts = [count for count in of.counts("TIMES") if count is not None and count > 1]
    for checkpoint in (*named.values(), *again) if len(counts) == 1 else ():
        if len(named) + len(again) == 1:
            yield (f"Check checkpoint {checkpoint.id} {counts[0]} times.",)
    if 0 < len(named) <= _MOST_CHOSEN:
        words = checkpoint_words(list(named.values()))
        if len(named) > 1 and any(map(_is_of_kind, of.found.of("checkpoints"))):
            yield (f"Check {words} in any order.",)
        yield (f"Check {words}.",)
        yield of.leaving_out(list(named))
        for length in filter(None, of.lengths("DURATION")):
            limited = of.is_limited(of.found)
            if not (limited or of.found.has("EVERY")):
                yield (f"Wait for {length}.", f"Check {words}.")
            if limited or of.type_before(of.found.of("DURATION")[0]) == "IN":
                yield (f"Check {words} not later than {length} after the start.",)
        if len(named) <= _FEW:
            yield from ((f"Check checkpoint {id}.",) for id in named)


def _is_of_kind(mention: Mention) -> bool:
    """Return True for `all valves` or `the gauges on floor 3`, whose order nobody has named."""
    return any(isinstance(noun, AllOf | TheOne) for noun in mention.nouns)


def _by_header(of: OpenText) -> Iterator[Sentences]:
    """Yield where a mission starts and ends, and how long it takes: `max 30 min, area 2 to 1`."""
    if any(map(of.named_by, of.found.of("checkpoints"))):
        return
    lengths = [*filter(None, of.lengths("DURATION", "MOST_TIME"))]
    limits = [f"Maximum duration: {length}." for length in lengths]
    homewards = of.found.has("home", "HOME", "END") or of.demands.returns
    starts = of.found.has("start", "START")
    if homewards and not of.areas:
        yield from _homewards(of, limits)
    places: list[Sentences] = []
    if len(of.areas) > 1:
        first, last = of.areas[0], of.areas[-1]
        end = f"End of the mission: starting area {last}."
        places.append((f"Start in starting area {first}.", end))
    for area in dict.fromkeys(of.areas):
        start, end = f"Start in starting area {area}.", f"End of the mission: starting area {area}."
        returned = f"Return to the docking station in starting area {area}."
        if homewards and not starts:
            places += [(returned,), (start, end), (start,)]
        elif homewards:
            places += [(start, end), (start,), (returned,)]
        else:
            places += [(start,), (returned,), (start, end)]
    for limit in limits:
        for place in places[:2]:
            yield (limit, *place) if place[0].startswith(_RETURN) else (*place, limit)
    if not (limits and starts and homewards):  # none of these is to be dropped
        yield from places
    if places and homewards:
        return
    for length in lengths:
        yield (f"Maximum duration: {length}.",)
        if not (homewards or of.is_limited(of.found)):
            yield (f"Wait for {length}.",)


def _homewards(of: OpenText, limits: Sequence[str]) -> Iterator[Sentences]:
    """Yield a return at a time: `go home at 30 minutes`; `finish by 20 minutes` is a limit."""
    times = of.found.of("DURATION")
    ends = "END" in of.types  # `finish by 20 minutes`
    when = of.type_before(times[0]) if times else ""
    for limit in limits:
        if when in ("AT", "AFTER", "IN"):
            yield (limit, "If the time is up, return to the docking station.")
        if when in ("AFTER", "IN"):
            length = of.lengths("DURATION")[0]
            yield (f"Wait for {length}.", f"{_RETURN}.")
        if when not in ("AT", "AFTER", "IN"):
            yield (limit,) if ends else (limit, f"{_RETURN}.")


def _by_dashes(of: OpenText) -> Iterator[Sentences]:
    """Yield the list of `#2 - #4 - #7`, whose dashes can be those of ranges, and what follows."""
    found = _DASHED.search(of.text.content)
    catalog = {c.id: c for c in of.composer.known.catalog.checkpoints}
    ids = [int(number) for number in re.findall(r"\d+", found[0])] if found else []
    if found is None or not {*ids} <= catalog.keys():
        return
    behind = tuple(m for m in of.found.mentions if m.start >= found.end())
    acts = of.acts(replace(of.found, mentions=behind))
    check = f"Check {checkpoint_words([catalog[id] for id in ids])}."
    yield (check, *as_sentences(acts))


def _by_order(of: OpenText) -> Iterator[Sentences]:
    """Yield what a text may be that speaks of the order."""
    labels = of.composer.understanding.language.prose.labels["order"]
    if phrase_pattern(labels).search(of.text.content):
        yield ("Order: precise.",)
        yield ("Order: any.",)


def _by_figures(of: OpenText) -> Iterator[Sentences]:
    """Yield the checkpoints that a bare number may be, those that were named before it first; of
    several numbers, first the list: `7 points: 19 20 18 17`."""
    listed = _LISTED.search(of.text.content)
    ids = list(dict.fromkeys(map(int, re.findall(r"\d+", listed[0])))) if listed else []
    if ids and {*ids} <= {c.id for c in of.composer.known.catalog.checkpoints}:
        checkpoints = {c.id: c for c in of.composer.known.catalog.checkpoints}
        yield (f"Check {checkpoint_words([checkpoints[id] for id in ids])}.",)
    if of.areas or of.found.has("checkpoints", "place", "AREA"):
        return
    figures = {of.text.content[m.start : m.end] for m in of.found.of("NUMBER")}
    known = of.composer.known
    steps = of.found.has("STEP", "swapping") and figures <= known.items.keys()
    items = {known.items[figure] for figure in figures if figure in known.items}
    alike = [
        c
        for c in known.catalog.checkpoints
        if c.id in items or (not steps and {str(c.id), c.name.split()[-1]} & figures)
    ]
    alike.sort(key=lambda c: (c.id not in items, c.id not in known.memory.so_far))
    for checkpoint in alike:
        if of.found.has("leave_out", "forbidding", "NOT", "correction", "DELETE", "past"):
            yield of.leaving_out([checkpoint.id])
        else:
            yield (f"Check checkpoint {checkpoint.id}.",)


_WAYS: tuple[_Way, ...] = (
    _by_pronouns,
    by_swaps,
    by_numbers,
    by_corrections,
    by_leaving_out,
    _by_dashes,
    by_edits,
    by_sequence,
    by_cases,
    by_rounds,
    by_parts,
    _by_order,
    _by_acts,
    _by_mentions,
    _by_header,
    _by_figures,
)
