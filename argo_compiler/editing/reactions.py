"""Edits of a mission's reactions, which go by their events."""

from argo_compiler.diagnostics import diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.refusals import EditNotFound, conflict, require_kind
from argo_compiler.il import EventKind, Mission, Reaction


def add_reaction(mission: Mission, reaction: Reaction) -> Edited:
    """The mission with a reaction to one more event.

    Raises:
        EditConflict: there is a reaction to this event, or the mission has no dock to return to.
        EditInvalid: the reaction makes no sense.
    """
    require_kind(reaction, Reaction, "the reaction")
    _require_free(mission, reaction.event)
    return edited(mission, mission.model_copy(update={"reactions": (*mission.reactions, reaction)}))


def change_reaction(mission: Mission, event: EventKind, reaction: Reaction) -> Edited:
    """The mission with another reaction in the place of the one to an event.

    Raises EditNotFound if there is none, and as `add_reaction` does.
    """
    require_kind(reaction, Reaction, "the reaction")
    at = _index(mission, event)
    if reaction.event != event:
        _require_free(mission, reaction.event)
    others = mission.reactions
    made = mission.model_copy(update={"reactions": (*others[:at], reaction, *others[at + 1 :])})
    return edited(mission, made)


def remove_reaction(mission: Mission, event: EventKind) -> Edited:
    """The mission without the reaction to an event. Raises EditNotFound if there is none."""
    at = _index(mission, event)
    others = mission.reactions
    return edited(
        mission, mission.model_copy(update={"reactions": (*others[:at], *others[at + 1 :])})
    )


def _index(mission: Mission, event: EventKind) -> int:
    for i, reaction in enumerate(mission.reactions):
        if reaction.event == event:
            return i
    known = ", ".join(reaction.event for reaction in mission.reactions) or "none"
    message = f"the mission has no reaction to {event}"
    hint = f"it has reactions to: {known}"
    raise EditNotFound([diagnostic_of("edit.unknown-reaction", message, hint)])


def _require_free(mission: Mission, event: EventKind) -> None:
    if any(reaction.event == event for reaction in mission.reactions):
        message = f"there is a reaction to {event} already"
        hint = "change that one, or remove it first"
        raise conflict("edit.second-reaction", message, hint, subject_of("reactions", event))
