"""Record of what a script has named, measured and left out, by which later lines are proposed."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import pairwise

from argo_compiler.base.catalog import Catalog, CheckpointInfo
from argo_compiler.script.documents.source import Diagnostics, RefusedError
from argo_compiler.script.proposals.mentions import Mention
from argo_compiler.script.resolve.lookup import Lookup, agrees
from argo_compiler.script.resolve.nouns import Memory, NounResolver
from argo_compiler.script.sentences.tree.nouns import Kind, Labelled, Nouns
from argo_compiler.script.sentences.tree.places import FloorName
from argo_compiler.script.sentences.understanding import Understanding

_SIDE_BY_SIDE = 3
"""characters between number and name of one checkpoint: `#8 - pressure gauge 5`"""
_NO_STATE = frozenset(["understanding", "catalog", "names", "_lookup", "warnings"])
"""attributes that do not change, or that each proposal begins anew"""
State = tuple[Memory, CheckpointInfo | None, set[int], set[int], set[int]]


class Known:
    """Record of checkpoints and readings of the pieces so far. Mutable: each piece adds to it."""

    def __init__(self, understanding: Understanding, catalog: Catalog) -> None:
        self.understanding = understanding
        self.catalog = catalog
        self.names = frozenset(w for c in catalog.checkpoints for w in c.name.lower().split())
        """words of the names of checkpoints"""
        self._lookup = Lookup(catalog, understanding.diagnostics, None, None)
        self.memory = Memory()
        self.last_named: CheckpointInfo | None = None
        """what a text named last, also if it left it out; None if that is no single one"""
        self.excepted: set[int] = set()
        """the checkpoints that a list names as its exceptions"""
        self.asked: set[int] = set()
        """the checkpoints that lines of the script ask for that need no proposal"""
        self.deleted: set[int] = set()
        """the checkpoints that were asked for and taken back"""
        self.spared: set[int] = set()
        """the checkpoints that are to be left out"""
        self.listed: Kind | None = None
        """the kind of the points in the rows below a heading: `PRESSURE GAUGES (bar)`"""
        self.section: Mention | None = None
        """the floor of the rows below a heading that names no more than that"""
        self.items: dict[str, int] = {}
        """the checkpoints of numbered items and rows, by their numbers"""
        self.warnings: list[str] = []
        """what the names of checkpoints were warned of: `a valve has no pressure`"""
        self.start_area: int | None = None
        """where the mission starts, if that is known"""

    def state(self) -> State:
        """Return what `reset` goes back to."""
        return (
            self.memory.copy(),
            self.last_named,
            {*self.excepted},
            {*self.deleted},
            {*self.spared},
        )

    def reset(self, state: State) -> None:
        """Forget what was measured and left out since a state."""
        self.memory, self.last_named, self.excepted, self.deleted, self.spared = state

    def fingerprint(self) -> tuple[object, ...]:
        """Return a value that is the same as long as a text would be proposed the same."""
        state = (value for name, value in vars(self).items() if name not in _NO_STATE)
        return tuple(map(_hashable, state))

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Forget at the end what was measured and left out since the beginning."""
        before = self.state()
        try:
            yield
        finally:
            self.reset(before)

    def measured(self, checkpoints: Sequence[CheckpointInfo]) -> None:
        """Remember what was measured, as an earlier line says."""
        self.memory.measured(checkpoints)

    def checkpoints(self, mentions: Sequence[Mention]) -> list[CheckpointInfo]:
        """Return the checkpoints that parts of a text name; number and name of one point, side by
        side, are one. Raises RefusedError if that is not clear."""
        resolver = self.resolver()
        found: list[CheckpointInfo] = []
        for mention in mentions:
            assert isinstance(mention.value, Nouns)
            nouns = mention.value
            found += [c for c in resolver.all(nouns) if c not in found[-1:]]
            excepted = resolver.each(replace(nouns, nouns=nouns.but, but=())) if nouns.but else []
            self.excepted |= {c.id for c in excepted}
            last = (*nouns.nouns, *nouns.but)[-1]
            self.warnings += [d.message for d in resolver.diagnostics.entries]
            resolver.diagnostics.entries.clear()
            self.last_named = [*found, *excepted][-1] if isinstance(last, Labelled) else None
        return found

    def disagreement(self, mentions: Sequence[Mention]) -> str:
        """Return how number and name differ that stand side by side: `#10 valve R7`; empty if none
        do."""
        for first, second in pairwise(mentions):
            by_number = [is_number(first), is_number(second)]
            if second.start - first.end > _SIDE_BY_SIDE or by_number[0] == by_number[1]:
                continue
            with suppress(RefusedError):
                a, b = (self.checkpoints([mention]) for mention in (first, second))
                if len(a) == len(b) == 1 and a != b:
                    one, other = (a[0], b[0]) if by_number[0] else (b[0], a[0])
                    return (
                        f"checkpoint #{one.id} is {one.name}, and {other.name} is checkpoint "
                        f"#{other.id}"
                    )
        return ""

    def of_list(self, checkpoint: CheckpointInfo) -> Sequence[CheckpointInfo]:
        """Return what `no. 4` means in a row below a heading, if that names a kind: the one with
        this name, and the one with this number if it is of the kind as well."""
        if self.listed is None:
            return [checkpoint]
        named = [
            c
            for c in self.catalog.checkpoints
            if agrees(c, self.listed) and c.name.endswith(f" {checkpoint.id}")
        ]
        own = [checkpoint] if agrees(checkpoint, self.listed) or not named else []
        return [*named, *(c for c in own if c not in named)]

    def alike(self, mention: Mention) -> list[CheckpointInfo]:
        """Return the checkpoints that unclear words may stand for: `gauge 8`, by name and by
        number; `R40 or R9`."""
        nouns = mention.value
        if not isinstance(nouns, Nouns):
            return []
        if nouns.either:  # `R40 or R9`
            with suppress(RefusedError):
                return self.resolver().each(nouns)
        noun = nouns.nouns[0] if len(nouns.nouns) == 1 else None
        if isinstance(noun, Labelled) and noun.also is not None:  # `checkpoint #7: gauge 7`
            apart = replace(nouns, nouns=(replace(noun, also=None), noun.also))
            with suppress(RefusedError):
                return self.resolver().each(apart)
        if not isinstance(noun, Labelled) or noun.kind is None:
            return []
        return [
            c
            for c in self.catalog.checkpoints
            if agrees(c, noun.kind)
            and (c.id == noun.label or c.name.lower().endswith(f" {noun.label}".lower()))
        ]

    def floors(self, floors: Sequence[FloorName]) -> set[int]:
        """Return the numbers of floors. Raises RefusedError if one is not on the site."""
        return {*self.resolver().lookup.numbers(floors)}

    def resolver(self) -> NounResolver:
        """Return what looks nouns up; its messages go nowhere."""
        diagnostics = Diagnostics(self.understanding.diagnostics.source)
        return NounResolver(self._lookup.anew(diagnostics), diagnostics, self.memory)


def _hashable(value: object) -> object:
    """Return a value that is equal for equal parts of what is known."""
    match value:
        case Memory():
            named = [tuple([c.id for c in some]) for some in (value.last, value.before)]
            return (*named, tuple(value.so_far), value.known)
        case CheckpointInfo():
            return value.id
        case set():
            return frozenset(value)
        case dict():
            return tuple(value.items())
    return value


def is_number(mention: Mention) -> bool:
    """Return True for a checkpoint by its number: `#10`, `checkpoint 10`."""
    return all(
        isinstance(noun, Labelled) and (noun.hash or noun.kind is Kind.CHECKPOINT)
        for noun in mention.nouns
    )
