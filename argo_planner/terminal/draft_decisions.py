"""Decisions on lines of a draft by options of `argo import`."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import Upload, load_draft

if TYPE_CHECKING:
    from argo_compiler.script import Draft, LineDecision


@dataclass(frozen=True)
class DraftActs:
    """The options that decide on lines, as they are given."""

    confirm: Sequence[str]
    set_aside: Sequence[str]
    say: Sequence[str]
    choose: Sequence[str]
    undo: Sequence[str]


def decide(
    upload: Upload, site: OpenedSite, areas: tuple[int | None, int | None], acts: DraftActs
) -> tuple["Draft", tuple["LineDecision", ...]]:
    """Return the draft of a script once the acts have been carried out, and all decisions.

    Raises:
        Invalid: An act names no line of the draft, or one that it can't be done with.
    """
    draft = load_draft(upload, site.catalog, *areas)
    decisions = draft.decisions

    def carry_out(decided: tuple["LineDecision", ...]) -> None:
        nonlocal draft, decisions
        decisions = decided
        draft = load_draft(upload, site.catalog, *areas, decisions=decided)

    if acts.undo:
        carry_out(draft.undo(_labels(draft, acts.undo)))
    if acts.set_aside:
        carry_out(draft.set_aside(_labels(draft, acts.set_aside)))
    for said in acts.say:
        label, _, text = said.strip().partition(" ")
        if not text.strip():
            raise Invalid(f'--say {said}: write a line and a sentence, as in 4 "Check valve R7."')
        carry_out(draft.say(label, (text.strip(),)))
    for chosen in acts.choose:
        label, _, number = chosen.partition("=")
        if not number.strip().isdecimal():
            raise Invalid(f"--choose {chosen}: write a line and the number of a choice, as in 4=1")
        carry_out(draft.choose(label.strip(), int(number)))
    if acts.confirm:
        everything = [text.strip() for text in acts.confirm] == ["all"]
        carry_out(draft.confirm(None if everything else _labels(draft, acts.confirm)))
    return draft, decisions


def _labels(draft: "Draft", texts: Iterable[str]) -> list[str]:
    """Return the labels that texts such as `3,7-9` name; of a range those that are left, if any."""
    found: list[str] = []
    for text in (part.strip() for given in texts for part in given.split(",")):
        first, dash, last = (part.strip() for part in text.partition("-"))
        if not dash:
            found.append(text)
            continue
        if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
            raise Invalid(f"`{text}` names no lines: write numbers such as 3,7-9")
        inside = [one for one in draft.lines if int(first) <= one.line <= int(last)]
        if not inside:
            raise Invalid(f"{draft.source_name} has no lines {text} with text")
        found += [one.label for one in inside if one.is_left] or [one.label for one in inside]
    return found
