"""The draft of a mission: what each piece of a script becomes, and what is left to decide."""

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

from argo_compiler.base.errors import INCOMPLETE, Invalid
from argo_compiler.base.listing import listed
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.script.assistant.suggestion import LineSuggestion, SuggestedSentence

_Acts = dict[int, tuple["Act | None", tuple[str, ...]]]
"""by the identity of a line: what a person does with it, and the sentences that it becomes"""


_MOST_DIGITS = 9
"""of the number of a line"""


class LineState(StrEnum):
    """State of a line of a draft."""

    UNDERSTOOD = "understood"
    PROPOSED = "proposed"
    """read by way of an assumption; it counts only when a person has confirmed it"""
    SET_ASIDE = "set aside"
    """without effect"""
    OPEN = "open"
    """not understood, or with more than one meaning"""


class Act(StrEnum):
    """Act of a person on a line."""

    CONFIRMED = "confirmed"
    CHOSEN = "chosen"
    SAID = "said"
    SET_ASIDE = "set aside"


class LineDecision(Model):
    """Decision of a person about a line of a script.

    A line is found again by its text. A confirmation counts only while the proposal is the same, a
    choice only while it is offered.
    """

    text: str
    """of the line, with single blanks"""
    act: Act
    sentences: tuple[str, ...] = ()
    """what it becomes; none for a line that is set aside"""
    occurrence: int = 1
    """which of the lines with this text it is, from 1"""
    occurrences: int = 1
    """how many lines had this text"""


class DraftLine(Model):
    """A sentence, a field, a row or a remark of a script, and what it becomes.

    It may be a part of a line of the file, or go over several.
    """

    line: int
    """number of its first line in the file, from 1"""
    last_line: int
    column: int = 1
    """where it begins in its first line, from 1"""
    part: int = 1
    """which of the pieces that begin in this line it is, from 1"""
    parts: int = 1
    """how many pieces begin in this line"""
    place: str = ""
    """in a document: its cells, or its page; `line` then only numbers the lines of the draft"""
    text: str
    """as in the file, with single blanks"""
    state: LineState
    sentences: tuple[str, ...] = ()
    """what it becomes, if that is proposed or decided, as sentences that Argo understands"""
    unused: tuple[str, ...] = ()
    """words of the line that the proposal does not use"""
    reason: str = ""
    """why it is set aside or open"""
    hint: str = ""
    """what a person can do about it"""
    choices: tuple[tuple[str, ...], ...] = ()
    """for an open line, what it may become; no sentences: it is set aside"""
    is_question: bool = False
    """whether it is open though it is understood: it has several meanings, or does not fit"""
    act: Act | None = None
    """what a person has done with it"""
    suggested: tuple[SuggestedSentence, ...] | None = None
    """what an assistant suggests for it; None: no assistant was asked about it"""

    @property
    def label(self) -> str:
        """The number by which a person names it: `7`, or `7.2` for the second piece of line 7."""
        return f"{self.line}.{self.part}" if self.parts > 1 else str(self.line)

    @property
    def is_left(self) -> bool:
        """Return True if a person still has to decide on the line."""
        return self.state in (LineState.PROPOSED, LineState.OPEN)


@dataclass(frozen=True)
class DraftActs:
    """Acts of a person on lines of a draft, by the labels that the draft shows."""

    confirm: Sequence[str] | None = ()
    """proposed lines; None: all that no other act is about"""
    set_aside: Sequence[str] = ()
    say: Sequence[tuple[str, Sequence[str]]] = ()
    """lines, each with the sentences that count instead"""
    choose: Sequence[tuple[str, int]] = ()
    """open lines, each with the number of a choice, from 1"""
    undo: Sequence[str] = ()
    """lines whose decisions are forgotten"""


@dataclass(frozen=True)
class Draft:
    """A script that was read, line by line, and its mission once nothing is left to decide."""

    source_name: str
    lines: tuple[DraftLine, ...]
    mission: Mission | None
    """the mission; None while a line is open or not confirmed, or the mission has an error"""
    diagnostics: tuple[Diagnostic, ...] = ()
    """all messages, by position; one for each open line is an error"""
    text: str = field(default="", repr=False)
    """the script"""

    @cached_property
    def left(self) -> tuple[DraftLine, ...]:
        """The lines that are proposed or open."""
        return tuple(line for line in self.lines if line.is_left)

    @cached_property
    def decisions(self) -> tuple[LineDecision, ...]:
        """Return the decisions about the lines, in their order."""
        return decisions_of((line.text, line.act, line.sentences) for line in self.lines)

    @cached_property
    def suggestions(self) -> tuple[LineSuggestion, ...]:
        """Return what an assistant has suggested for the lines, in their order."""
        return suggestions_of((line.text, line.suggested) for line in self.lines)

    def require_mission(self) -> Mission:
        """Return the mission.

        Raises:
            IncompleteDraft: There are lines to confirm or to answer.
            DiagnosticError: The mission as a whole has an error, or an option does not fit it.
        """
        if self.mission is not None:
            return self.mission
        if self.left:
            raise IncompleteDraft(self)
        raise DiagnosticError(self.source_name, self.diagnostics)

    # ---- decisions

    def decide(self, acts: DraftActs) -> tuple[LineDecision, ...]:
        """Return the decisions once acts on several lines have been carried out together.

        Of a line with several pieces those are meant that are open or proposed, or all if none is.

        Raises:
            Invalid: There is no such line or choice, a line is open and can't be confirmed, or two
                acts are about one line.
        """
        parts: list[_Acts] = [
            *(self._undone(label) for label in acts.undo),
            *(self._set_aside(label) for label in acts.set_aside),
            *(self._said(label, sentences) for label, sentences in acts.say),
            *(self._chosen(label, number) for label, number in acts.choose),
            *(self._confirmed(label) for label in acts.confirm or ()),
        ]
        decided: _Acts = {}
        for part in parts:
            for line, act in part.items():
                if decided.setdefault(line, act) != act:
                    label = next(one.label for one in self.lines if id(one) == line)
                    raise Invalid(f"line {label} of {self.source_name} is decided on twice")
        if acts.confirm is None:
            for one in self.lines:
                if one.state is LineState.PROPOSED:
                    decided.setdefault(id(one), (Act.CONFIRMED, one.sentences))
        return self._with(decided)

    def confirm(self, labels: Iterable[str] | None = None) -> tuple[LineDecision, ...]:
        """Return the decisions with these proposed lines confirmed; None: all proposed lines."""
        return self.decide(DraftActs(confirm=None if labels is None else tuple(labels)))

    def set_aside(self, labels: Iterable[str]) -> tuple[LineDecision, ...]:
        """Return the decisions with these lines set aside."""
        return self.decide(DraftActs(set_aside=tuple(labels)))

    def say(self, label: str, sentences: Sequence[str]) -> tuple[LineDecision, ...]:
        """Return the decisions with sentences said instead of a line."""
        return self.decide(DraftActs(say=((label, sentences),)))

    def choose(self, label: str, number: int) -> tuple[LineDecision, ...]:
        """Return the decisions with the choice of this number, from 1, taken for an open line."""
        return self.decide(DraftActs(choose=((label, number),)))

    def undo(self, labels: Iterable[str]) -> tuple[LineDecision, ...]:
        """Return the decisions without those on these lines."""
        return self.decide(DraftActs(undo=tuple(labels)))

    def lines_named(self, label: str) -> Sequence[DraftLine]:
        """Return the lines that a label means, of a line with several pieces those that are left.

        Raises Invalid if there is no such line.
        """
        return self._named(label)

    def _undone(self, label: str) -> _Acts:
        return {id(one): (None, ()) for one in self._named(label, decided=True)}

    def _confirmed(self, label: str) -> _Acts:
        found = self._named(label)
        line = next((line for line in found if line.state is LineState.OPEN), None)
        if line is not None:
            raise Invalid(
                f"line {line.label} of {self.source_name} is open, and has nothing to confirm: "
                f"choose what it means, say it in other words, or set it aside"
            )
        chosen = (line for line in found if line.state is LineState.PROPOSED)
        return {id(one): (Act.CONFIRMED, one.sentences) for one in chosen}

    def _set_aside(self, label: str) -> _Acts:
        return {id(one): (Act.SET_ASIDE, ()) for one in self._named(label)}

    def _said(self, label: str, sentences: Sequence[str]) -> _Acts:
        first, *others = self._named(label)
        acts: _Acts = {id(one): (Act.SET_ASIDE, ()) for one in others}
        return {id(first): (Act.SAID, tuple(sentences)), **acts}

    def _chosen(self, label: str, number: int) -> _Acts:
        named = self._named(label)
        choosing = [line for line in named if line.choices]
        if not choosing and any(line.act is not None for line in named):
            raise Invalid(f"line {label} of {self.source_name} is decided on: undo that first")
        if len(choosing) != 1:
            proposed = any(line.state is LineState.PROPOSED for line in named)
            ways = (
                "confirm what is proposed, say what it means" if proposed else "say what it means"
            )
            raise Invalid(
                f"line {label} of {self.source_name} offers no choice: {ways}, or set it aside"
            )
        (line,) = choosing
        if not 1 <= number <= len(line.choices):
            raise Invalid(
                f"line {line.label} of {self.source_name} has {len(line.choices)} choices, and no "
                f"choice {number}"
            )
        sentences = line.choices[number - 1]
        return {id(line): (Act.CHOSEN if sentences else Act.SET_ASIDE, sentences)}

    def _named(self, label: str, decided: bool = False) -> Sequence[DraftLine]:
        """Return the lines that a label such as `7` or `7.2` means."""
        at = [line for line in self.lines if line.label == label]
        if not at and label.isdecimal() and len(label) <= _MOST_DIGITS:
            wanted = int(label)
            at = [line for line in self.lines if line.line == wanted]
            at = at or [one for one in self.lines if one.line <= wanted <= one.last_line]
        if not at:
            raise Invalid(f"{self.source_name} has no line {label} with text")
        if decided:
            return at
        return [line for line in at if line.is_left] or at

    def _with(self, acts: _Acts) -> tuple[LineDecision, ...]:
        """Return the decisions, with others for the lines with these identities."""
        return decisions_of(
            (line.text, *acts.get(id(line), (line.act, line.sentences))) for line in self.lines
        )


def decisions_of(
    lines: Iterable[tuple[str, Act | None, tuple[str, ...]]],
) -> tuple[LineDecision, ...]:
    """Return the decisions on the lines of a script, given by text, act and sentences."""
    all_ = tuple(lines)
    places = occurrences([text for text, _, _ in all_])
    return tuple(
        LineDecision(
            text=text,
            act=act,
            sentences=() if act is Act.SET_ASIDE else sentences,
            occurrence=occurrence,
            occurrences=count,
        )
        for (text, act, sentences), (occurrence, count) in zip(all_, places, strict=True)
        if act is not None
    )


def suggestions_of(
    lines: Iterable[tuple[str, tuple[SuggestedSentence, ...] | None]],
) -> tuple[LineSuggestion, ...]:
    """Return the suggestions for the lines of a script, given by text and sentences."""
    all_ = tuple(lines)
    places = occurrences([text for text, _ in all_])
    return tuple(
        LineSuggestion(text=text, sentences=sentences, occurrence=occurrence, occurrences=count)
        for (text, sentences), (occurrence, count) in zip(all_, places, strict=True)
        if sentences is not None
    )


def occurrences(items: Sequence[Hashable]) -> Iterator[tuple[int, int]]:
    """Yield of each item which of its equals it is, from 1, and how many there are."""
    total = Counter(items)
    met: Counter[Hashable] = Counter()
    for item in items:
        met[item] += 1
        yield met[item], total[item]


class IncompleteDraft(DiagnosticError):
    """Raised where a mission is asked for, and its draft has lines left to decide on."""

    code = INCOMPLETE

    def __init__(self, draft: Draft) -> None:
        super().__init__(draft.source_name, draft.diagnostics)
        self.draft = draft

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.draft,), vars(self)

    def __str__(self) -> str:
        proposed = sum(line.state is LineState.PROPOSED for line in self.draft.left)
        counts = ((proposed, "confirm"), (len(self.draft.left) - proposed, "answer"))
        parts = [f"{n} line{'s' if n > 1 else ''} to {what}" for n, what in counts if n]
        return f"{self.draft.source_name} is not complete: {listed(parts)}"
