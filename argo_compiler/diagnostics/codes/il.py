"""Codes of diagnostics about the structure of missions."""

from argo_compiler.diagnostics.codes.code import error, warning

IL = {
    "il.all-clear-elsewhere": warning(
        "A reaction to a gas leak drives away and waits for the all-clear without a limit; if "
        "neither gas nor hiss reaches that place, the robot can't give the all-clear there.",
        "Limit the wait, such as `until all clear for at most 10 minutes`, or pause where the leak "
        "is noticed.",
    ),
    "il.all-clear-not-sensed": warning(
        "A reaction waits for the all-clear without a limit, but the robot gives one only after a "
        "gas leak or the platform alarm.",
        "Limit the wait, such as `until all clear for at most 10 minutes`.",
    ),
    "il.battery-level": error(
        "A reaction has a battery level, but its event is not LOW_BATTERY.",
        "Leave `battery_below` out, or let the reaction respond to `low_battery`.",
    ),
    "il.before-itself": error(
        "Pairs of `before` form a circle.", "Remove one of the pairs from `before`."
    ),
    "il.branch-without-target": error(
        "A task leads elsewhere when it has failed, but has no target for this case.",
        "Give it a `failure_target`, or another `on_failure`.",
    ),
    "il.charge-after-limit": error(
        "The battery is to be charged for longer than the hold or the wait may last.",
        "Allow more time in `hold_limit` or `limit`, or charge for a shorter time.",
    ),
    "il.charge-below-level": error(
        "The battery is charged to a level at which the robot still calls it low.",
        "Charge to a higher level than `battery_below`.",
    ),
    "il.charge-without-wait": error(
        "A level or a least time of charging is given for something else than a wait for "
        "BATTERY_CHARGED.",
        "Wait for `battery_charged`, or leave `charge_to` and `charge_for` out.",
    ),
    "il.condition-bound": error(
        "A LESS, GREATER or WITHIN condition has no bound.",
        "Give the bound that the value is compared with as `param1`.",
    ),
    "il.duplicate-group": error(
        "Two groups have the same name.", "Give each group a name of its own."
    ),
    "il.duplicate-reaction": error(
        "Two reactions respond to the same event.", "Keep one reaction for each event."
    ),
    "il.duplicate-task": error(
        "Two tasks have the same name, by which transitions and groups refer to them.",
        "Give each task a name of its own.",
    ),
    "il.empty-mission": error(
        "The mission has no tasks.",
        "Add a task; a mission that does nothing has a START task only.",
    ),
    "il.endless-group": error(
        "A group is repeated for ever: it has neither a count nor a duration, no transition that "
        "can be taken leaves it, and no group around it runs out of time.",
        "Give it `max_repeat_count` or `max_repeat_duration`, or a conditional transition out of "
        "it.",
    ),
    "il.equal-priority": warning(
        "Two reactions have the same priority: the one whose event occurs later waits until the "
        "other has ended.",
        "Give the more urgent one the higher `priority`; ABORT and the reaction to an emergency "
        "stop need none.",
    ),
    "il.group-duration": error(
        "The time of a group with `stop` hard ends before any action could be executed.",
        "Allow it at least a millisecond, or 0 for no limit.",
    ),
    "il.group-name": error(
        "A part of a group's name is empty.",
        "Separate the names of nested groups by one `/`, as in `Alpha/Beta`.",
    ),
    "il.group-order": error(
        "A group's start comes after its end in the list of tasks.",
        "Swap its start and end, or reorder the tasks.",
    ),
    "il.group-outside-parent": error(
        "A group extends beyond the outer group in its name.",
        "Keep its tasks within those of the outer group.",
    ),
    "il.group-overlap": error(
        "Two groups share tasks, and neither name states that one is inside the other.",
        "Name the inner one `Outer/Inner`, or separate their tasks.",
    ),
    "il.group-parent": error(
        "The outer group in a group's name does not exist.",
        "Add the outer group, or remove the `/` from its name.",
    ),
    "il.group-period": error(
        "The rounds of a group would start faster than any could end.",
        "Set `every` to at least one second, or to 0 for rounds without a pause.",
    ),
    "il.group-same-range": error(
        "Two groups have the same tasks, and neither name states which one is the inner one.",
        "Name the inner one `Outer/Inner`.",
    ),
    "il.instant-loop": error(
        "Nothing in a loop takes any time, so the mission might run through it for ever at one "
        "moment.",
        "Give a WAIT in it a duration, give the group `every` or few rounds, or remove a hard "
        "window.",
    ),
    "il.joint-states": error(
        "A task's joint states have no values, not one value for each joint, or a joint twice.",
        "Give one position, velocity or effort for each joint, or none of that kind, and name each "
        "joint once.",
    ),
    "il.leaves-round": warning(
        "A branch leaves a repeated group before the end of a round; its remaining rounds are "
        "skipped.",
        "Lead it to the group's end if the rounds are to be completed; otherwise do nothing.",
    ),
    "il.left-out": warning(
        "Tasks were left out when the mission's order was chosen, because they did not fit into "
        "its time.",
        "Allow more time and choose the order again, or make another mission of them.",
    ),
    "il.many-retries": warning(
        "A failed action would be tried again so often that the mission seems to hang.",
        "A few retries are enough; define by `on_failure` what follows.",
    ),
    "il.many-starts": error(
        "There is more than one START task.", "Remove all START tasks but one."
    ),
    "il.many-unconditional": error(
        "A task has more than one unconditional transition.",
        "Keep one and give the others conditions.",
    ),
    "il.measure-without-object": error(
        "A MEASURE task does not state what it measures.",
        "Give it the checkpoint's number as `object_id`.",
    ),
    "il.never-measured": warning(
        "A condition compares a checkpoint that no task measures, so it is never true.",
        "Measure the checkpoint before the task with the condition.",
    ),
    "il.no-dock": error(
        "The robot has to return after a failure or an event, but the mission has no `dock`.",
        "Give the mission the pose of the docking station as `dock`.",
    ),
    "il.no-unconditional": warning(
        "The mission ends after a task if none of its conditions is true.",
        "Add an unconditional transition if the mission is to continue.",
    ),
    "il.not-lost-before": warning(
        "A reaction waits without a limit until the connection is restored, but its event is not "
        "that the connection was lost.",
        "Wait for another event, or limit the wait.",
    ),
    "il.order-broken": warning(
        "A task that must come before another one can come after it. An error if the order is "
        "precise and it always comes after it.",
        "Move one of them, have the order chosen again, or remove the pair from `before`.",
    ),
    "il.other-site": error(
        "The mission was planned for another site, so its poses and checkpoints are wrong here.",
        "Choose the mission's site.",
    ),
    "il.reserved-name": error(
        "A task has a name that Argo reserves for drives after failures and for reactions.",
        "Give the task another name.",
    ),
    "il.safe-area-without-pose": error(
        "A SAFE_AREA reaction does not state where the safe area is.", "Give the reaction a `pose`."
    ),
    "il.stale-without-age": error(
        "A STALE condition does not state from which age on a value is stale.",
        "Give it a `max_age` in seconds.",
    ),
    "il.start-as-target": error(
        "A transition leads to the START task, which is only where the mission begins.",
        "Lead it to the task that follows START.",
    ),
    "il.start-condition": warning(
        "A conditional transition of START is never taken, because nothing has been measured yet.",
        "Remove it.",
    ),
    "il.start-in-group": error(
        "The START task is in a group, but can't be repeated.", "Move START before the group."
    ),
    "il.time-up-without-limit": warning(
        "A reaction waits for TIME_UP, which never occurs without a `max_duration` of the mission.",
        "Give the mission a `max_duration`, or use another event.",
    ),
    "il.unknown-area": error(
        "The mission begins or ends in a starting area that the site does not have.",
        "Use the number of one of the site's starting areas.",
    ),
    "il.unknown-before": error(
        "A pair of `before` names a task that the mission does not have.",
        "Name a task, or remove the pair.",
    ),
    "il.unknown-current": warning(
        "`current` names no task of the mission.",
        "Name a task or leave `current` out; only the planner uses it.",
    ),
    "il.unknown-group-task": error(
        "A group starts or ends with a task that the mission does not have.",
        "Use names of tasks as the group's start and end.",
    ),
    "il.unknown-object": error(
        "A task names a checkpoint that the site does not have.",
        "Use the number of a checkpoint of the site.",
    ),
    "il.unknown-target": error(
        "A transition leads to a task that the mission does not have.",
        "Add such a task, or lead the transition to another one.",
    ),
    "il.until-answered": warning(
        "A reaction waits for an event that itself has a reaction of higher priority, which is "
        "executed instead.",
        "Wait for another event, or give this reaction the higher priority.",
    ),
    "il.until-itself": error(
        "A reaction waits for the same event that it responds to; while it is active, that event "
        "has no effect.",
        "Wait for an event that ends the danger, such as all_clear.",
    ),
    "il.unused-field": warning(
        "A field is given where it has no effect.",
        "Remove it, or change the part that it should have an effect on.",
    ),
    "il.wait-rule": error(
        "A WAIT does not state how long it lasts, or states it in two ways.",
        "Give its `wait` a `duration`, or else an `event`, `conditions` or both.",
    ),
    "il.wait-without-limit": warning(
        "A WAIT for an event or a value has no limit: it may last for ever.",
        "Give its `wait` a `limit`, and the task an `on_failure`.",
    ),
    "il.window-order": error(
        "A time window ends before it begins, so the task can't be done in it.",
        "Set `latest` to a time after `earliest`; both count from the mission's start in seconds.",
    ),
    "il.waypoint-without-pose": error(
        "A WAYPOINT task does not state where it leads.", "Give it a `pose`."
    ),
    "il.within-bounds": error(
        "A WITHIN condition has no upper bound, or no value lies between its bounds.",
        "`param1` is the lower bound, `param2` the upper one.",
    ),
}
