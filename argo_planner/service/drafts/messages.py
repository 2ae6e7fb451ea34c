"""The draft of a script as clients see it, and the acts by which they decide on its lines."""

from bisect import bisect_right
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from datetime import datetime
from typing import Annotated, Literal

from pydantic import Discriminator, Field

from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.script.drafts.draft import Act, Draft, DraftLine, LineDecision, LineState

MOST_ACTS = 500
"""acts in one request"""
MOST_LINES = 5_000
"""lines of a draft; longer scripts are decided on with the command line"""
MOST_MESSAGES = 500
"""messages of a draft that are sent"""
MAX_SENTENCE_LENGTH = 1_000
MOST_SENTENCES = 20
MAX_AREA = 1_000

OF_DECISIONS = frozenset(["script.decided", "script.set-aside-by-hand"])
"""codes of messages that state what a person has decided on a line"""
OF_ASIDES = frozenset(["script.set-aside", "script.no-effect"])
"""codes of messages whose text is the reason why a line is set aside"""

Label = Annotated[str, Field(pattern=r"^[0-9]{1,9}(\.[0-9]{1,6})?$")]
"""label of a line, such as `7`, or `7.2` for the second part of line 7"""
Labels = Annotated[tuple[Label, ...], Field(min_length=1, max_length=MOST_LINES)]
Sentence = Annotated[str, Field(min_length=1, max_length=MAX_SENTENCE_LENGTH)]


class ConfirmLines(Model):
    """Act that accepts what is proposed for lines."""

    kind: Literal["confirm"] = "confirm"
    labels: Labels | None = None
    """lines; None: all proposed ones"""


class SetAsideLines(Model):
    """Act that lets lines have no effect."""

    kind: Literal["set_aside"] = "set_aside"
    labels: Labels


class SayLine(Model):
    """Act that replaces a line by other sentences."""

    kind: Literal["say"] = "say"
    label: Label
    sentences: tuple[Sentence, ...] = Field(min_length=1, max_length=MOST_SENTENCES)


class ChooseMeaning(Model):
    """Act that takes one of the choices of an open line."""

    kind: Literal["choose"] = "choose"
    label: Label
    number: int = Field(ge=1, le=1_000)
    """from 1"""


class ForgetDecisions(Model):
    """Act that removes the decisions on lines."""

    kind: Literal["undo"] = "undo"
    labels: Labels


class ChooseAreas(Model):
    """Act that chooses areas which the script leaves open; None: as the script says."""

    kind: Literal["areas"] = "areas"
    start_area: int | None = Field(default=None, ge=-MAX_AREA, le=MAX_AREA)
    end_area: int | None = Field(default=None, ge=-MAX_AREA, le=MAX_AREA)


AnyAct = Annotated[
    ConfirmLines | SetAsideLines | SayLine | ChooseMeaning | ForgetDecisions | ChooseAreas,
    Discriminator("kind"),
]


class ActsOnDraft(Model):
    """Acts, which are carried out in their order, all or none."""

    acts: tuple[AnyAct, ...] = Field(min_length=1, max_length=MOST_ACTS)


class DraftSummary(Model):
    """Summary of a draft, for lists."""

    id: str
    name: str
    source_name: str
    """name of the script's file"""
    created: datetime
    changed: datetime
    revision: int
    to_confirm: int
    """proposed lines that nobody has confirmed"""
    to_answer: int
    """open lines"""


class DraftedLine(Model):
    """A line of a draft, with what it becomes."""

    label: str
    line: int
    """number of its first line in the script, from 1"""
    last_line: int
    column: int = 1
    """where it begins in its first line, from 1"""
    place: str = ""
    """in a document: its cells, or its page; `line` then only numbers the lines of the draft"""
    text: str
    state: LineState
    sentences: tuple[str, ...] = ()
    """what it becomes, if that is proposed or decided"""
    steps: tuple[str, ...] = ()
    """of an understood line: the steps of the mission that it becomes, once no line is open"""
    unused: tuple[str, ...] = ()
    """words of the line that the proposal does not use"""
    reason: str = ""
    """why it is set aside or open"""
    hint: str = ""
    choices: tuple[tuple[str, ...], ...] = ()
    """for an open line, what it may become; no sentences: it is set aside"""
    names_nothing: bool = False
    """whether it is open, can only be set aside, and mentions nothing of a mission"""
    act: Act | None = None
    """what a person has done with it"""


class DraftState(DraftSummary):
    """Draft of a script, line by line."""

    start_area: int | None = None
    """area that a person has chosen; None: none"""
    end_area: int | None = None
    areas_to_choose: tuple[Literal["start", "end"], ...] = ()
    """areas that the script leaves open"""
    lines: tuple[DraftedLine, ...]
    diagnostics: tuple[Diagnostic, ...] = ()
    """warnings and notes, and the errors that are not about one of the open lines"""
    is_complete: bool
    """whether the draft can become a mission"""


def drafted_lines(
    draft: Draft, steps: Mapping[int, tuple[str, ...]], naming_nothing: Collection[str] = ()
) -> tuple[DraftedLine, ...]:
    """Return the lines of a draft as clients see them.

    Args:
        draft: The draft.
        steps: The steps of its lines, by number.
        naming_nothing: Labels of the lines that mention nothing of a mission.
    """
    names = DraftLine.model_fields.keys() & DraftedLine.model_fields.keys()
    found = []
    for line in draft.lines:
        own = line.state is LineState.UNDERSTOOD and line.act is None and line.parts == 1
        said = [step for number in _numbers(line) for step in steps.get(number, ())]
        fields = {name: getattr(line, name) for name in names}
        fields |= {"label": line.label, "steps": tuple(said) if own else ()}
        fields["names_nothing"] = line.label in naming_nothing
        found.append(DraftedLine.model_construct(**fields))
    return tuple(found)


def areas_to_choose(
    draft: Draft, problems: Iterable[Diagnostic]
) -> tuple[Literal["start", "end"], ...]:
    """Return which areas a script leaves open."""
    remedies = {remedy for one in (*draft.diagnostics, *problems) for remedy in one.remedies}
    start: tuple[Literal["start"], ...] = ("start",) if Remedy.CHOOSE_START in remedies else ()
    end: tuple[Literal["end"], ...] = ("end",) if Remedy.CHOOSE_END in remedies else ()
    return (*start, *end)


def other_messages(draft: Draft, problems: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return the messages of a draft, and the problems, without what its lines state already."""
    open_ = {
        number for line in draft.lines if line.state is LineState.OPEN for number in _numbers(line)
    }
    starts = [(line.line, line.column) for line in draft.lines]

    def is_other(diagnostic: Diagnostic) -> bool:
        span = diagnostic.span
        if diagnostic.severity is Severity.ERROR:
            return span is None or span.line not in open_
        if diagnostic.code in OF_DECISIONS:
            return False
        if span is None or diagnostic.code not in OF_ASIDES:
            return True
        at = bisect_right(starts, (span.line, span.column)) - 1
        return at < 0 or draft.lines[at].state is not LineState.SET_ASIDE

    found = filter(is_other, draft.diagnostics)
    return tuple(dict.fromkeys([*problems, *found]))[:MOST_MESSAGES]


def _numbers(line: DraftLine) -> range:
    return range(line.line, line.last_line + 1)


def decisions_after(draft: Draft, acts: Iterable[AnyAct]) -> tuple[LineDecision, ...]:
    """Return the decisions on a draft after acts on its lines, which leave areas out.

    Raises Invalid if an act names no line, or one that it can't be done with.
    """
    decided = draft
    for act in acts:
        lines = _with_decisions(draft, decided, _decisions_after_act(decided, act))
        decided = replace(decided, lines=tuple(lines))
    return decided.decisions


def _with_decisions(
    before: Draft, present: Draft, decisions: Iterable[LineDecision]
) -> Iterator[DraftLine]:
    """Yield the lines of the present draft with decisions.

    The lines are not read again: one without a decision is as it was `before`, or else open.
    """
    by_line = {(decision.text, decision.occurrence): decision for decision in decisions}
    met: Counter[str] = Counter()
    for original, line in zip(before.lines, present.lines, strict=True):
        met[line.text] += 1
        decision = by_line.get((line.text, met[line.text]))
        if decision is None:
            undone = {"act": None, "sentences": (), "state": LineState.OPEN}
            yield original if original.act is None else original.model_copy(update=undone)
        elif (decision.act, decision.sentences) == (line.act, line.sentences):
            yield line
        else:
            aside = decision.act is Act.SET_ASIDE
            state = LineState.SET_ASIDE if aside else LineState.UNDERSTOOD
            yield line.model_copy(
                update={"act": decision.act, "sentences": decision.sentences, "state": state}
            )


def _decisions_after_act(draft: Draft, act: AnyAct) -> tuple[LineDecision, ...]:
    match act:
        case ConfirmLines():
            return draft.confirm(act.labels)
        case SetAsideLines():
            return draft.set_aside(act.labels)
        case SayLine():
            return draft.say(act.label, [*_plain(act.sentences)])
        case ChooseMeaning():
            return draft.choose(act.label, act.number)
        case ForgetDecisions():
            return draft.undo(act.labels)
        case ChooseAreas():
            return draft.decisions


def _plain(sentences: Iterable[str]) -> Iterator[str]:
    for sentence in sentences:
        text = " ".join(sentence.split())
        if not text:
            raise Invalid("a sentence that replaces a line is empty: write one, or set it aside")
        yield text
