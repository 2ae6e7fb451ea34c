"""Edits of a mission's reactions, each of which is identified by its event."""

from argo_compiler.base.message import Message
from argo_compiler.diagnostics import diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, checked_edit_result
from argo_compiler.editing.errors import EditNotFound, conflict, require_kind
from argo_compiler.il import EventKind, Mission, Reaction


def add_reaction(mission: Mission, reaction: Reaction) -> Edited:
    """Add a reaction to an event that has none.

    Raises:
        EditConflict: the event already has a reaction, or the mission has no dock to return to.
        EditInvalid: the reaction is invalid for every mission.
    """
    require_kind(reaction, Reaction, Message("the reaction"))
    _require_free(mission, reaction.event)
    return checked_edit_result(
        mission, mission.model_copy(update={"reactions": (*mission.reactions, reaction)})
    )


def change_reaction(mission: Mission, event: EventKind, reaction: Reaction) -> Edited:
    """Replace the reaction to `event`, in its place; the new one may be to another event.

    Raises EditNotFound if the event has no reaction, and the errors of `add_reaction`.
    """
    require_kind(reaction, Reaction, Message("the reaction"))
    at = _reaction_index(mission, event)
    if reaction.event != event:
        _require_free(mission, reaction.event)
    others = mission.reactions
    changed = mission.model_copy(update={"reactions": (*others[:at], reaction, *others[at + 1 :])})
    return checked_edit_result(mission, changed)


def remove_reaction(mission: Mission, event: EventKind) -> Edited:
    """Remove the reaction to an event. Raises EditNotFound if there is none."""
    at = _reaction_index(mission, event)
    others = mission.reactions
    return checked_edit_result(
        mission, mission.model_copy(update={"reactions": (*others[:at], *others[at + 1 :])})
    )


def _reaction_index(mission: Mission, event: EventKind) -> int:
    for i, reaction in enumerate(mission.reactions):
        if reaction.event == event:
            return i
    known = tuple(reaction.event for reaction in mission.reactions) or Message("none")
    message = Message("the mission has no reaction to {event}", event=event)
    hint = Message("it has reactions to: {known}", known=known)
    raise EditNotFound([diagnostic_of("edit.unknown-reaction", message, hint)])


def _require_free(mission: Mission, event: EventKind) -> None:
    if any(reaction.event == event for reaction in mission.reactions):
        message = Message("a reaction to {event} already exists", event=event)
        hint = Message("change that reaction, or remove it first")
        raise conflict("edit.second-reaction", message, hint, subject_of("reactions", event))
