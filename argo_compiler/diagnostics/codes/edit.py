"""Codes of the reasons why an edit is refused."""

from argo_compiler.diagnostics.codes.code import error

EDIT = {
    "edit.ambiguous-task": error(
        "An edit names a task, and more than one task of the mission has this name.",
        "Give each task a name of its own first.",
    ),
    "edit.beginning": error(
        "Without the task the mission would begin with the wrong task.",
        "Lead a START task to the right task, or move that task to the front.",
    ),
    "edit.ends-by-condition": error(
        "The mission ends after the task, and a conditional transition leads to it. Without the "
        "task the condition would have to end the mission, which no condition can.",
        "Lead that transition to another task first.",
    ),
    "edit.ends-round": error(
        "Another task would end the rounds of a group, but they can't end with it: a task of the "
        "group leads elsewhere.",
        "Lead only the unconditional transition of the last task but one to the group's last task, "
        "or end the group elsewhere.",
    ),
    "edit.group-name": error(
        "A group's own name is empty or has a `/`.",
        "Give it a name without `/`: the name of the group around it is added as a prefix.",
    ),
    "edit.group-order": error(
        "A group would end before it starts.",
        "Swap its start and end, or move a task.",
    ),
    "edit.group-overlap": error(
        "A group would overlap another one, or its position would contradict its name.",
        "Nest one completely in the other, or dissolve the other one first.",
    ),
    "edit.last-task": error(
        "The only task of a mission can't be removed.",
        "Add another one first; a mission that does nothing has a START task only.",
    ),
    "edit.leaves-group": error(
        "Through the task another one leaves a group and enters it again; without the task it "
        "would jump inside the round.",
        "Lead the other task elsewhere first.",
    ),
    "edit.name-taken": error(
        "The new name is already that of another task or group.",
        "Choose another name, or rename the other one.",
    ),
    "edit.not-beside-group": error(
        "A task is added to a group that does not extend to its position.",
        "Choose a position next to a task of the group.",
    ),
    "edit.place": error(
        "The position of a task is given twice, or relative to the task itself.",
        "Name one other task that it comes before or after.",
    ),
    "edit.second-default": error(
        "A task would have two unconditional transitions.",
        "Give one of them a condition, or remove one.",
    ),
    "edit.second-reaction": error(
        "A reaction to this event already exists.",
        "Change that reaction, or remove it first.",
    ),
    "edit.start-in-group": error(
        "A START task would be in a group.",
        "Move START before the group: START can't be repeated.",
    ),
    "edit.starts-round": error(
        "The task starts the rounds of a group, but does not lead to the next task of the list, "
        "with which they would start without it.",
        "Lead it to the next task first, or change where the group starts.",
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
