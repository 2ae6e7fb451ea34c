"""Codes of diagnostics about parts of a mission that an export format can't express."""

from argo_compiler.diagnostics.codes.code import error

EXPORT = {
    "export.backward": error(
        "A transition or a failure leads back outside of a group's rounds; behaviour trees have no "
        "such edges.",
        "Put the tasks in between into a group.",
    ),
    "export.every": error(
        "A group starts its rounds at set times, which this format can't express.",
        "Let the rounds follow each other, or export SCXML.",
    ),
    "export.isar-empty": error(
        "The mission has no tasks, which isar does not allow.", "Measure something."
    ),
    "export.isar-endless": error(
        "The mission has too many tasks when its rounds are written out, as isar needs them.",
        "Limit its groups, and lead no transition back.",
    ),
    "export.isar-group": error(
        "A group is not limited by a number of rounds; isar has no other limit.",
        "Limit it by `max_repeat_count`.",
    ),
    "export.isar-mode": error(
        "The mission is supervisory; isar has only autonomous missions.", "Plan it as autonomous."
    ),
    "export.isar-no-target": error(
        "The position of a checkpoint is unknown, and isar needs a point to look at.",
        "Export with the site that has the checkpoint.",
    ),
    "export.isar-reaction": error(
        "The mission has a reaction; missions of isar have none.",
        "Remove the reaction; isar's own state machine reacts to events.",
    ),
    "export.isar-task": error(
        "A task has a property that isar's tasks do not have.",
        "Remove the property, or export to a format that has it.",
    ),
    "export.isar-waypoint": error(
        "A task only drives; isar's tasks are inspections.",
        "Remove it, or measure a checkpoint there.",
    ),
    "export.name": error(
        "BehaviorTree.CPP would not read a name as text.",
        "Choose a name without braces, semicolons and `json:`.",
    ),
    "export.not-text": error(
        "A text of the mission can't be written as UTF-8.", "Remove the invalid characters."
    ),
    "export.number-too-large": error(
        "A number does not fit into the field of the message.", "Use a smaller number."
    ),
    "export.reaction": error(
        "A reaction can't be expressed in this format.",
        "Let the robot's own tree or behaviour react, with the mission's inside it.",
    ),
    "export.velocity": error(
        "A message has one velocity for all drives from a task, but the tasks that follow have "
        "different ones.",
        "Give all tasks that may follow the same task one velocity.",
    ),
    "export.supervisory": error(
        "The mission starts paused, which this format can't express.", "Plan it as autonomous."
    ),
    "export.too-long": error(
        "A duration is longer than a node of BehaviorTree.CPP allows.", "Shorten it."
    ),
    "export.wait": error(
        "A task waits for an event or for conditions, which this format can't express.",
        "Wait for a time, or export SCXML.",
    ),
    "export.window": error(
        "A task has a window that this format can't express.",
        "Make it soft, or export SCXML.",
    ),
}
