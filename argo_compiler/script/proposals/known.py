"""Record of what a script has named, measured and left out, by which later lines are proposed."""

from collections.abc import Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace

from argo_compiler.base.catalog import Catalog, CheckpointInfo
from argo_compiler.script.documents.source import Diagnostics, RefusedError
from argo_compiler.script.proposals.mentions import Mention
from argo_compiler.script.resolve.lookup import Lookup, agrees
from argo_compiler.script.resolve.nouns import Memory, NounResolver
from argo_compiler.script.sentences.tree.nouns import Labelled, Nouns
from argo_compiler.script.sentences.tree.places import FloorName
from argo_compiler.script.sentences.understanding import Understanding

State = tuple[Memory, CheckpointInfo | None, set[int], set[int], set[int]]


class Known:
    """Record of checkpoints and readings of the pieces so far. Mutable: each piece adds to it."""

    def __init__(self, understanding: Understanding, catalog: Catalog) -> None:
        self.understanding = understanding
        self.catalog = catalog
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
        self.start_area: int | None = None
        """where the mission starts, if that is known"""

    def state(self) -> State:
        """Return what `reset` goes back to."""
        memory = copy(self.memory)
        memory.so_far = dict(memory.so_far)
        return memory, self.last_named, {*self.excepted}, {*self.deleted}, {*self.spared}

    def reset(self, state: State) -> None:
        """Forget what was measured and left out since a state."""
        self.memory, self.last_named, self.excepted, self.deleted, self.spared = state

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
            self.last_named = [*found, *excepted][-1] if isinstance(last, Labelled) else None
        return found

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
        lookup = Lookup(self.catalog, diagnostics, None, None)
        return NounResolver(lookup, diagnostics, self.memory)
