"""Codes of diagnostics of the analysis of all execution paths."""

from argo_compiler.diagnostics.codes.code import error, warning

ANALYSIS = {
    "analysis.always-stale": warning(
        "A condition requires a newer value than can have been measured at that time.",
        "Measure the checkpoint again before the condition, or allow a greater age.",
    ),
    "analysis.battery-exceeded": error(
        "Even the execution path that needs the least energy needs more than the battery gives.",
        "Leave out tasks or rounds, or charge in between.",
    ),
    "analysis.battery-maybe-exceeded": warning(
        "Some execution path needs more energy than the battery gives.",
        "Limit repetitions, or react to `low_battery`.",
    ),
    "analysis.charge-cut-short": warning(
        "The reaction to a low battery continues the mission before the battery is charged as far "
        "as it has to be.",
        "Allow more time in `hold_limit`, or charge to a lower level (`charge_to`).",
    ),
    "analysis.charge-elsewhere": warning(
        "A reaction or a WAIT waits until the battery is charged where nothing charges it.",
        "Let the robot return to the docking station before.",
    ),
    "analysis.charge-too-low": warning(
        "The reaction to a low battery charges it to a level that the robot calls low.",
        "Charge to a higher level (`charge_to`), or react to a lower one (`battery_below`).",
    ),
    "analysis.charging-too-long": warning(
        "Charging a low battery alone takes longer than the mission's maximum duration.",
        "Charge to a lower level (`charge_to`), or allow more time.",
    ),
    "analysis.cut-short": warning(
        "The mission may take longer than its maximum duration, and a reaction to `time_up` then "
        "ends it.",
        "Leave out tasks, shorten groups, or allow more time.",
    ),
    "analysis.end-elsewhere": warning(
        "The mission has to end at the dock, but some execution path ends elsewhere.",
        "Let each execution path end with a WAYPOINT task at the dock.",
    ),
    "analysis.endless-loop": error(
        "Tasks repeat for ever once they are reached.",
        "Give a transition that leaves them, or make them a group with a limit.",
    ),
    "analysis.kept-loop": warning(
        "Tasks repeat for ever with some reading, because none of them measures it again.",
        "Measure the checkpoint in the loop, or make it a group with a limit.",
    ),
    "analysis.loop-until-window": warning(
        "Tasks may be repeated until a hard time window closes, and nothing else limits that.",
        "Make them a group with a limit.",
    ),
    "analysis.maybe-too-long": warning(
        "Some execution path takes longer than the mission's maximum duration.",
        "Limit repetitions, or define by a reaction to `time_up` what happens then.",
    ),
    "analysis.maybe-unmeasured": warning(
        "A condition compares a checkpoint that has no value yet on some execution paths; "
        "on them the condition is false.",
        "Measure the checkpoint on every execution path to the task.",
    ),
    "analysis.never-measured": warning(
        "A condition compares a checkpoint that no execution path to it has measured, so it is "
        "never true.",
        "Measure the checkpoint earlier, or compare another one.",
    ),
    "analysis.no-end": error(
        "No execution path leads to the end of the mission.",
        "Remove an unconditional transition where the mission is to end, or leave the loop.",
    ),
    "analysis.no-way-back": warning(
        "On some execution path the battery may not suffice for the drive back to the dock with a "
        "reserve.",
        "Leave out tasks or rounds, charge in between, or react to `low_battery`.",
    ),
    "analysis.not-charged": warning(
        "The reaction to a low battery returns to the docking station, and goes on uncharged.",
        "Wait until the battery is charged (`until`).",
    ),
    "analysis.time-limit": warning(
        "A task without retries takes longer than its time limit, even as planned.",
        "Give it more time.",
    ),
    "analysis.too-long": error(
        "Even the shortest execution path takes longer than the mission's maximum duration.",
        "Leave out tasks, shorten groups, or allow more time.",
    ),
    "analysis.too-many-places": warning(
        "The mission goes to so many different poses that times and energy are not analysed.",
        "Divide it into several missions.",
    ),
    "analysis.transition-always": warning(
        "A condition is true for every value that can be measured, so the later transitions of "
        "its task are never taken.",
        "Correct its bounds, or remove the condition.",
    ),
    "analysis.transition-never": warning(
        "A transition can't be taken, whatever is measured.",
        "Correct its bounds, move it before the transition that covers them, or remove it.",
    ),
    "analysis.unbounded-loop": warning(
        "Tasks may be repeated without limit, so no duration of the mission can be promised.",
        "Make them a group with `max_repeat_count` or `max_repeat_duration`.",
    ),
    "analysis.unreachable-place": error(
        "The robot can't reach a pose of the mission, or can't read a checkpoint from any pose.",
        "Choose another pose or checkpoint, or remove the task.",
    ),
    "analysis.unreachable-task": warning(
        "No execution path leads to a task, so it is never done.",
        "Add a transition to it that can be taken, or remove the task.",
    ),
    "analysis.window-late": warning(
        "No execution path reaches a task within its window; the task is done nevertheless.",
        "Do it earlier, or let its window end later.",
    ),
    "analysis.window-maybe-missed": warning(
        "Some execution path may be too late for the window of a task.",
        "Do it earlier, or let its window end later.",
    ),
    "analysis.window-missed": error(
        "A task ends after its window on every execution path, even if nothing fails.",
        "Do it earlier, or let its window end later.",
    ),
}
