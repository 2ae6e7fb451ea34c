"""The codes of diagnostics of the analysis over all paths."""

from argo_compiler.diagnostics.codes.code import error, warning

ANALYSIS = {
    "analysis.always-stale": warning(
        "A condition asks for a value younger than any that can have been measured by then.",
        "Measure the checkpoint again before the condition, or allow a greater age.",
    ),
    "analysis.battery-exceeded": error(
        "Even the path that needs the least energy needs more than the battery gives.",
        "Leave out tasks or rounds, or charge in between.",
    ),
    "analysis.battery-maybe-exceeded": warning(
        "Some path needs more energy than the battery gives.",
        "Limit what is repeated, or react to `low_battery`.",
    ),
    "analysis.cut-short": warning(
        "The plan may take longer than the mission's maximum duration, and a reaction to `time_up` "
        "ends it then.",
        "Leave out tasks, shorten groups, or allow more time.",
    ),
    "analysis.end-elsewhere": warning(
        "The mission is to end docked, but some path ends in another place.",
        "Let each path end with a WAYPOINT task at the dock.",
    ),
    "analysis.endless-loop": error(
        "Tasks follow each other for ever once they are reached.",
        "Give a transition that leaves them, or make them a group with a limit.",
    ),
    "analysis.kept-loop": warning(
        "Tasks follow each other for ever with some reading, as none of them measures it again.",
        "Measure the checkpoint in the loop, or make it a group with a limit.",
    ),
    "analysis.maybe-too-long": warning(
        "Some path takes longer than the mission's maximum duration.",
        "Limit what is repeated, or say by a reaction to `time_up` what happens then.",
    ),
    "analysis.maybe-unmeasured": warning(
        "A condition compares a checkpoint that has no value yet on some paths, where it is false.",
        "Measure the checkpoint on every path to the task.",
    ),
    "analysis.never-measured": warning(
        "A condition compares a checkpoint that no path to it has measured, so it never holds.",
        "Measure the checkpoint earlier, or compare another one.",
    ),
    "analysis.no-end": error(
        "No path leads to the end of the mission.",
        "Let some task have no unconditional transition, or leave the loop.",
    ),
    "analysis.no-way-back": warning(
        "On some path the battery may not suffice for the way back to the dock with a reserve.",
        "Leave out tasks or rounds, charge in between, or react to `low_battery`.",
    ),
    "analysis.time-limit": warning(
        "A task without retries takes longer than its time limit, as planned.",
        "Give it more time.",
    ),
    "analysis.too-long": error(
        "Even the shortest path takes longer than the mission's maximum duration.",
        "Leave out tasks, shorten groups, or allow more time.",
    ),
    "analysis.too-many-places": warning(
        "The mission goes to so many different places that times and energy are not looked at.",
        "Divide it into several missions.",
    ),
    "analysis.transition-always": warning(
        "A condition holds for every value that can be measured, so what comes after it is "
        "never looked at.",
        "Correct its bounds, or take the condition away.",
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
        "The robot can't get to a place of the mission, or can't read a checkpoint from anywhere.",
        "Choose another place or checkpoint, or remove the task.",
    ),
    "analysis.unreachable-task": warning(
        "No path leads to a task.",
        "Lead a transition to it that can be taken, or remove the task.",
    ),
    "analysis.window-late": warning(
        "No path is in time for a task, which is done all the same.",
        "Do it earlier, or let its window end later.",
    ),
    "analysis.window-maybe-missed": warning(
        "Some path may be too late for a task.",
        "Do it earlier, or let its window end later.",
    ),
    "analysis.window-missed": error(
        "No path is in time for a task, if nothing fails.",
        "Do it earlier, or let its window end later.",
    ),
}
