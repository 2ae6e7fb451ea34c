"""Codes of diagnostics about continuing a mission with a mission plan that was edited meanwhile."""

from argo_compiler.diagnostics.codes.code import error, warning

HANDOVER = {
    "handover.by-hand-gone": warning(
        "A task that was done by hand is not in the edited mission plan.",
        "Add it to the mission plan again if it is to count.",
    ),
    "handover.by-hand-value": warning(
        "A value was given for a task that measures nothing.",
        "Leave the value out, or give it for the task that measures it.",
    ),
    "handover.group-gone": warning(
        "A group whose rounds are under way no longer contains the current task.",
        "Keep the group if its rounds are to be completed.",
    ),
    "handover.new-group": warning(
        "A new group contains the current task, and starts in round 1.",
        "Set its round in the progress to start in another one.",
    ),
    "handover.no-return": error(
        "The robot is on its way back after a failure, but no task of the mission plan returns.",
        "Give a task `on_failure` return, or cancel the mission.",
    ),
    "handover.reaction-gone": warning(
        "The mission plan no longer has a reaction to an event that interrupted the mission or is "
        "waiting.",
        "Put the reaction back, or resume the mission when it is safe to continue.",
    ),
    "handover.task-gone": error(
        "The mission plan does not have the task that the mission has reached.",
        "Put a task of that name back, or set in the progress the task to continue with.",
    ),
}
