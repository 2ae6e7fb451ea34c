"""The headline of a run: the same words on the terminal, in reports, recordings and films."""

from collections import Counter
from enum import StrEnum
from typing import TYPE_CHECKING

from argo_compiler.base.model import Model
from argo_env.formatting import clock

if TYPE_CHECKING:  # it is made of this
    from argo_env.run.record import Finding, RunRecord

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


def headline(record: "RunRecord") -> Headline:
    """The headline of a run. What was found, touched and slipped is counted, each thing once."""
    result = record.result
    counts = ", ".join(
        f"{len(things)} {name}{'s' if len(things) > 1 else ''}"
        for name, things in (
            ("finding", record.findings),
            ("late task", record.late),
            ("contact", record.contacts),
            ("mishap", record.mishaps),
        )
        if things
    )
    noticed = _noticed(record)
    if not result.success:
        word, tone = ("No success", Tone.BAD) if result.ended else ("Interrupted", Tone.NOTICE)
        if result.only_failures:
            word, tone = "Completed with failures", Tone.NOTICE
        text = f"{result.verdict}. {counts}: {noticed}" if counts else result.verdict
        return Headline(word=word, text=text, tone=tone)
    if not counts:
        return Headline(word="Success", text=result.verdict, tone=Tone.GOOD)
    if result.verdict != AS_PLANNED:
        noticed += f". {result.verdict[:1].upper()}{result.verdict[1:]}"
    return Headline(word=f"Done, {counts}", text=noticed, tone=Tone.NOTICE)


def _noticed(record: "RunRecord") -> str:
    """The things to look at, in words; of many the first."""
    said = [in_words(finding) for finding in record.findings]
    said += [f"{run.task} ended after its time window" for run in record.late]
    said += [f"{c.link} touched {c.element} at {clock(c.start)}" for c in record.contacts]
    said += [f"{m.trouble} at {clock(m.t)}" for m in record.mishaps]
    times = list(Counter(said).items())
    named = [what if n == 1 else f"{what}, {n} times" for what, n in times[:_NAMED]]
    more = sum(n for _, n in times[_NAMED:])
    return "; ".join([*named, *([f"and {more} more"] if more else [])])


def in_words(finding: "Finding") -> str:
    """A finding with what came of it: of a reading, that no reaction answers it goes unsaid, as its
    value is what the mission was to find out."""
    if finding.is_reading:
        return finding.what + (f" ({finding.answer})" if finding.answered else "")
    over = "" if finding.over_at is None else f", over at {clock(finding.over_at)}"
    return f"{finding.what} at {clock(finding.t)} ({finding.answer}){over}"
