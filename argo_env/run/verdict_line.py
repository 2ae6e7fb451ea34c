"""The headline of a run: the same words on the terminal, in reports, recordings and films.

It begins with how the run ended, and goes on with the verdict, which `result.py` finds. Its colour
on the terminal is chosen in `argo_planner/terminal/record_tables.py`.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from enum import StrEnum

from argo_compiler.base.model import Model

AS_PLANNED = "everything was done as planned"
"""the verdict of a success of which there is nothing more to say"""
_NAMED = 3  # of the things to look at, at most; the others are counted


class Tone(StrEnum):
    """What a headline asks of its reader."""

    GOOD = "good"
    """nothing: all is as it should be"""
    NOTICE = "notice"
    """to look at what was noticed or what failed, though the mission came to its end; or to let the
    run go on"""
    BAD = "bad"
    """the mission is no success"""


class Headline(Model):
    """How a run went, in a line."""

    word: str
    """`Success`, `No success`, `Completed with failures`, `Interrupted`, or such as
    `Done, 2 findings`"""
    text: str
    """the rest, without a full stop"""
    tone: Tone

    def __str__(self) -> str:
        return f"{self.word}: {self.text}."


def headline(
    verdict: str,
    *,
    success: bool,
    ended: bool,
    only_failures: bool,
    noticed: Mapping[str, Sequence[str]],
) -> Headline:
    """Return the headline of a run with this result.

    `noticed`: what was found, touched and slipped, in words, each thing once, by what it is called.
    """
    counts = ", ".join(
        f"{len(things)} {name}{'s' if len(things) > 1 else ''}"
        for name, things in noticed.items()
        if things
    )
    said = _first([what for things in noticed.values() for what in things])
    if not success:
        word, tone = ("No success", Tone.BAD) if ended else ("Interrupted", Tone.NOTICE)
        if only_failures:
            word, tone = "Completed with failures", Tone.NOTICE
        text = f"{verdict}. {counts}: {said}" if counts else verdict
        return Headline(word=word, text=text, tone=tone)
    if not counts:
        return Headline(word="Success", text=verdict, tone=Tone.GOOD)
    if verdict != AS_PLANNED:
        said += f". {verdict[:1].upper()}{verdict[1:]}"
    return Headline(word=f"Done, {counts}", text=said, tone=Tone.NOTICE)


def _first(said: Sequence[str]) -> str:
    """Return the things to look at in one line; of many the first."""
    times = list(Counter(said).items())
    named = [what if n == 1 else f"{what}, {n} times" for what, n in times[:_NAMED]]
    more = sum(n for _, n in times[_NAMED:])
    return "; ".join([*named, *([f"and {more} more"] if more else [])])
