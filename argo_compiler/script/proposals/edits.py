"""Choices of a text that changes the list above, or takes something of its own back."""

from collections.abc import Iterator, Sequence

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.script.documents.signs import CLOCK
from argo_compiler.script.proposals.frames import Sentences
from argo_compiler.script.proposals.mentions import checkpoint_words
from argo_compiler.script.proposals.open_text import OpenText

_REPLACING = ("correction", "in_place_of", "NOT", "forbidding", "leave_out", "DELETE", "past")
"""kinds of mentions with which one checkpoint may take the place of another"""


def by_corrections(of: OpenText) -> Iterator[Sentences]:
    """Yield the checkpoints without those that are taken back: `R12 - wait, not R12, R31`."""
    named: list[CheckpointInfo] = []
    taken_back: set[int] = set()
    for mention in of.found.of("checkpoints"):
        checkpoints = of.named_by(mention)
        before = [m for m in of.found.of("NOT", "forbidding") if m.end <= mention.start]
        if before and not of.text.content[before[-1].end : mention.start].strip():
            again = {c.id for c in checkpoints} & {c.id for c in named}
            taken_back |= again or {c.id for c in checkpoints}
        named += checkpoints
    left = {c.id: c for c in named if c.id not in taken_back}
    if taken_back and left and "IF" not in of.types:
        yield (f"Check {checkpoint_words(list(left.values()))}.",)


def by_edits(of: OpenText) -> Iterator[Sentences]:
    """Yield how a text changes what stands above: `before all that, R25`, `item 5 comes first`,
    `R12 is wrong, it is R25`."""
    known, above = of.composer.known, of.above
    named = [c.id for mention in of.found.of("checkpoints") for c in of.named_by(mention)]
    items = [known.items.get(of.text.content[m.start : m.end]) for m in of.found.of("NUMBER")]
    ids = [*dict.fromkeys([*named, *(id for id in items if id is not None)])]
    timed = of.found.has("DURATION", "SPAN", "EARLIEST") or CLOCK.search(of.text.content)
    if not ids or not above or timed or of.found.has("again", "MORE"):
        return  # `not before 11:00`
    id, others = ids[0], [one for one in ids[1:] if one in above]
    verb = "Move" if id in above else "Add"
    yield from _beside(of, f"{verb} checkpoint {id}", [one for one in others if one != id])
    if of.found.has("BEFORE", "first", "AT_BEGIN") and id != above[0]:
        yield (f"{verb} checkpoint {id} before checkpoint {above[0]}.",)
    if of.found.has("pronoun") and not others and not of.found.has("BETWEEN"):
        last = [c.id for c in known.memory.last[:1] if c.id != id]
        yield from _beside(of, f"{verb} checkpoint {id}", last)
    if of.found.has("last", "AT_END") and id != above[-1]:
        yield (f"{verb} checkpoint {id} after checkpoint {above[-1]}.",)
    old = [one for one in ids if one in above]
    new = [one for one in ids if one not in above]
    if len(old) == len(new) == 1 and of.found.has(*_REPLACING):
        yield (f"Replace checkpoint {old[0]} by checkpoint {new[0]}.",)


def _beside(of: OpenText, change: str, others: Sequence[int]) -> Iterator[Sentences]:
    """Yield a change that puts a checkpoint before or after the first of others."""
    for kind, side in (("BEFORE", "before"), ("AFTER", "after"), ("BETWEEN", "after")):
        if of.found.has(kind) and others:
            yield (f"{change} {side} checkpoint {others[0]}.",)
