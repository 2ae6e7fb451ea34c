"""Demands of an open text on its choices: what each of them has to respect.

A choice may leave out words that Argo does not know. It may not read what the text leaves out,
name a checkpoint that the text does not name, do always what is to be done in a case, or reverse
an order.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise, product

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.source import RefusedError, ScriptText
from argo_compiler.script.proposals.frames import Sentences, length_words
from argo_compiler.script.proposals.known import Known, is_number
from argo_compiler.script.proposals.mentions import Mention, Mentions
from argo_compiler.script.sentences.tree.nouns import AllOf, TheOne
from argo_compiler.script.sentences.tree.places import AreaLocation, DockLocation
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import phrase_pattern
from argo_compiler.script.sentences.words.word import Word

LEAVING_OUT = ("leave_out", "SPARE", "DELETE", "in_place_of")
"""kinds of mentions that leave out the checkpoint beside them"""
_IFS = frozenset(["IF", "IF_ONLY", "UNLESS"])
_READINGS = frozenset(
    [
        *("GREATER", "LESS", "AT_LEAST", "AT_MOST", "BETWEEN", "OUTSIDE", "STATE", "FAILS"),
        *("EVENT", "QUANTITY"),
    ]
)
"""types of words of a case that the mission language has"""
SPREADS = frozenset(product(("NUMBER", "QUANTITY"), ("TO", "DASH"), ("NUMBER", "QUANTITY")))
"""types of words of a range: `4 to 5 bar`"""
_NO_DENIALS = _IFS | {"UNTIL", "FOCUS", "EARLIEST", "LATEST", "WITHIN", "EXCEPT", "AT_MOST"}
"""types of words that the cues of a denial cover as well: `if`, `only`, `not before`"""
_PARTING = ("AND_", "NEXT", "BUT", "JOINT", "ELSE", "COLON")
"""how types of words begin that part clauses"""
_COMMA = re.compile(r"[,;.:!?]\s|\s[-–>]+\s")
_RELATIONS = ("BEFORE", "AFTER", "EARLIEST")
_TIMES = {1: ("once",), 2: ("twice",)}
_STOP = re.compile("[,;.:!?-]")
_ADJACENT = 5
"""characters between a word and the checkpoint that it is of, perhaps with an article"""
_NUMBERED = re.compile(r"checkpoint (\d+)")
_CASE = re.compile(r"^If [^,]*, | (?:unless|until|if) .*$")
_CONDITIONAL = re.compile(r"\b(?:If|if|Unless|unless)\b|, retry ")
_ACTS = re.compile(r"Check |Delete |Do not check |If |Otherwise|At the end, check ")
_SPARING = re.compile(r"Delete |Do not check ")
_MOVED = re.compile(r"(?:Move|Add) checkpoint (\d+) (before|after) checkpoint (\d+)")
_EDIT = re.compile(r"Move |Add |Replace ")
_END = re.compile(r"[Rr]eturn|End of|[Aa]bort|[Ee]nd the mission|[Gg]o on")
_AT_AREA = re.compile(r"(?:Return|End of the mission).* starting area")


@dataclass(frozen=True)
class Demands:
    """Checkpoints that a text names, leaves out and puts in order, with its case and times."""

    named: frozenset[int] | None
    """all checkpoints that may be meant; None if that is not clear"""
    asked: tuple[int, ...]
    """those that are to be read, or that a case is about"""
    spared: tuple[int, ...]
    """those that are to be left out"""
    sequences: tuple[tuple[int, int], ...]
    """pairs of checkpoints of which the first comes first"""
    reports: bool
    """whether it may say what was done, or ask: then what it leaves out may be read"""
    conditional: bool
    """whether it has a case that the mission language has as well"""
    starts: bool
    """whether it names the area of the start"""
    returns: bool
    """whether it sends the robot back, or names a docking station"""
    amounts: tuple[tuple[str, ...], ...]
    """its times, and how often something is done; each in all words that a choice may have"""
    swaps: bool
    """whether two checkpoints change places"""
    spaced: bool
    """whether it has a time between two readings"""

    def met_by(self, sentences: Sentences) -> bool:
        """Return True if a choice respects the demands."""
        if self.conditional and not any(map(_CONDITIONAL.search, sentences)):
            return False
        if self.starts and not self.returns and any(map(_AT_AREA.match, sentences)):
            return False
        if self.swaps and not any(map(_EDIT.match, sentences)):
            return False
        if self.spaced and not any(sentence.startswith("Wait ") for sentence in sentences):
            return False
        spares = self.reports or self._spares(sentences)
        return spares and self._names(sentences) and self._in_order(sentences)

    def missing(self, sentences: Sentences) -> int:
        """Return how much of the text a choice does not have: checkpoints, times, its start and
        its end; more for one that reads what the text leaves out."""
        said = " ".join(sentences)
        edits = any(map(_EDIT.match, sentences))
        lacking = set() if edits else {*self.asked, *self.spared} - {*_ids(said)}
        amounts = sum(not any(words in said for words in one) for one in self.amounts)
        ends = (self.starts and "Start " not in said, self.returns and not _END.search(said))
        left_out = 0 if self._spares(sentences) else len(self.spared) + len(self.asked)
        return len(lacking) + amounts + sum(ends) + left_out

    def _names(self, sentences: Sentences) -> bool:
        """Return True if a choice acts on no other checkpoints than the text names, and on none
        twice in a row."""
        acts = [_CASE.sub("", s) for s in sentences if _ACTS.match(s) and " again" not in s]
        fits = self.named is None or {id for act in acts for id in _ids(act)} <= self.named
        read = {id for act in acts if act.startswith("Check ") for id in _ids(act)}
        left_out = {id for s in sentences if _SPARING.match(s) for id in _ids(s)}
        undone = not read.isdisjoint(left_out) and not any(" unless " in s for s in sentences)
        return fits and not undone and all(a != b for act in acts for a, b in pairwise(_ids(act)))

    def _spares(self, sentences: Sentences) -> bool:
        """Return True if a choice reads nothing that the text leaves out, unless in another case,
        and leaves out nothing else."""
        for sentence in sentences if self.spared else ():
            ids = {*_ids(_CASE.sub("", sentence))}
            if _SPARING.match(sentence):
                if not ids <= {*self.spared}:
                    return False
            elif " unless " in sentence or sentence.startswith("Otherwise"):
                continue
            elif "heck " in sentence and not ids.isdisjoint(self.spared):
                return False
        return True

    def _in_order(self, sentences: Sentences) -> bool:
        """Return True if a choice that reads or moves two checkpoints has them in the order of the
        text."""
        for moved in filter(None, map(_MOVED.match, sentences)):
            one, other = int(moved[1]), int(moved[3])
            if ((other, one) if moved[2] == "before" else (one, other)) in self.sequences:
                return False
        read = [id for s in sentences if s.startswith("Check ") for id in _ids(_CASE.sub("", s))]
        pairs = [pair for pair in self.sequences if {*pair} <= {*read}]
        if any(" in any order" in s for s in sentences):
            return not pairs
        return all(read.index(first) < read.index(second) for first, second in pairs)


def demands_of(text: ScriptText, found: Mentions, known: Known) -> Demands:
    """Return the demands of a text."""
    words = sorted(known.understanding.words(text), key=lambda word: word.start)
    named = {m: named_by(m, words, known) for m in found.of("checkpoints")}
    types = {word.type for word in words} | {mention.kind for mention in found.mentions}
    told = types | {name for name in ("failing", "too_high", "too_low") if tells(name, text, known)}
    if found.has("place"):  # `unless floor 3 is closed`
        told -= {"STATE"}
    ordered = [word.type for word in words]
    spread = not SPREADS.isdisjoint(zip(ordered, ordered[1:], ordered[2:], strict=False))
    reads = spread or bool(told & (_READINGS | {"failing", "too_high", "too_low"}))
    in_known_case = bool(types & _IFS) and reads
    left_out = _left_out(text, found, words, known, in_known_case)
    denied = [m for m in named if _is_denied(m, text, found, words)]
    exceptions = [m for m in named if _type_before(m, words, text) == "EXCEPT"]
    asked: dict[int, None] = {}
    spared: dict[int, None] = {}
    for mention, checkpoints in named.items():
        if mention in exceptions:
            continue
        ids = [c.id for c in checkpoints]
        if mention in denied:  # `R7, R31 - no, not R31, R40`
            taken_back = [id for id in ids if id in asked] or ids
            spared |= dict.fromkeys(taken_back)
            asked |= dict.fromkeys(id for id in ids if id not in taken_back)
            continue
        behind = [one for one in exceptions if one.start > mention.start][:1]
        but = [id for one in behind for id in _excepted(one, ids, known)]
        others = [id for id in ids if id not in but]
        first, second = (others, but) if mention in left_out else (but, others)
        spared |= dict.fromkeys(first)
        asked |= {} if mention in left_out else dict.fromkeys(second)
    return Demands(
        named=_all_named(text, found, known, [c.id for some in named.values() for c in some]),
        asked=tuple(id for id in asked if id not in spared),
        spared=tuple(spared),
        sequences=tuple(_sequences(text, words, named)),
        reports=found.has("past", "question") or "DONE" in types,
        conditional=in_known_case,
        starts=found.has("start", "START") and any(map(_is_area, found.of("place"))),
        returns=returns(found),
        amounts=tuple(_amounts(found)),
        swaps=len(asked) != 1 and any(_is_of_points(m, text, found) for m in found.of("swapping")),
        spaced=found.has("SPAN"),
    )


def _is_of_points(swapping: Mention, text: ScriptText, found: Mentions) -> bool:
    """Return False for `swap the pump`."""
    behind = [word.start for word in found.unknown if word.start >= swapping.end][:1]
    between = [text.content[swapping.end : start] for start in behind]
    return not any(len(some) <= _ADJACENT and not _STOP.search(some) for some in between)


def _amounts(found: Mentions) -> Iterator[tuple[str, ...]]:
    """Yield the words that choices may have for the times of a text: `twice` is `2 times`."""
    for mention in found.of("DURATION", "MOST_TIME", "TIMES"):
        if isinstance(mention.value, Length) and (words := length_words(mention.value)):
            yield (words,)
        elif isinstance(mention.value, Figure) and (count := mention.value.whole):
            yield (f"{count} times", *_TIMES.get(count, ()))


def _is_area(place: Mention) -> bool:
    return isinstance(place.value, AreaLocation)


def returns(found: Mentions) -> bool:
    """Return True if a text names a docking station, or sends the robot back."""
    docks = any(isinstance(mention.value, DockLocation) for mention in found.of("place"))
    return docks or found.has("home", "HOME", "END", "DOCK")


def named_by(mention: Mention, words: Sequence[Word], known: Known) -> list[CheckpointInfo]:
    """Return the checkpoints that a part names; none if that is not clear: `two valves`."""
    with suppress(RefusedError):
        checkpoints = known.checkpoints([mention])
        before = [word for word in words if word.end <= mention.start]
        last = max((word.end for word in before), default=0)
        counts = [word.value for word in before if word.end == last and word.type == "NUMBER"]
        of_kind = all(isinstance(noun, AllOf | TheOne) for noun in mention.nouns)
        counted = of_kind and any(
            isinstance(count, Figure) and count.whole != len(checkpoints) for count in counts
        )
        return [] if counted else checkpoints
    return []


def _ids(sentence: str) -> list[int]:
    return [int(number) for number in _NUMBERED.findall(sentence)]


def tells(name: str, text: ScriptText, known: Known) -> bool:
    """Return True if a text has one of the phrases that say something of a case."""
    cues = known.understanding.language.prose.cues
    return phrase_pattern(cues[name]).search(text.content) is not None


def _type_before(mention: Mention, words: Sequence[Word], text: ScriptText) -> str:
    """Return the type of the word right before a part; empty if others stand in between."""
    before = [word for word in words if word.end <= mention.start]
    last = max(before, key=lambda word: word.end, default=None)
    near = last is not None and len(text.content[last.end : mention.start].strip()) < _ADJACENT
    return last.type if last is not None and near else ""


def _all_named(
    text: ScriptText, found: Mentions, known: Known, ids: Sequence[int]
) -> frozenset[int] | None:
    """Return all checkpoints that a text may mean; None if it names none, or not clearly."""
    named = found.of("checkpoints")
    if found.has("place") and not all(map(_is_labelled, named)):
        return None  # `on the top floor the level gauge`
    words = known.understanding.words(text)
    limits = (*_READINGS, "AND_AMOUNT")
    figures = [m for m in found.of("NUMBER") if _type_before(m, words, text) not in limits]
    numbers = {text.content[m.start : m.end] for m in figures}
    wholes = [m.value.whole for m in figures if isinstance(m.value, Figure)]
    ids = [*ids, *(known.items[number] for number in numbers if number in known.items)]
    ids += [c.id for c in known.catalog.checkpoints if c.id in wholes]
    for mention in named:
        alike = known.alike(mention)
        with suppress(RefusedError):
            alike = [*alike, *known.checkpoints([mention])]
            ids = [*ids, *(c.id for c in alike)] if _is_labelled(mention) else ids
            continue
        if not alike:
            return None
        ids = [*ids, *(c.id for c in alike)]
    if found.has("pronoun", "again", "MORE"):
        ids = [*ids, *(c.id for c in known.memory.last)]
    return frozenset(ids) if named else None


def _is_plain(mention: Mention) -> bool:
    """Return True for a checkpoint by its name, without exceptions."""
    return _is_labelled(mention) and len(mention.nouns) == 1


def _is_labelled(mention: Mention) -> bool:
    return not any(isinstance(noun, AllOf | TheOne) for noun in mention.nouns)


def _left_out(
    text: ScriptText,
    found: Mentions,
    words: Sequence[Word],
    known: Known,
    in_known_case: bool,
) -> list[Mention]:
    """Return the checkpoints that a text leaves out: those behind `skip` in its clause, or else
    the one before it."""
    named = found.of("checkpoints")
    kept = [m for m in named if _type_before(m, words, text) != "EXCEPT"]
    inside = [(m.start, m.end) for m in named]
    parting = [w for w in words if w.type.startswith(_PARTING) or w.type in _IFS]
    joints = [word.start for word in parting]
    commas = [comma.start() for comma in _COMMA.finditer(text.content)]
    cuts = sorted(at for at in (*joints, *commas) if not any(a < at < b for a, b in inside))
    left_out: list[Mention] = []
    for start, end, plain in _cues(text, found, words, known):
        clause = bisect_right(cuts, start)
        near = [m for m in kept if bisect_right(cuts, m.start) == clause]
        behind = [m for m in near if m.start >= end]
        before = [m for m in near if m.end <= start]
        if not near and plain:
            before = [m for m in named if m.end <= start and _is_plain(m)]
            cases = [w for w in words if before and before[-1].end <= w.start < start]
            if not in_known_case and any(word.type in _IFS for word in cases):
                before = []  # `R12, unless the deck is wet, then leave it out`
        left_out += behind or before[-1:]
    return left_out


def _cues(
    text: ScriptText, found: Mentions, words: Sequence[Word], known: Known
) -> Iterator[tuple[int, int, bool]]:
    """Yield where the words stand that leave something out, and whether they may do so with what
    another clause names: `R12? Skip it.`"""
    states = [(word.start, word.end) for word in words if word.type in ("STATE", "OUTSIDE")]
    denials = [m.end for m in found.of("forbidding", "NOT")]
    for cue in found.of(*LEAVING_OUT):
        denied = any(0 <= cue.start - end <= 1 for end in denials)  # `do not skip R12`
        if not denied and not any(a < cue.end and cue.start < b for a, b in states):
            yield cue.start, cue.end, cue.kind != "in_place_of"
    away = phrase_pattern(known.understanding.language.prose.form["away"])
    for word in found.unknown:
        if away.fullmatch(text.content[word.start : word.end]):
            yield word.start, word.end, False


def _is_denied(mention: Mention, text: ScriptText, found: Mentions, words: Sequence[Word]) -> bool:
    """Return True for a checkpoint behind `not` or `no`; not behind `not before`."""
    for cue in found.of("forbidding", "NOT"):
        if cue.end <= mention.start and not text.content[cue.end : mention.start].strip():
            types = {word.type for word in words if word.start < cue.end and cue.start < word.end}
            behind = {word.type for word in words if word.start == cue.start}
            return types.isdisjoint(_NO_DENIALS) and behind.isdisjoint(_NO_DENIALS)
    return False


def _excepted(mention: Mention, ids: Sequence[int], known: Known) -> list[int]:
    """Return which of some checkpoints an exception means: `all gauges apart from no. 6`; by
    name before number."""
    with suppress(RefusedError):
        checkpoints = known.checkpoints([mention])
        catalog = {c.id: c for c in known.catalog.checkpoints}
        labels = {str(c.id) for c in checkpoints}
        by_name = [id for id in ids if catalog[id].name.split()[-1] in labels]
        by_number = [c.id for c in checkpoints if c.id in ids]
        return (by_name if is_number(mention) else by_number) or by_number or by_name
    return []


def _sequences(
    text: ScriptText, words: Sequence[Word], named: dict[Mention, list[CheckpointInfo]]
) -> Iterator[tuple[int, int]]:
    """Yield pairs of checkpoints of which the first comes before the second: `R31 after R7`,
    `R7 not before R31`, `after R7, R31`."""
    mentions = list(named)
    for i, (first, second) in enumerate(pairwise(mentions)):
        between = [w for w in words if first.end <= w.start and w.end <= second.start]
        last = next((one.type for one in reversed(between) if one.type in _RELATIONS), "")
        if last == "AFTER" and text.content[first.end :].lstrip().startswith(","):
            continue  # `R9, after R7` may mean afterwards
        if not last and i == 0:
            before = [word.type for word in words if word.end <= first.start][-1:]
            last = {"AFTER": "BEFORE", "BEFORE": "AFTER"}.get("".join(before), "")
        if not last:
            continue
        reverse = (last != "BEFORE") != ("NOT" in [one.type for one in between])
        a, b = (second, first) if reverse else (first, second)
        yield from ((x.id, y.id) for x in named[a] for y in named[b] if x != y)
