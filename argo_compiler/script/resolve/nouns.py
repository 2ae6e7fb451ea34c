"""Which checkpoints a noun phrase means; what can be read in two ways is asked about."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NoReturn, TypeGuard

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.listing import listed
from argo_compiler.diagnostics import Span
from argo_compiler.script.documents.source import Diagnostics, RefusedError
from argo_compiler.script.resolve.lookup import Lookup, agrees, told
from argo_compiler.script.sentences.tree.nouns import (
    AllOf,
    Kind,
    Labelled,
    Noun,
    Nouns,
    Pronoun,
    Quantity,
    TheOne,
)
from argo_compiler.script.sentences.tree.places import FloorName

_BESIDE = frozenset([",", ";", ":", "-", "–", "/", "="])
"""between number and name of one checkpoint"""
_SHOWN_BY: dict[Quantity | None, Kind] = {
    Quantity.PRESSURE: Kind.PRESSURE_GAUGE,
    Quantity.LEVEL: Kind.LIQUID_LEVEL_GAUGE,
    Quantity.POSITION: Kind.VALVE,
}
"""what shows a quantity"""
_SHOWN = 6
"""checkpoints that a message names"""


class Memory:
    """What pronouns may mean: what was measured by the last order that measured."""

    def __init__(self) -> None:
        self.last: tuple[CheckpointInfo, ...] = ()
        self.before: tuple[CheckpointInfo, ...] = ()
        self.so_far: dict[int, CheckpointInfo] = {}
        """all that was measured, by number"""
        self.known = True
        """whether all that was ordered so far is understood"""

    def copy(self) -> "Memory":
        """Return a memory of the same, which forgets and remembers apart from this one."""
        other = Memory()
        other.last, other.before, other.known = self.last, self.before, self.known
        other.so_far = dict(self.so_far)
        return other

    def measured(self, checkpoints: Iterable[CheckpointInfo]) -> None:
        if found := tuple(checkpoints):
            self.before, self.last = self.last, found
            self.so_far.update((c.id, c) for c in found)

    def latest(self, kind: Kind) -> list[CheckpointInfo]:
        """Return the checkpoints of a kind that were measured last, or else all measured so far."""
        measured = (self.last, self.so_far.values())
        return next(filter(None, ([c for c in m if agrees(c, kind)] for m in measured)), [])


class NounResolver:
    """Looks noun phrases up. All raise RefusedError where it is not clear what is meant."""

    def __init__(self, lookup: Lookup, diagnostics: Diagnostics, memory: Memory) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics
        self.memory = memory

    def all(self, nouns: Nouns) -> list[CheckpointInfo]:
        """The checkpoints of a list, in its order, each as often as it is named."""
        if nouns.either:
            said = self.diagnostics.source.said(nouns.span)
            message = f"`{said}` can mean either of them, or both"
            hint = "write `and` for all of them, or name one"
            self.diagnostics.refuse("ambiguous-or", message, nouns.span, hint)
        found = self.each(nouns)
        twice = {c.id: c for i, c in enumerate(found) if c in found[:i]}
        for checkpoint in twice.values():
            if any(isinstance(noun, AllOf) for noun in nouns.nouns):
                message = f"{told(checkpoint)} is in this list twice; it is not clear whether to "
                message += "measure it twice"
                hint = "remove it, or write a separate sentence: `check it again`"
                self.diagnostics.refuse("ambiguous-measure", message, nouns.span, hint)
            message = f"{told(checkpoint)} is in this list twice or more, and is measured each time"
            hint = "remove it to measure it only once"
            self.diagnostics.warning("listed-twice", message, nouns.span, hint)
        return found

    def on(self, floors: Sequence[FloorName], nouns: Nouns) -> Nouns:
        """The phrase, of what is on these floors; a floor that it names itself has to be one."""
        placed: list[Noun] = []
        for noun in nouns.nouns:
            own = () if isinstance(noun, Pronoun) else noun.floors
            if not isinstance(noun, Pronoun) and not own:
                placed.append(replace(noun, floors=tuple(floors)))
                continue
            if not own or not {f.number for f in own} <= {f.number for f in floors}:
                said = self.diagnostics.source.said(noun.span)
                message = f"`{said}` is on two floors according to this"
                hint = "remove one of the two floors"
                self.diagnostics.refuse("ambiguous-floor", message, noun.span, hint)
            placed.append(noun)
        return replace(nouns, nouns=tuple(placed))

    def each(self, nouns: Nouns) -> list[CheckpointInfo]:
        """As `all`, for lists joined by `or` as well."""
        found: list[CheckpointInfo] = []

        def find(one: tuple[Noun, Kind | None, bool]) -> None:
            # `checkpoint 14, position of the valve`
            if not (found and _is_the_one(one[0]) and agrees(found[-1], one[0].kind)):
                found.extend(self._noun(*one))

        self.diagnostics.each(find, _inheriting(self._once_each(nouns.nouns)))
        out: list[CheckpointInfo] = []
        for noun, kind, _ in _inheriting(nouns.but):
            excepted = self._left_out(noun, kind, found)
            self._require_no_count(noun, excepted, found)
            if len(nouns.but) > 1 and not any(checkpoint in found for checkpoint in excepted):
                said = self.diagnostics.source.said(noun.span)
                message = f"`{said}` can be a further exception, or a further checkpoint"
                hint = "write the exceptions at the end: `all valves and all gauges except #1`"
                self.diagnostics.refuse("ambiguous-exception", message, noun.span, hint)
            for checkpoint in excepted:
                if checkpoint not in found:
                    self._require_no_name(noun, checkpoint, found)
                    message = f"{told(checkpoint)} is not in this list anyway"
                    hint = "remove it, or name another one"
                    self.diagnostics.warning("needless-exception", message, noun.span, hint)
                out.append(checkpoint)
        left = [checkpoint for checkpoint in found if checkpoint not in out]
        if not left:
            message = f"`{self.diagnostics.source.said(nouns.span)}` leaves no checkpoint"
            hint = "name the checkpoints to measure"
            self.diagnostics.refuse("no-checkpoint", message, nouns.span, hint)
        return left

    def _once_each(self, nouns: Sequence[Noun]) -> Sequence[Noun]:
        """Return a list without the names that stand behind the numbers of the same checkpoints, or
        the other way round: `#8, pressure gauge 5`."""
        again = (self._names_again(first, second) for first, second in pairwise(nouns))
        return [
            *nouns[:1],
            *(b for b, is_again in zip(nouns[1:], again, strict=True) if not is_again),
        ]

    def _names_again(self, first: Noun, second: Noun) -> bool:
        """Return True for number and name of one checkpoint, side by side; ask about `#8, pressure
        gauge 8`, which may be meant so."""
        if not isinstance(first, Labelled) or not isinstance(second, Labelled):
            return False
        numbered = [noun.hash or noun.kind is Kind.CHECKPOINT for noun in (first, second)]
        said = self.diagnostics.source.said(first.span, second.span)
        beside = said[first.span.length : len(said) - second.span.length].strip() in _BESIDE
        named = second if numbered[0] else first
        single = first.last is second.last is None
        if not beside or not single or sum(numbered) != 1 or named.kind is None:
            return False
        (one,), (other,) = (self._named(noun, noun.kind, False) for noun in (first, second))
        if one != other and first.label == second.label:
            message = f"`{said}` can be {told(one)} and {told(other)}, or only one of them"
            hint = "correct the number or the name, or write `and` between two checkpoints"
            self.diagnostics.refuse("checkpoint-mismatch", message, second.span, hint)
        return one == other

    def _require_no_count(
        self, noun: Noun, excepted: list[CheckpointInfo], found: list[CheckpointInfo]
    ) -> None:
        """Asks about `all valves except two`, which may be checkpoint 2, or any two of them."""
        if not isinstance(noun, Labelled) or noun.kind is not None or noun.hash or noun.last:
            return
        said = self.diagnostics.source.said(noun.span)
        inside = any(checkpoint in found for checkpoint in excepted)
        if isinstance(noun.label, int) and not (inside and said.isdigit()):
            message = f"`{said}` can be {told(excepted[0])}, or the number of exceptions"
            hint = f"write `except checkpoint {noun.label}`, or name the checkpoints to measure out"
            self.diagnostics.refuse("ambiguous-exception", message, noun.span, hint)

    def _require_no_name(
        self, noun: Noun, excepted: CheckpointInfo, found: list[CheckpointInfo]
    ) -> None:
        """Asks about `all level gauges except number 3`, which may be that of the name."""
        label = str(noun.label) if isinstance(noun, Labelled) and noun.kind is None else ""
        named = [c for c in found if label and c.name.split()[-1].lower() == label.lower()]
        if named:
            said = self.diagnostics.source.said(noun.span)
            message = f"`{said}` can be {told(excepted)}, which is not in this list, or "
            message += f"{named[0].name}, which is"
            hint = f"write `except {named[0].name}`, or remove the exception"
            self.diagnostics.refuse("ambiguous-exception", message, noun.span, hint)

    def warn_of_empty(
        self, floors: Sequence[FloorName], found: Sequence[CheckpointInfo], what: str, span: Span
    ) -> None:
        """Warns of floors that are named, and have nothing of what is to be done."""
        numbers = self.lookup.numbers(floors)
        without = [floor for floor in numbers if not any(c.floor == floor for c in found)]
        if without:
            message = f"there is no {what} on floor {listed(map(str, without), 'or')}"
            self.diagnostics.warning("empty-floor", message, span)

    def one(self, nouns: Nouns) -> CheckpointInfo:
        """The only checkpoint of a phrase."""
        found = self.each(nouns)
        if len(found) != 1:
            message = "this must be a single checkpoint"
            self.diagnostics.refuse("one-checkpoint", message, nouns.span, "name one of them")
        return found[0]

    def last(self, span: Span) -> list[CheckpointInfo]:
        """What was measured last, where a condition names nothing."""
        return self._pronoun(Pronoun(span=span))

    def _left_out(
        self, noun: Noun, kind: Kind | None, found: list[CheckpointInfo]
    ) -> list[CheckpointInfo]:
        """What an exception means; `the valve` is one of those that were named before."""
        if isinstance(noun, TheOne) and not noun.floors:
            inside = [c for c in found if agrees(c, noun.kind)]
            if len(inside) == 1 or (inside and noun.plural):
                return inside
        return self._noun(noun, kind, plural=True)

    def _noun(self, noun: Noun, kind: Kind | None, plural: bool) -> list[CheckpointInfo]:
        match noun:
            case Labelled():
                return self._named(noun, kind, plural)
            case AllOf():
                return self._of_kind(noun)
            case TheOne():
                return self._the_one(noun)
            case Pronoun():
                return self._pronoun(noun)

    # ---- by number or name: `#4`, `valve R25`, `gauges 1 to 5`

    def _named(self, noun: Labelled, kind: Kind | None, plural: bool) -> list[CheckpointInfo]:
        """The checkpoints of one label, of the kind that those before it in a list have."""
        if noun.last is not None:
            return [self._there(noun, number, kind, True) for number in self._range(noun)]
        found = self._there(noun, noun.label, kind, plural)
        also = noun.also
        if also is not None:
            other = self._one(also, also.label, also.kind, False)
            if other is not found:
                message = f"checkpoint #{found.id} is {found.name}, and {other.name} is "
                message += f"checkpoint #{other.id}"
                hint = "correct the number or the name"
                self.diagnostics.refuse("checkpoint-mismatch", message, also.span, hint)
        self.lookup.check_quantity(found, noun.quantity, noun.span)
        if also is not None:
            self.lookup.check_quantity(found, also.quantity, also.span)
        return [found]

    def _range(self, noun: Labelled) -> range:
        first, last = noun.label, noun.last
        said = self.diagnostics.source.said(noun.span)
        if not noun.hash and noun.kind is not Kind.CHECKPOINT and "#" in said:
            message = f"`{said}` can be a range, or number and name of one checkpoint"
            hint = f"write `{first} to {last}` for the first, or only one of the two"
            self.diagnostics.refuse("range", message, noun.span, hint)
        if not isinstance(first, int) or not isinstance(last, int):
            message = "a range needs two numbers"
            self.diagnostics.refuse("range", message, noun.span, "name each checkpoint")
        if first > last:
            message = "this range of checkpoints is empty"
            hint = "write the lower number first"
            self.diagnostics.refuse("empty-range", message, noun.span, hint)
        return range(first, last + 1)

    def _there(
        self, noun: Labelled, label: int | str, kind: Kind | None, plural: bool
    ) -> CheckpointInfo:
        """The checkpoint of a label, which has to be on the floor that is said."""
        found = self._one(noun, label, kind, plural)
        floors = self.lookup.numbers(noun.floors)
        if floors and found.floor not in floors:
            where = f"on floor {found.floor}, not on floor {listed(map(str, floors), 'or')}"
            message = f"{told(found)} is {where}"
            hint = "correct the floor or the name"
            self.diagnostics.refuse("checkpoint-mismatch", message, noun.span, hint)
        return found

    def _one(
        self, noun: Labelled, label: int | str, kind: Kind | None, plural: bool
    ) -> CheckpointInfo:
        if noun.hash or kind in (None, Kind.CHECKPOINT):
            if not isinstance(label, int):
                return self.lookup.identified(label, noun.kind, noun.span)
            if kind not in (None, Kind.CHECKPOINT) and (noun.kind or plural):
                return self._numbered_of_kind(label, kind, noun.span)
            return self.lookup.numbered(label, noun.span)
        if kind is Kind.GAUGE and isinstance(label, int):
            self._require_named(label, noun.span)
        if noun.kind is None and not plural and isinstance(label, int):
            return self._inherited(noun, label, kind)
        if noun.kind is None and not self.lookup.called(str(label), kind):
            kind = None  # `pressure gauge 1, R25`: a name has no kind from the one before it
        return self.lookup.identified(str(label), kind, noun.span)

    def _numbered_of_kind(self, number: int, kind: Kind, span: Span) -> CheckpointInfo:
        """The checkpoint that `valve #5` means: by its number, or the valve that is called so."""
        numbered = self.lookup.by_number.get(number)
        readings = {c.id: c for c in self.lookup.called(str(number), kind)}
        if numbered is not None and agrees(numbered, kind):
            readings[numbered.id] = numbered
        if len(readings) == 1:
            return next(iter(readings.values()))
        if readings:
            hint = f"write `checkpoint {number}` or `{kind} {number}`"
            named = map(told, readings.values())
            self.lookup.refuse_readings(f"{kind} #{number}", named, span, hint)
        found = self.lookup.numbered(number, span)
        message = f"checkpoint #{number} is {found.name}, and there is no {kind} {number}"
        self.diagnostics.refuse("checkpoint-mismatch", message, span, "name one of them")

    def _require_named(self, number: int, span: Span) -> None:
        """Ask about `gauge 8`, which can be checkpoint 8 as well if that is a gauge."""
        named = self.lookup.called(str(number), Kind.GAUGE)
        numbered = self.lookup.by_number.get(number)
        if len(named) != 1 or numbered is None or numbered in named:
            return
        if agrees(numbered, Kind.GAUGE):
            hint = f"write `checkpoint {number}` or `{named[0].name}`"
            readings = map(told, (*named, numbered))
            self.lookup.refuse_readings(f"{Kind.GAUGE} {number}", readings, span, hint)

    def _inherited(self, noun: Labelled, label: int, kind: Kind | None) -> CheckpointInfo:
        """`valve R25 and 5`: a number behind one of a kind may be a name or a number."""
        named = self.lookup.called(str(label), kind)
        numbered = self.lookup.by_number.get(label)
        readings = list(map(told, named))
        if numbered is not None and numbered not in named:
            readings.append(f"checkpoint #{label} ({numbered.name})")
        if not readings:
            return self.lookup.numbered(label, noun.span)
        hint = f"write `checkpoint {label}` or `{kind} {label}`"
        self.lookup.refuse_readings(str(label), readings, noun.span, hint)

    # ---- by kind, floor and what came before

    def _of_kind(self, noun: AllOf) -> list[CheckpointInfo]:
        floors = self.lookup.numbers(noun.floors)
        found = self.lookup.of_kind(noun.kind, floors)
        if not found:
            where = f" on floor {listed(map(str, floors), 'or')}" if floors else ""
            message = f"there is no {noun.kind}{where} on {self.lookup.catalog.site}"
            self.diagnostics.refuse("unknown-checkpoint", message, noun.span, "name another floor")
        self.warn_of_empty(noun.floors, found, str(noun.kind), noun.span)
        if noun.count is not None and noun.count != len(found):
            said = self.diagnostics.source.said(noun.span)
            message = f"`{said}`: there are {len(found)}, {listed(map(told, found[:_SHOWN]))}"
            self.diagnostics.refuse("ambiguous-checkpoint", message, noun.span, "name them")
        return found

    def _the_one(self, noun: TheOne) -> list[CheckpointInfo]:
        last = self.memory.latest(noun.kind)
        if not noun.floors and (len(last) > 1 if noun.plural else len(last) == 1):
            return last
        if not noun.plural and not noun.floors and not last:
            self._nothing_before(noun.span)
        found = self._of_kind(AllOf(span=noun.span, kind=noun.kind, floors=noun.floors))
        if noun.plural or len(found) == 1:
            return found
        self._ambiguous("ambiguous-checkpoint", noun, last or found)

    def _pronoun(self, noun: Pronoun) -> list[CheckpointInfo]:
        last = self.memory.last
        if not last:
            self._nothing_before(noun.span)
        if kind := _SHOWN_BY.get(noun.quantity):
            found = self.memory.latest(kind)
            if len(found) > 1:
                self._ambiguous("ambiguous-pronoun", noun, found)
            if not found:
                said = self.diagnostics.source.said(noun.span)
                message = f"no {kind} is measured before this, so that `{said}` means none"
                self._refuse_missing(message, noun.span, "name the checkpoint")
            return found
        if noun.count is not None:
            return self._counted(noun, noun.count)
        if noun.every and len(last) == len(self.memory.before) == 1:
            both = [*self.memory.before, *last]
            one, two = map(told, both)
            said = self.diagnostics.source.said(noun.span)
            if len(self.memory.so_far) > len(both):
                message = f"`{said}` can be {one} and {two}, or all that was measured before"
                self.diagnostics.refuse("ambiguous-pronoun", message, noun.span, "name them")
            if not noun.or_one:
                return both
            message = f"`{said}` can be {two}, or both {one} and {two}"
            self.diagnostics.refuse("ambiguous-pronoun", message, noun.span, "name them")
        if len(last) == 1 or noun.every:
            return list(last)
        self._ambiguous("ambiguous-pronoun", noun, last)

    def _counted(self, noun: Pronoun, count: int) -> list[CheckpointInfo]:
        """`The same four`: as many were measured last, one or two of them at a time or in all."""
        memory = self.memory
        for found in (memory.last, (*memory.before, *memory.last), (*memory.so_far.values(),)):
            alike = all(noun.kind is None or agrees(c, noun.kind) for c in found)
            if len({c.id for c in found}) == len(found) == count and alike and not noun.either:
                return list(found)
        self._ambiguous("ambiguous-pronoun", noun, list(memory.so_far.values()))

    def _ambiguous(self, code: str, noun: Noun, found: Sequence[CheckpointInfo]) -> NoReturn:
        said = self.diagnostics.source.said(noun.span)
        message = f"`{said}` can be {listed(map(told, found[:_SHOWN]), 'or')}"
        self.diagnostics.refuse(code, message, noun.span, "name one of them")

    def _nothing_before(self, span: Span) -> NoReturn:
        message = "nothing is measured before this, so it does not refer to a checkpoint"
        self._refuse_missing(message, span, "name it: `checkpoint #1`")

    def _refuse_missing(self, message: str, span: Span, hint: str) -> NoReturn:
        """Refuse what means no checkpoint; without a word if one may not be understood."""
        if not self.memory.known:
            raise RefusedError
        self.diagnostics.refuse("which-checkpoint", message, span, hint)


def _is_the_one(noun: Noun) -> TypeGuard[TheOne]:
    return isinstance(noun, TheOne) and not noun.plural and not noun.floors


def _inheriting(nouns: Iterable[Noun]) -> Iterator[tuple[Noun, Kind | None, bool]]:
    """Each with the kind that it has from those before it, and whether that is in the plural."""
    kind: Kind | None = None
    plural = False
    for noun in nouns:
        if isinstance(noun, Labelled) and noun.kind is not None:
            kind, plural = noun.kind, noun.plural
        yield noun, kind, plural
