"""The draft of a script as a file that a person can read and edit.

For each line of the script there is a block: its number and text, and below that what it becomes.

    6 | I need pressure gauge 1 and then valve R25.
    proposed: Check checkpoint 1.
    proposed: Check checkpoint 4.
    not used: I need

A person decides by changing the words before the colon: `confirmed` accepts what is proposed,
`chosen` a choice, `said` stands before other sentences, and `set aside by hand` before nothing.
Reading takes only these, and what an assistant has `suggested`, with the words that it stands for:

    suggested: then valve R25 => Check checkpoint 4.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.base.errors import Invalid
from argo_compiler.base.listing import listed
from argo_compiler.base.model import Model
from argo_compiler.script.assistant.suggestion import LineSuggestion, SuggestedSentence
from argo_compiler.script.drafts.draft import (
    Act,
    Draft,
    DraftLine,
    LineDecision,
    decisions_of,
    suggestions_of,
)

VERSION = 1
"""version of this format"""
_FIRST = f"# draft, version {VERSION}"
_HEAD = re.compile(rf"{_FIRST}(?:: .*)?")
_LINE = re.compile(r"\s*[0-9]+(?:\.[0-9]+)? \| (.*)")
_KEYS = {
    Act.CONFIRMED: "confirmed",
    Act.CHOSEN: "chosen",
    Act.SAID: "said",
    Act.SET_ASIDE: "set aside by hand",
}
_ACTS = {key: act for act, key in _KEYS.items()}
_GENERATED = re.compile(
    r"place|understood|proposed|set aside|open|note|not used|hint|choice [0-9]+", re.IGNORECASE
)
"""keys of what each import writes anew"""
_SUGGESTED = "suggested"
_NOTHING = "(nothing)"
"""stands for a suggestion without sentences"""
_STANDS_FOR = " => "


class StoredDraft(Model):
    """Decisions and suggestions in the file of a draft; all else in it is made by each import."""

    decisions: tuple[LineDecision, ...] = ()
    suggestions: tuple[LineSuggestion, ...] = ()


def draft_text(draft: Draft) -> str:
    """Return the draft as text."""
    width = max((len(line.label) for line in draft.lines), default=1)
    blocks = ["\n".join(_block(line, width)) for line in draft.lines]
    return "\n\n".join([f"{_FIRST}: {draft.source_name}", *blocks]) + "\n"


def _block(line: DraftLine, width: int) -> Iterator[str]:
    yield f"{line.label:>{width}} | {line.text}"
    if line.place:
        yield f"place: {line.place}"
    yield from _state_lines(line)
    for part in () if line.suggested is None else line.suggested or (None,):
        said = _NOTHING if part is None else f"{part.words}{_STANDS_FOR}{part.sentence}"
        yield f"{_SUGGESTED}: {said}"


def _state_lines(line: DraftLine) -> Iterator[str]:
    if line.act is not None:
        key = _KEYS[line.act]
        yield from (f"{key}: {sentence}" for sentence in line.sentences)
        yield from () if line.sentences else (key,)
        if not line.is_left:
            return
    key = str(line.state)
    if line.sentences and line.act is None:
        yield from (f"{key}: {sentence}" for sentence in line.sentences)
        if line.reason:
            yield f"note: {line.reason}"
    else:
        yield f"{key}: {line.reason}" if line.reason else key
    if line.unused:
        yield f"not used: {', '.join(line.unused)}"
    if line.hint:
        yield f"hint: {line.hint}"
    for number, sentences in enumerate(line.choices, start=1):
        yield f"choice {number}: {' '.join(sentences) or '(set it aside)'}"


def read_draft(text: str, source_name: str) -> StoredDraft:
    """Return what a person has decided on, and an assistant has suggested, in the text of a draft.

    Raises:
        Invalid: It is no draft, or one of another version, or a line of it can't be read.
    """
    first, *rest = text.split("\n")
    head = _HEAD.fullmatch(first.strip("\ufeff \t\r"))
    if head is None:
        raise Invalid(
            f"{source_name} is no draft of this version of Argo, as its first line is not "
            f"`{_FIRST}`; remove the file to decide anew"
        )
    blocks: list[_Block] = []
    for number, line in enumerate(rest, start=2):
        if (begun := _LINE.fullmatch(line.rstrip())) is not None:
            blocks.append(_Block(" ".join(begun[1].split())))
        elif line.strip() and not line.startswith("#"):
            key, colon, value = line.partition(":")
            fault = "it stands above the first line of the script"
            if blocks:
                fault = blocks[-1].read(
                    " ".join(key.lower().split()), value.strip() if colon else ""
                )
            if fault:
                raise Invalid(f"{source_name}, line {number}: {fault}")
    return StoredDraft(
        decisions=decisions_of((b.text, b.decided, tuple(b.sentences)) for b in blocks),
        suggestions=suggestions_of(
            (b.text, None if b.suggested is None else tuple(b.suggested)) for b in blocks
        ),
    )


def read_decisions(text: str, source_name: str) -> tuple[LineDecision, ...]:
    """Return what a person has decided on in the text of a draft.

    Raises:
        Invalid: It is no draft, or one of another version.
    """
    return read_draft(text, source_name).decisions


@dataclass
class _Block:
    """The lines of the file for one line of the script, as far as they are read."""

    text: str
    act: Act | None = None
    sentences: list[str] = field(default_factory=list)
    suggested: list[SuggestedSentence] | None = None

    @property
    def decided(self) -> Act | None:
        """The act, unless it needs sentences and has none."""
        return self.act if self.sentences or self.act is Act.SET_ASIDE else None

    def read(self, key: str, value: str) -> str:
        """Read a line of a key and a value; return what is wrong with it, empty if nothing is."""
        if key == _SUGGESTED:
            self.suggested = self.suggested or []
            words, stands_for, sentence = value.rpartition(_STANDS_FOR)
            if stands_for and words.strip() and sentence.strip():
                part = SuggestedSentence(words=words.strip(), sentence=sentence.strip())
                self.suggested.append(part)
            return ""
        act = Act.SET_ASIDE if key == "set aside" and not value else _ACTS.get(key)
        if act is None:
            keys = listed(
                [f"`{one}: ...`" for one in _ACTS if _ACTS[one] is not Act.SET_ASIDE], "or"
            )
            wrong = f"`{key}` is no key of a draft: write {keys} for each sentence, or "
            return "" if _GENERATED.fullmatch(key) else f"{wrong}`{_KEYS[Act.SET_ASIDE]}`"
        if self.act not in (None, act):
            return f"`{key}` is a second decision on one line"
        if not value and act is not Act.SET_ASIDE:
            return f"a sentence is missing behind `{key}:`"
        self.act = act
        self.sentences += [value] if act is not Act.SET_ASIDE else []
        return ""
