"""The codes of diagnostics when a mission goes on with a plan that was edited meanwhile."""

from argo_compiler.diagnostics.codes.code import error, warning

HANDOVER = {
    "handover.by-hand-gone": warning(
        "A task was done by hand that the plan does not have.",
        "Put it back into the plan if it is to count.",
    ),
    "handover.by-hand-value": warning(
        "A value was given for a task that measures nothing.",
        "Leave the value out, or give it for the task that measures it.",
    ),
    "handover.group-gone": warning(
        "A group with rounds under way is not around the present task any more.",
        "Keep the group if its rounds are to be completed.",
    ),
    "handover.new-group": warning(
        "A group is new around the present task, and begins in round 1.",
        "Set its round in the progress if it is to be another one.",
    ),
    "handover.no-return": error(
        "The robot is on its way back after a failure, but no task of the plan returns.",
        "Give a task `on_failure` return, or cancel the mission.",
    ),
    "handover.reaction-gone": warning(
        "The plan has no reaction any more to an event that interrupted the mission or waits.",
        "Put the reaction back, or resume the mission when it is safe to go on.",
    ),
    "handover.task-gone": error(
        "The plan does not have the task at which the mission stands.",
        "Put a task of that name back, or say in the progress with which task to go on.",
    ),
}
