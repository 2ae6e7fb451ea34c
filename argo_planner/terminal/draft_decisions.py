"""Decisions on lines of a draft by options of `argo import`."""

import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from argo_compiler.base.errors import ArgoError, Invalid
from argo_env.planning.opening import OpenedSite
from argo_planner.terminal.draft_display import printable
from argo_planner.terminal.draft_files import keep_draft
from argo_planner.use_cases.assisting import Assistant, suggest_lines
from argo_planner.use_cases.deciding import Areas, decide
from argo_planner.use_cases.importing import Upload, load_draft

if TYPE_CHECKING:
    from argo_compiler.script import Draft, DraftActs

_MOST_DIGITS = 9
"""of a number in an option"""


@dataclass(frozen=True)
class ActOptions:
    """The options that decide on lines, as they are given."""

    confirm: Sequence[str] = ()
    set_aside: Sequence[str] = ()
    say: Sequence[str] = ()
    choose: Sequence[str] = ()
    undo: Sequence[str] = ()

    @property
    def given(self) -> bool:
        """Return True if there is any of the options."""
        return any((self.confirm, self.set_aside, self.say, self.choose, self.undo))


class Deciding:
    """A script, with its draft as far as it has been decided on. Mutable."""

    def __init__(self, script: Path, upload: Upload, site: OpenedSite, areas: Areas) -> None:
        self.script = script
        self.upload = upload
        self.site = site
        self.areas = areas
        self.draft = load_draft(upload, site.catalog, *areas)

    def act(self, options: ActOptions) -> None:
        """Carry out what options ask for. Raises Invalid, and changes nothing, if one can't be."""
        self.perform(acts_of(self.draft, options))

    def perform(self, acts: "DraftActs") -> None:
        """Carry out acts. Raises Invalid, and changes nothing, if one of them can't be."""
        self.draft = decide(self.upload, self.site, self.areas, self.draft, acts)

    def ask(self, assistant: Assistant) -> None:
        """Ask an assistant about open lines; if that fails, a message says so and nothing changes.

        What is sent where is printed before.
        """
        try:
            found = suggest_lines(self.draft, self.site.catalog, assistant, _announce)
        except ArgoError as error:
            print(f"argo: {printable(str(error))}; the draft is without it", file=sys.stderr)
            return
        if found is None:
            _announce("no line is left that the assistant has not been asked about")
            return
        decisions = self.draft.decisions
        self.upload = replace(self.upload, decisions=decisions, suggestions=found)
        self.draft = load_draft(self.upload, self.site.catalog, *self.areas)

    def keep(self) -> None:
        """Write the draft beside the script, if there is something to keep or to decide."""
        keep_draft(self.script, self.draft)


def _announce(text: str) -> None:
    print(f"argo: {printable(text)}", file=sys.stderr, flush=True)


def acts_of(draft: "Draft", options: ActOptions) -> "DraftActs":
    """Return the acts that options ask for, on the lines that a draft has.

    A range, and `all`, leave out lines that another option names by themselves.

    Raises:
        Invalid: An option has no such form, or a range has no lines.
    """
    from argo_compiler.script import DraftActs

    say = [_said(text) for text in options.say]
    choose = [chosen for text in options.choose for chosen in _chosen(text)]
    named = {label for label, _ in (*say, *choose)}
    lists = (options.confirm, options.set_aside, options.undo)
    named |= {text for given in lists for text in _parts(given) if not _is_range(text)}
    undo = _labels(draft, options.undo, named)
    if _is_all(options.undo):
        decided = (one for one in draft.lines if one.act is not None)
        undo = (one.label for one in decided if not {one.label, str(one.line)} & named)
    confirm = None if _is_all(options.confirm) else tuple(_labels(draft, options.confirm, named))
    return DraftActs(
        confirm=confirm,
        set_aside=tuple(_labels(draft, options.set_aside, named)),
        say=say,
        choose=choose,
        undo=tuple(undo),
    )


def _is_all(texts: Iterable[str]) -> bool:
    return [text.strip() for text in texts] == ["all"]


def _said(text: str) -> tuple[str, tuple[str, ...]]:
    label, _, sentence = " ".join(text.split()).partition(" ")
    if not sentence:
        raise Invalid(f'--say {text}: write a line and a sentence, as in 4 "Check valve R7."')
    if not sentence.isprintable():
        raise Invalid(f"--say {label}: the sentence has characters that can't be printed")
    return label, (sentence,)


def _chosen(text: str) -> Iterator[tuple[str, int]]:
    labels, _, number = (part.strip() for part in text.partition("="))
    if not _is_number(number):
        raise Invalid(f"--choose {text}: write a line and the number of a choice, as in 4=1")
    for label in _parts([labels]):
        yield label, int(number)


def _labels(draft: "Draft", texts: Iterable[str], named: set[str]) -> Iterator[str]:
    """Yield the labels that texts such as `3,7-9` name.

    Of a range these are the lines that are left, if any, without those named by themselves.
    """
    for text in _parts(texts):
        if not _is_range(text):
            yield text
            continue
        first, last = (part.strip() for part in text.split("-", 1))
        if not (_is_number(first) and _is_number(last) and int(first) <= int(last)):
            raise Invalid(f"`{text}` names no lines: write numbers such as 3,7-9")
        inside = [one for one in draft.lines if int(first) <= one.line <= int(last)]
        if not inside:
            raise Invalid(f"{draft.source_name} has no lines {text} with text")
        found = [one for one in inside if one.is_left] or inside
        yield from (one.label for one in found if not {one.label, str(one.line)} & named)


def _parts(texts: Iterable[str]) -> Iterator[str]:
    return (part.strip() for text in texts for part in text.split(","))


def _is_range(text: str) -> bool:
    return "-" in text


def _is_number(text: str) -> bool:
    return text.isdecimal() and len(text) <= _MOST_DIGITS
