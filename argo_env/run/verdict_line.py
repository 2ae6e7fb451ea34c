"""Headline of a run: the same words on the terminal, in reports, recordings and films.

It begins with how the run ended, and continues with the verdict from `result.py`.
`argo_planner/terminal/record_tables.py` chooses its colour on the terminal.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from enum import StrEnum

from argo_compiler.base.model import Model

AS_PLANNED = "everything was done as planned"
"""verdict of a success without anything to add"""
_NAMED = 3  # noticed things that are named at most; the others are counted


class Tone(StrEnum):
    """Tone of a headline, which says what the reader should do."""

    GOOD = "good"
    """nothing to do: all is as it should be"""
    NOTICE = "notice"
    """look at what was noticed or what failed, although the mission came to its end; or resume the
    run"""
    BAD = "bad"
    """the mission is no success"""


class Headline(Model):
    """Headline of a run, one line."""

    word: str
    """`Success`, `No success`, `Completed with failures`, `Interrupted`, or such as
    `Done, 2 findings`"""
    text: str
    """the rest, without a full stop"""
    tone: Tone

    def __str__(self) -> str:
        return f"{self.word}: {self.text}."


def run_headline(
    verdict: str,
    *,
    success: bool,
    ended: bool,
    only_tasks_failed: bool,
    noticed: Mapping[str, Sequence[str]],
) -> Headline:
    """Return the headline of a run with the given result.

    `verdict`, `success`, `ended` and `only_tasks_failed` are those of the record's `Result`.
    `noticed` lists what was noticed, in words, by its kind in the singular, such as `finding` or
    `contact`.
    """
    counts = ", ".join(
        f"{len(things)} {name}{'s' if len(things) > 1 else ''}"
        for name, things in noticed.items()
        if things
    )
    summary = _summarize([thing for things in noticed.values() for thing in things])
    if not success:
        word, tone = ("No success", Tone.BAD) if ended else ("Interrupted", Tone.NOTICE)
        if only_tasks_failed:
            word, tone = "Completed with failures", Tone.NOTICE
        text = f"{verdict}. {counts}: {summary}" if counts else verdict
        return Headline(word=word, text=text, tone=tone)
    if not counts:
        return Headline(word="Success", text=verdict, tone=Tone.GOOD)
    if verdict != AS_PLANNED:
        summary += f". {verdict[:1].upper()}{verdict[1:]}"
    return Headline(word=f"Done, {counts}", text=summary, tone=Tone.NOTICE)


def _summarize(things: Sequence[str]) -> str:
    """Return the first few different texts with their counts, and how many items are left out."""
    times = list(Counter(things).items())
    named = [thing if n == 1 else f"{thing}, {n} times" for thing, n in times[:_NAMED]]
    more = sum(n for _, n in times[_NAMED:])
    return "; ".join([*named, *([f"and {more} more"] if more else [])])
