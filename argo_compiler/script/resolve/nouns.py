"""Which checkpoints a noun phrase means; what can be read in two ways is asked about."""

from collections.abc import Sequence
from dataclasses import replace

from argo_compiler.catalog import CheckpointInfo
from argo_compiler.diagnostics import Span
from argo_compiler.listing import listed
from argo_compiler.script.resolve.lookup import Lookup, agrees
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.nouns import (
    AllOf,
    Kind,
    Labelled,
    Noun,
    Nouns,
    Pronoun,
    TheOne,
)
from argo_compiler.script.syntax.tree.places import FloorName

Found = list[CheckpointInfo] | None
"""None: it is not clear which, and an error says so"""


class Memory:
    """What pronouns may mean: what was measured by the last order that measured."""

    def __init__(self) -> None:
        self.last: tuple[CheckpointInfo, ...] = ()
        self.before: tuple[CheckpointInfo, ...] = ()
        self.measured_ids: set[int] = set()
        self.known = True
        """whether all that was ordered so far is understood"""

    def measured(self, checkpoints: tuple[CheckpointInfo, ...]) -> None:
        if checkpoints:
            self.before, self.last = self.last, checkpoints
            self.measured_ids.update(c.id for c in checkpoints)


class NounResolver:
    """Looks noun phrases up."""

    def __init__(self, lookup: Lookup, diagnostics: Diagnostics, memory: Memory) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics
        self.memory = memory

    def all(self, nouns: Nouns) -> Found:
        """The checkpoints of a list, in its order, each as often as it is named."""
        if nouns.either:
            said = self.said(nouns.span)
            message = f"`{said}` leaves open which of them, or whether both"
            hint = "write `and` for all of them, or name the one that is meant"
            self.diagnostics.error("ambiguous-or", message, nouns.span, hint)
            return None
        return self.each(nouns)

    def on(self, floors: Sequence[FloorName], nouns: Nouns) -> Nouns:
        """The phrase, of what is on these floors; a floor that it names itself has to be one."""
        placed: list[Noun] = []
        for noun in nouns.nouns:
            if isinstance(noun, Pronoun) or noun.floors:
                own = () if isinstance(noun, Pronoun) else noun.floors
                if not own or not {f.number for f in own} <= {f.number for f in floors}:
                    message = f"`{self.said(noun.span)}` is said to be on another floor as well"
                    hint = "leave one of the two floors out"
                    self.diagnostics.error("ambiguous-floor", message, noun.span, hint)
                placed.append(noun)
            else:
                placed.append(replace(noun, floors=tuple(floors)))
        return replace(nouns, nouns=tuple(placed))

    def each(self, nouns: Nouns) -> Found:
        """As `all`, for lists joined by `or` as well."""
        found: list[CheckpointInfo] = []
        clear = True
        kind: Kind | None = None
        plural = False
        for noun in nouns.nouns:
            if isinstance(noun, Labelled) and noun.kind is not None:
                kind, plural = noun.kind, noun.plural
            one = self._noun(noun, kind, plural)
            clear = clear and one is not None
            found += one or []
        if nouns.but:
            return self._without(found, nouns) if clear else None
        return found if clear else None

    def one(self, nouns: Nouns) -> CheckpointInfo | None:
        """The only checkpoint of a phrase."""
        found = self.each(nouns)
        if found is None:
            return None
        if len(found) == 1:
            return found[0]
        message = "this has to be one checkpoint"
        self.diagnostics.error("one-checkpoint", message, nouns.span, "name one of them")
        return None

    def last(self, span: Span) -> Found:
        """What was measured last, where a condition names nothing."""
        return self._pronoun(Pronoun(span=span))

    def _without(self, found: list[CheckpointInfo], nouns: Nouns) -> Found:
        """What is left of them; `the valve` is one of theirs."""
        out: list[CheckpointInfo] = []
        kind: Kind | None = None
        for noun in nouns.but:
            kind = noun.kind or kind if isinstance(noun, Labelled) else kind
            inside = [c for c in found if agrees(c, noun.kind)] if isinstance(noun, TheOne) else []
            one = inside if _is_told(noun, inside) else self._noun(noun, kind, plural=True)
            if one is None:
                return None
            for checkpoint in one:
                if checkpoint not in found:
                    message = f"{checkpoint.name} (#{checkpoint.id}) is none of these anyway"
                    hint = "is another one meant?"
                    self.diagnostics.warning("needless-exception", message, noun.span, hint)
            out += one
        left = [checkpoint for checkpoint in found if checkpoint not in out]
        if not left:
            message = f"`{self.said(nouns.span)}` leaves no checkpoint"
            self.diagnostics.error("no-checkpoint", message, nouns.span, "name those that are left")
        return left or None

    def _noun(self, noun: Noun, kind: Kind | None, plural: bool) -> Found:
        match noun:
            case Labelled():
                return self._named(noun, kind, plural)
            case AllOf():
                return self._of_kind(noun)
            case TheOne():
                return self._the_one(noun)
            case Pronoun():
                return self._pronoun(noun)

    # ---- by a label

    def _named(self, noun: Labelled, kind: Kind | None, plural: bool) -> Found:
        if noun.last is not None:
            return self._range(noun, kind)
        found = self._labelled(noun, noun.label, kind, plural)
        if found is not None and noun.also is not None:
            other = self._labelled(noun.also, noun.also.label, noun.also.kind, False)
            if other is None:
                return None
            if other is not found:
                message = (
                    f"checkpoint #{found.id} is {found.name}, and {other.name} is "
                    f"checkpoint #{other.id}"
                )
                hint = "correct the number or the name"
                self.diagnostics.error("checkpoint-mismatch", message, noun.also.span, hint)
                return None
        if found is not None and not self._lies_there(found, noun):
            return None
        if found is not None:
            self.lookup.check_quantity(found, noun.quantity, noun.span)
            if noun.also is not None:
                self.lookup.check_quantity(found, noun.also.quantity, noun.also.span)
        return None if found is None else [found]

    def _range(self, noun: Labelled, kind: Kind | None) -> Found:
        first, last = noun.label, noun.last
        if not isinstance(first, int) or not isinstance(last, int):
            message = "a range goes from a number to a number"
            self.diagnostics.error("range", message, noun.span, "name each of them")
            return None
        if first > last:
            message = "this range of checkpoints is empty"
            hint = "write the lower number first"
            self.diagnostics.error("empty-range", message, noun.span, hint)
            return None
        found: list[CheckpointInfo] = []
        for number in range(first, last + 1):
            one = self._labelled(noun, number, kind, True)
            if one is None or not self._lies_there(one, noun):
                return None
            found.append(one)
        return found

    def _lies_there(self, found: CheckpointInfo, noun: Labelled) -> bool:
        """Whether a checkpoint is on the floor that is said."""
        floors = self._floors(noun.floors)
        if floors is None or (floors and found.floor not in floors):
            if floors:
                where = f"on floor {found.floor}, not on floor {listed(map(str, floors), 'or')}"
                message = f"{found.name} (#{found.id}) is {where}"
                hint = "correct the floor or the name"
                self.diagnostics.error("checkpoint-mismatch", message, noun.span, hint)
            return False
        return True

    def _floors(self, named: Sequence[FloorName]) -> list[int] | None:
        """The numbers of floors; None if there is one that is not there."""
        found = [floor.number for f in named if (floor := self.lookup.floor(f)) is not None]
        return None if len(found) < len(named) else found

    def _labelled(
        self, noun: Labelled, label: int | str, kind: Kind | None, plural: bool
    ) -> CheckpointInfo | None:
        if noun.hash or kind in (None, Kind.CHECKPOINT):
            numbered = kind not in (None, Kind.CHECKPOINT) and (noun.kind or plural)
            if isinstance(label, int) and kind is not None and numbered:
                return self.lookup.numbered_of_kind(label, kind, noun.span)
            if isinstance(label, int):
                return self.lookup.numbered(label, noun.span)
            return self.lookup.identified(label, noun.kind, noun.span)
        if noun.kind is None and not plural and isinstance(label, int):
            return self._inherited(noun, label, kind)
        return self.lookup.identified(str(label), kind, noun.span)

    def _inherited(self, noun: Labelled, label: int, kind: Kind | None) -> CheckpointInfo | None:
        """`valve R25 and 5`: a number behind one of a kind may be a name or a number."""
        named = self.lookup.called(str(label), kind)
        numbered = self.lookup.by_number.get(label)
        readings = [f"{c.name} (#{c.id})" for c in named]
        if numbered is not None and numbered not in named:
            readings.append(f"checkpoint #{label} ({numbered.name})")
        message = f"`{label}` can be read as {listed(readings, 'or')}"
        if not readings:
            return self.lookup.numbered(label, noun.span)
        hint = f"write `checkpoint {label}` or `{kind} {label}`"
        self.diagnostics.error("ambiguous-checkpoint", message, noun.span, hint)
        return None

    # ---- by kind, floor and what came before

    def _of_kind(self, noun: AllOf) -> Found:
        floors = self._floors(noun.floors)
        if floors is None:
            return None
        found = self.lookup.of_kind(noun.kind, floors)
        if not found:
            where = f" on floor {listed(map(str, floors), 'or')}" if floors else ""
            message = f"there is no {noun.kind}{where} on {self.lookup.catalog.site}"
            self.diagnostics.error("unknown-checkpoint", message, noun.span, "name another floor")
            return None
        if noun.count is not None and noun.count != len(found):
            names = listed(f"{c.name} (#{c.id})" for c in found[:6])
            message = f"`{self.said(noun.span)}`: there are {len(found)}, {names}"
            self.diagnostics.error("ambiguous-checkpoint", message, noun.span, "name them")
            return None
        return found

    def _the_one(self, noun: TheOne) -> Found:
        last = [c for c in self.memory.last if agrees(c, noun.kind)]
        if noun.plural:
            everything = AllOf(span=noun.span, kind=noun.kind, floors=noun.floors)
            return last if len(last) > 1 and not noun.floors else self._of_kind(everything)
        if not noun.floors and len(last) == 1:
            return last
        if not noun.floors and not last:
            self._nothing_before(noun.span)
            return None
        found = self._of_kind(AllOf(span=noun.span, kind=noun.kind, floors=noun.floors))
        if found is None or len(found) == 1:
            return found
        names = listed((f"{c.name} (#{c.id})" for c in (last or found)[:6]), "or")
        message = f"`{self.said(noun.span)}` can be {names}"
        self.diagnostics.error("ambiguous-checkpoint", message, noun.span, "name the one")
        return None

    def _pronoun(self, noun: Pronoun) -> Found:
        last = self.memory.last
        if not last:
            self._nothing_before(noun.span)
            return None
        if noun.every and len(last) == len(self.memory.before) == 1:
            both = [*self.memory.before, *last]
            if not noun.or_one:
                return both
            one, two = (f"{c.name} (#{c.id})" for c in both)
            message = f"`{self.said(noun.span)}` can be {two}, or both {one} and {two}"
            self.diagnostics.error("ambiguous-pronoun", message, noun.span, "name them")
            return None
        if len(last) == 1 or noun.every:
            return list(last)
        names = listed((f"{c.name} (#{c.id})" for c in last[:6]), "or")
        message = f"`{self.said(noun.span)}` can be {names}"
        self.diagnostics.error("ambiguous-pronoun", message, noun.span, "name the one")
        return None

    def _nothing_before(self, span: Span) -> None:
        if self.memory.known:
            message = "nothing has been measured before this, so it does not say which checkpoint"
            hint = "name it: `checkpoint #1`"
            self.diagnostics.error("which-checkpoint", message, span, hint)

    def said(self, first: Span, last: Span | None = None) -> str:
        """The words of the script from the beginning of one span to the end of the other."""
        line = self.diagnostics.source.lines[first.line - 1]
        end = last if last is not None and last.line == first.line else first
        return line[first.column - 1 : end.column - 1 + end.length]


def _is_told(noun: Noun, inside: list[CheckpointInfo]) -> bool:
    """Whether a phrase without a name tells which of these are meant."""
    if not isinstance(noun, TheOne) or noun.floors:
        return False
    return bool(inside) if noun.plural else len(inside) == 1
