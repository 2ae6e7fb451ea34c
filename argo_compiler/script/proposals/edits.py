"""Choices of a text that changes the list above, or takes something of its own back."""

from collections.abc import Iterator, Sequence

from argo_compiler.script.documents.signs import CLOCK
from argo_compiler.script.proposals.demands import LEAVING_OUT
from argo_compiler.script.proposals.frames import Sentences
from argo_compiler.script.proposals.known import is_number
from argo_compiler.script.proposals.open_text import OpenText
from argo_compiler.script.sentences.words.numbers import Figure

_REPLACING = ("correction", "in_place_of", "NOT", "forbidding", "leave_out", "DELETE", "past")
"""kinds of mentions with which one checkpoint may take the place of another"""
_BOTH = 2
_NEAR = 2
"""characters between a denial and its number"""


def by_corrections(of: OpenText) -> Iterator[Sentences]:
    """Yield the checkpoints without those that are taken back: `R12 - wait, not R12, R31`."""
    demands = of.demands
    denied = of.found.has("NOT", "forbidding") and not of.found.has(*LEAVING_OUT)
    if denied and demands.spared and demands.asked and "IF" not in of.types:
        yield (f"Check {of.words_of(demands.asked)}.",)


def by_leaving_out(of: OpenText) -> Iterator[Sentences]:
    """Yield what a text leaves out, and what it has read instead: `no need for R12 but do R7`."""
    demands = of.demands
    if not demands.spared or demands.conditional:
        return
    asked = [id for id in demands.asked if id not in of.above]
    both = of.found.has("BUT", "MEASURE", "REPEAT", "in_place_of", "correction", "EXCEPT")
    ids = [c.id for mention in of.found.of("checkpoints") for c in of.named_by(mention)]
    both = (
        both or not of.found.unknown or any(ids.count(id) > 1 for id in demands.spared)
    )  # `R7 and R12 - skip R12`
    checks = [f"Check {of.words_of(asked)}."] if asked and both else []
    yield (*of.leaving_out(demands.spared), *checks)


def by_sequence(of: OpenText) -> Iterator[Sentences]:
    """Yield the order that a text has: `R31 only after R7`, `R7 not before R31`."""
    demands = of.demands
    for first, second in () if demands.spaced else demands.sequences:
        if first in of.above:
            verb = "Move" if second in of.above else "Add"
            yield (f"{verb} checkpoint {second} after checkpoint {first}.",)
        elif second in of.above:
            yield (f"Add checkpoint {first} before checkpoint {second}.",)
        elif {*demands.asked} == {first, second}:
            yield (f"Check checkpoint {first}.", f"Check checkpoint {second}.")


def by_swaps(of: OpenText) -> Iterator[Sentences]:
    """Yield how two of those above change places: `steps 2 and 3 are swapped`."""
    named = [id for id in dict.fromkeys(_named(of)) if id in of.above]
    both = of.found.has("pronoun", "BOTH") or of.counts("NUMBER") == [_BOTH]
    if not named and both and of.found.only("swapping", "pronoun", "BOTH", "NUMBER", "MEASURE"):
        named = [*of.above[-_BOTH:]]  # `swap the two`
    if not of.demands.swaps or len(named) != _BOTH:
        return
    first, second = sorted(named, key=of.above.index)
    before_second = of.above[of.above.index(second) - 1]
    moves = [f"Move checkpoint {second} before checkpoint {first}."]
    if before_second != first:
        moves.append(f"Move checkpoint {first} after checkpoint {before_second}.")
    yield tuple(moves)


def by_numbers(of: OpenText) -> Iterator[Sentences]:
    """Yield what takes the place of the checkpoint that was named last, if both are named by their
    numbers alone: `number two, not three`."""
    last = of.composer.known.last_named or next(iter(of.composer.known.memory.last[-1:]), None)
    denials = of.found.of("NOT", "forbidding", "in_place_of")
    if last is None or last.id not in of.above or not denials:
        return
    alike = {
        c.name.split()[-1]: c.id
        for c in of.composer.known.catalog.checkpoints
        if c.kind is last.kind
    }
    numbers = [
        (word.start, str(word.value.whole))
        for word in of.composer.understanding.words(of.text)
        if isinstance(word.value, Figure)
    ]
    others = [m for m in of.found.of("checkpoints") if not is_number(m)]
    names = [name for _, name in numbers]
    if others or len(names) != _BOTH or not {*names} <= alike.keys():
        return
    denied = [name for at, name in numbers if any(0 <= at - m.end <= _NEAR for m in denials)]
    if len(denied) == 1 and alike[denied[0]] == last.id:
        new = next(name for name in names if name != denied[0])
        yield (f"Replace checkpoint {last.id} by checkpoint {alike[new]}.",)


def _named(of: OpenText) -> list[int]:
    """Return the checkpoints that a text names, also by the numbers of their items."""
    named = [c.id for mention in of.found.of("checkpoints") for c in of.named_by(mention)]
    items = of.composer.known.items
    numbers = [of.text.content[m.start : m.end] for m in of.found.of("NUMBER")]
    return [*named, *(items[number] for number in numbers if number in items)]


def by_edits(of: OpenText) -> Iterator[Sentences]:
    """Yield how a text changes what stands above: `before all that, R25`, `item 5 comes first`,
    `R12 is wrong, it is R25`."""
    known, above = of.composer.known, of.above
    ids = [*dict.fromkeys(_named(of))]
    timed = of.found.has("DURATION", "SPAN", "EARLIEST") or CLOCK.search(of.text.content)
    if not ids or not above or timed or of.found.has("again", "MORE"):
        return  # `not before 11:00`
    id, others = ids[0], [one for one in ids[1:] if one in above]
    verb = "Move" if id in above else "Add"
    yield from _beside(of, f"{verb} checkpoint {id}", [one for one in others if one != id])
    begins = of.found.has("first", "AT_BEGIN") or (
        of.found.has("BEFORE") and not of.demands.sequences
    )
    if begins and id != above[0]:
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
