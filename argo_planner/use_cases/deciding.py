"""Decisions on the lines of a draft, carried out together."""

from typing import TYPE_CHECKING

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_env.planning.opening import OpenedSite
from argo_planner.use_cases.importing import Upload, load_draft

if TYPE_CHECKING:
    from argo_compiler.script import Draft, DraftActs, DraftLine

Areas = tuple[int | None, int | None]
"""areas to start and to end in, for a script that names none"""


def decide(
    upload: Upload, site: OpenedSite, areas: Areas, draft: "Draft", acts: "DraftActs"
) -> "Draft":
    """Return the draft of a script once acts on the lines of `draft` have been carried out.

    Raises:
        Invalid: An act names no line of the draft or can't be done, or sentences that are said
            for a line are not understood. Then none of the acts has an effect.
    """
    from argo_compiler.script import LineState

    decisions = draft.decide(acts)
    decided = load_draft(upload, site.catalog, *areas, decisions=decisions)
    said = {_place(draft.lines_named(label)[0]) for label, _ in acts.say}
    _require_understood(decided, said)
    others = [line.label for line in decided.left if line.state is LineState.OPEN]
    if said and others:
        # Lines that are not understood hide what only the mission as a whole shows, such as `it`
        # without anything that it refers to.
        alone = load_draft(upload, site.catalog, *areas, decisions=decided.set_aside(others))
        _require_understood(alone, said)
    return decided


def _require_understood(draft: "Draft", said: set[tuple[int, int]]) -> None:
    for line in draft.lines:
        if line.is_left and _place(line) in said:
            hint = f"; {line.hint}" if line.hint else ""
            raise Invalid(
                Message(
                    "line {label} of {source_name}: `{sentences}` is not understood: "
                    "{reason}{hint}",
                    label=line.label,
                    source_name=draft.source_name,
                    sentences=" ".join(line.sentences),
                    reason=line.reason,
                    hint=hint,
                )
            )


def _place(line: "DraftLine") -> tuple[int, int]:
    return line.line, line.part
