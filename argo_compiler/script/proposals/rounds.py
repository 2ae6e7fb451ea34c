"""Choices of a text that counts rounds: `2 rounds, 30 min start to start`."""

from collections.abc import Iterator
from itertools import pairwise

from argo_compiler.script.documents.signs import CLOCK
from argo_compiler.script.proposals.frames import Sentences
from argo_compiler.script.proposals.open_text import OpenText
from argo_compiler.script.sentences.words.amounts import Length

_DAY_MIN = 24 * 60


def by_rounds(of: OpenText) -> Iterator[Sentences]:
    """Yield what a text asks for that counts rounds: `2 rounds, 30 min start to start`."""
    if of.found.has("checkpoints") or (of.found.has("pronoun") and of.found.has("MEASURE")):
        return  # `read it twice`
    counts = of.counts("TIMES")
    lengths = [*filter(None, of.lengths("DURATION"))]
    clocks = [60 * int(m["hour"]) + int(m["minute"]) for m in CLOCK.finditer(of.text.content)]
    gaps = [(b - a) % _DAY_MIN for a, b in pairwise(clocks)]
    every = [
        m.value.seconds / 60
        for m in of.found.of("DURATION")
        if isinstance(m.value, Length) and m.value.other is None
    ]
    if len(gaps) == len(every) == 1 and every[0] > 0 and gaps[0] % every[0] == 0:
        counts = [*counts, int(gaps[0] / every[0]) + 1]  # `every hour, from 8:00 to 11:00`
    elif gaps and len({*gaps}) == 1 and gaps[0] > 0:
        yield (f"Repeat everything every {gaps[0]} minutes, {len(clocks)} times.",)
    for count in (c for c in counts if c is not None and c > 1):
        for length in lengths:
            spaced = f"Repeat everything every {length}, {count} times."
            paused = f"Repeat everything {count} times, with a wait of {length} in between."
            yield from ((a,) for a in ((paused, spaced) if _pauses(of) else (spaced, paused)))
        yield (f"Repeat everything {count} times.",)


def _pauses(of: OpenText) -> bool:
    return of.found.has("IN_BETWEEN", "PAUSE", "PAUSE_OF", "WAIT", "later")
