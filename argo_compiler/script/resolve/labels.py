"""Which checkpoints a label means: `#4`, `valve R25`, `gauges 1 to 5`."""

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.listing import listed
from argo_compiler.diagnostics import Span
from argo_compiler.script.resolve.lookup import Lookup, agrees, told
from argo_compiler.script.syntax.text.source import Diagnostics
from argo_compiler.script.syntax.tree.nouns import Kind, Labelled


class LabelResolver:
    """Looks labels up. Raises RefusedError where it is not clear what is meant."""

    def __init__(self, lookup: Lookup, diagnostics: Diagnostics) -> None:
        self.lookup = lookup
        self.diagnostics = diagnostics

    def named(self, noun: Labelled, kind: Kind | None, plural: bool) -> list[CheckpointInfo]:
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
        if not isinstance(first, int) or not isinstance(last, int):
            message = "a range goes from a number to a number"
            self.diagnostics.refuse("range", message, noun.span, "name each of them")
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
        if noun.kind is None and not plural and isinstance(label, int):
            return self._inherited(noun, label, kind)
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
            message = (
                f"`{kind} #{number}` can be read as {listed(map(told, readings.values()), 'or')}"
            )
            hint = f"write `checkpoint {number}` or `{kind} {number}`"
            self.diagnostics.refuse("ambiguous-checkpoint", message, span, hint)
        found = self.lookup.numbered(number, span)
        message = f"checkpoint #{number} is {found.name}, and there is no {kind} {number}"
        self.diagnostics.refuse("checkpoint-mismatch", message, span, "name the one")

    def _inherited(self, noun: Labelled, label: int, kind: Kind | None) -> CheckpointInfo:
        """`valve R25 and 5`: a number behind one of a kind may be a name or a number."""
        named = self.lookup.called(str(label), kind)
        numbered = self.lookup.by_number.get(label)
        readings = list(map(told, named))
        if numbered is not None and numbered not in named:
            readings.append(f"checkpoint #{label} ({numbered.name})")
        if not readings:
            return self.lookup.numbered(label, noun.span)
        message = f"`{label}` can be read as {listed(readings, 'or')}"
        hint = f"write `checkpoint {label}` or `{kind} {label}`"
        self.diagnostics.refuse("ambiguous-checkpoint", message, noun.span, hint)
