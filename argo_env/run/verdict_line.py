"""Headline of a run: the same words on the terminal, in reports, recordings and films.

It begins with how the run ended, and continues with the verdict from `result.py`. The planner page
makes its own texts from the headline's data.
`argo_planner/terminal/record_tables.py` chooses its colour on the terminal.
"""

from collections import Counter
from collections.abc import Sequence
from enum import StrEnum

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind, Response
from argo_env.drives.drive import Trouble
from argo_env.run.verdict import VerdictCode, VerdictPart, verdict_text

AS_PLANNED = verdict_text((VerdictPart(code=VerdictCode.AS_PLANNED),))
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


class Ending(StrEnum):
    """Ending of a run, with which its headline begins."""

    SUCCESS = "success"
    DONE = "done"
    """a success, in which something was noticed"""
    COMPLETED_WITH_FAILURES = "completed_with_failures"
    INTERRUPTED = "interrupted"
    NO_SUCCESS = "no_success"


class NoticedKind(StrEnum):
    """Kind of a thing that was noticed in a run."""

    FINDING = "finding"
    LATE_TASK = "late task"
    CONTACT = "contact"
    MISHAP = "mishap"


class Noticed(Model):
    """Thing that was noticed in a run: in English words, and the data of its kind."""

    kind: NoticedKind
    text: str
    t: float | None = None
    """s"""
    event: EventKind | None = None
    """of a finding"""
    checkpoint: str | None = None
    """name and number of the checkpoint whose value is abnormal; None: the finding is no reading"""
    value: float | None = None
    unit: str | None = None
    response: Response | None = None
    """of the reaction to the finding; None: the mission has none"""
    answered: bool = False
    """whether that reaction began"""
    over_at: float | None = None
    """s, when the end of the finding was reported; None: it was not"""
    task: str | None = None
    """that ended after its time window"""
    link: str | None = None
    """of the robot, in contact"""
    element: str | None = None
    """of the site, in contact"""
    trouble: Trouble | None = None
    """of the drive"""


class Headline(Model):
    """Headline of a run, one line."""

    word: str
    """`Success`, `No success`, `Completed with failures`, `Interrupted`, or such as
    `Done, 2 findings`"""
    text: str
    """the rest, without a full stop"""
    tone: Tone
    ending: Ending
    verdict: tuple[VerdictPart, ...]
    """empty in old records"""
    noticed: tuple[Noticed, ...]

    def __str__(self) -> str:
        return f"{self.word}: {self.text}."


def run_headline(
    verdict: str,
    parts: tuple[VerdictPart, ...],
    *,
    success: bool,
    ended: bool,
    only_tasks_failed: bool,
    noticed: tuple[Noticed, ...],
) -> Headline:
    """Return the headline of a run with the given result, and with what was noticed.

    `verdict`, `parts`, `success`, `ended` and `only_tasks_failed` are those of the record's
    `Result`.
    """
    if success:
        ending, tone = (Ending.DONE, Tone.NOTICE) if noticed else (Ending.SUCCESS, Tone.GOOD)
    elif only_tasks_failed:
        ending, tone = Ending.COMPLETED_WITH_FAILURES, Tone.NOTICE
    else:
        ending, tone = (Ending.NO_SUCCESS, Tone.BAD) if ended else (Ending.INTERRUPTED, Tone.NOTICE)
    counts = ", ".join(
        f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in Counter(n.kind for n in noticed).items()
    )
    word, text = ending.replace("_", " ").capitalize(), verdict
    if counts and success:
        word, text = f"{word}, {counts}", _summarize(noticed)
        if verdict != AS_PLANNED:
            text += f". {verdict[:1].upper()}{verdict[1:]}"
    elif counts:
        text = f"{verdict}. {counts}: {_summarize(noticed)}"
    return Headline(word=word, text=text, tone=tone, ending=ending, verdict=parts, noticed=noticed)


def _summarize(noticed: Sequence[Noticed]) -> str:
    """Return the first few different texts with their counts, and how many items are left out."""
    times = list(Counter(thing.text for thing in noticed).items())
    named = [text if n == 1 else f"{text}, {n} times" for text, n in times[:_NAMED]]
    more = sum(n for _, n in times[_NAMED:])
    return "; ".join([*named, *([f"and {more} more"] if more else [])])
