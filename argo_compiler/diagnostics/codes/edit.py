"""The codes of what stands in the way of an edit."""

from argo_compiler.diagnostics.codes.code import error

EDIT = {
    "edit.ambiguous-task": error(
        "An edit names a task, and more than one task of the mission has this name.",
        "Give each task a name of its own first.",
    ),
    "edit.beginning": error(
        "Without the task the mission would begin with another one than it should.",
        "Lead a START task to where it is to begin, or move that task to the front.",
    ),
    "edit.ends-by-condition": error(
        "The mission ends after the task, and a transition with conditions leads to it; without "
        "the task that condition would have to end the mission, which no condition can.",
        "Lead that transition to another task first.",
    ),
    "edit.ends-round": error(
        "Another task would end the rounds of a group, and they can't end with it: a task of the "
        "group leads elsewhere.",
        "Lead only the unconditional transition of the task before the group's last to that one, "
        "or end the group elsewhere.",
    ),
    "edit.group-name": error(
        "A group's own name is empty or has a `/`.",
        "Give it a name without `/`: that of the group around it is put before it.",
    ),
    "edit.group-order": error(
        "A group is to end before it starts.",
        "Swap its start and end, or move a task.",
    ),
    "edit.group-overlap": error(
        "A group would overlap another one, or no longer lie where its name says.",
        "Let one lie in the other as a whole, or dissolve the other one first.",
    ),
    "edit.last-task": error(
        "The only task of a mission can't be removed.",
        "Add another one first; a mission that does nothing has a START task only.",
    ),
    "edit.leaves-group": error(
        "By way of the task another one leaves a group and enters it anew; without it that would "
        "be a jump inside the round.",
        "Lead the other task elsewhere first.",
    ),
    "edit.name-taken": error(
        "The name that something is to have is that of another task or group.",
        "Choose another name, or rename the other one.",
    ),
    "edit.not-beside-group": error(
        "A task is to stand in a group that does not reach to its place.",
        "Choose a place beside a task of the group.",
    ),
    "edit.place": error(
        "The place for a task is given twice, or as before or after itself.",
        "Name one other task before or after which it is to stand.",
    ),
    "edit.second-default": error(
        "A task would have two unconditional transitions.",
        "Give one of them a condition, or remove one.",
    ),
    "edit.second-reaction": error(
        "There is a reaction to this event already.",
        "Change that one, or remove it first.",
    ),
    "edit.start-in-group": error(
        "A START task would lie in a group.",
        "Move START before the group: it is not repeated.",
    ),
    "edit.starts-round": error(
        "The task begins the rounds of a group and leads to another task than the one behind it, "
        "with which they would begin.",
        "Lead it to the task behind it first, or change where the group starts.",
    ),
    "edit.unknown-condition": error(
        "A transition has no condition at this position.",
        "Count its conditions from 0.",
    ),
    "edit.unknown-group": error(
        "An edit names a group that the mission does not have.",
        "Name a group of the mission, with the names of the groups around it.",
    ),
    "edit.unknown-reaction": error(
        "An edit names an event to which the mission has no reaction.",
        "Name an event that the mission reacts to, or add a reaction.",
    ),
    "edit.unknown-task": error(
        "An edit names a task that the mission does not have.",
        "Name a task of the mission.",
    ),
    "edit.unknown-transition": error(
        "A task has no transition at this position.",
        "Count its transitions from 0.",
    ),
    "edit.value": error(
        "An edit gives a field a value that it can't have.",
        "Give it a value that the mission format allows.",
    ),
}
