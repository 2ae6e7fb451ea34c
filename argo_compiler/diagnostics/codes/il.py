"""The codes of diagnostics about the structure of missions."""

from argo_compiler.diagnostics.codes.code import error, warning

IL = {
    "il.battery-level": error(
        "A reaction has a level of the battery, and its event is not LOW_BATTERY.",
        "Leave `battery_below` out, or let the reaction answer `low_battery`.",
    ),
    "il.before-itself": error(
        "Tasks are to come before each other in a circle.", "Take one of the pairs out of `before`."
    ),
    "il.branch-without-target": error(
        "A task is to go on elsewhere when it has failed, and does not say where.",
        "Give it a `failure_target`, or another `on_failure`.",
    ),
    "il.condition-bound": error(
        "A LESS, GREATER or WITHIN condition has no bound.",
        "Give the bound that the value is compared with as `param1`.",
    ),
    "il.duplicate-group": error(
        "Two groups have the same name.", "Give each group a name of its own."
    ),
    "il.duplicate-reaction": error(
        "Two reactions answer the same event.", "Keep one reaction for each event."
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
        "other is over.",
        "Give the more urgent one the higher `priority`; ABORT and the reaction to an emergency "
        "stop need none.",
    ),
    "il.group-duration": error(
        "The time of a group with `stop` hard is up before any action could be carried out.",
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
        "A group reaches beyond the group that its name puts it in.",
        "Keep its tasks within those of the outer group.",
    ),
    "il.group-overlap": error(
        "Two groups share tasks, and neither name says that one lies in the other.",
        "Name the inner one `Outer/Inner`, or separate their tasks.",
    ),
    "il.group-parent": error(
        "A group is to lie in one that does not exist.",
        "Add the group around it, or take the `/` out of its name.",
    ),
    "il.group-period": error(
        "The rounds of a group are to follow each other faster than any could be over.",
        "Give `every` a second at least, or 0 for rounds without a pause.",
    ),
    "il.group-same-range": error(
        "Two groups have the same tasks, and neither name says which one lies inside.",
        "Name the inner one `Outer/Inner`.",
    ),
    "il.instant-loop": error(
        "Nothing on a way that leads round in a circle takes any time, so the mission might never "
        "come to the next moment.",
        "Let a WAIT on it last, give the group `every` or few rounds, or take a hard window away.",
    ),
    "il.joint-states": error(
        "The joints and positions, velocities or efforts of a task's joint states do not belong "
        "to each other.",
        "Give exactly one for each joint, or none at all, and each joint once.",
    ),
    "il.leaves-round": warning(
        "A branch leaves a repeated group before the end of its round, and with it the rounds that "
        "are left.",
        "Lead it to the group's end if the round is to be completed; else nothing is to be done.",
    ),
    "il.left-out": warning(
        "Tasks were taken away when the mission's order was chosen, as they did not fit into its "
        "time.",
        "Allow more time and choose the order anew, or make another mission of them.",
    ),
    "il.many-retries": warning(
        "A failed action would be tried again so often that the mission seems to hang.",
        "A few retries are enough; let `on_failure` say what comes then.",
    ),
    "il.many-starts": error(
        "There is more than one START task.", "Remove all START tasks but one."
    ),
    "il.many-unconditional": error(
        "A task has more than one unconditional transition.",
        "Keep one and give the others conditions.",
    ),
    "il.measure-without-object": error(
        "A MEASURE task does not say what it measures.",
        "Give it the checkpoint's number as `object_id`.",
    ),
    "il.never-measured": warning(
        "A condition compares a checkpoint that no task measures, so it never holds.",
        "Measure the checkpoint before the task with the condition.",
    ),
    "il.no-dock": error(
        "The robot is to return after a failure or an event, but the mission has no `dock`.",
        "Give the mission the pose of the docking station as `dock`.",
    ),
    "il.no-unconditional": warning(
        "The mission ends after a task if none of its conditions hold.",
        "Add an unconditional transition if it is to go on.",
    ),
    "il.order-broken": warning(
        "A task that is to come before another one can come after it. An error in a precise order "
        "where it always does.",
        "Move one of them, have the order chosen anew, or take the pair out of `before`.",
    ),
    "il.other-site": error(
        "The mission was planned for another site, so its poses and checkpoints mean others here.",
        "Choose the mission's site.",
    ),
    "il.reserved-name": error(
        "A task has a name that the machine needs for the drives of failures and reactions.",
        "Give the task another name.",
    ),
    "il.safe-area-without-pose": error(
        "A SAFE_AREA reaction does not say where the safe area is.", "Give the reaction a `pose`."
    ),
    "il.stale-without-age": error(
        "A STALE condition does not say from which age on a value is stale.",
        "Give it a `max_age` in seconds.",
    ),
    "il.start-as-target": error(
        "A transition leads to the START task, which is only where the mission begins.",
        "Lead it to the task that follows START.",
    ),
    "il.start-condition": warning(
        "A conditional transition of START is never taken, as nothing has been measured yet.",
        "Remove it.",
    ),
    "il.start-in-group": error(
        "The START task lies in a group, but is not repeated.", "Move START before the group."
    ),
    "il.time-up-without-limit": warning(
        "A reaction waits for TIME_UP, which never occurs, as the mission has no `max_duration`.",
        "Give the mission a `max_duration`, or use another event.",
    ),
    "il.unknown-area": error(
        "The mission begins or ends in a starting area that the site does not have.",
        "Use the number of one of the site's starting areas.",
    ),
    "il.unknown-before": error(
        "A pair of `before` names a task that the mission does not have.",
        "Name a task, or take the pair out.",
    ),
    "il.unknown-current": warning(
        "`current` names no task of the mission.",
        "Name a task or leave `current` out; only the planner uses it.",
    ),
    "il.unknown-group-task": error(
        "A group begins or ends with what is no task of the mission.",
        "Use names of tasks as the group's start and end.",
    ),
    "il.unknown-object": error(
        "A task names a checkpoint that the site does not have.",
        "Use the number of a checkpoint of the site.",
    ),
    "il.unknown-target": error(
        "A transition leads to what is no task of the mission.",
        "Add such a task, or lead the transition to another one.",
    ),
    "il.until-answered": warning(
        "A reaction waits for an event that has a reaction of higher priority of its own, which is "
        "carried out instead.",
        "Wait for another event, or give this reaction the higher priority.",
    ),
    "il.until-itself": error(
        "A reaction waits for the very event that it answers; while it is active, that event "
        "changes nothing.",
        "Wait for an event that tells that the danger is over, such as all_clear.",
    ),
    "il.unused-field": warning(
        "A field is given where it has no effect.",
        "Remove it, or change what it should have an effect on.",
    ),
    "il.wait-rule": error(
        "A WAIT does not say how long it lasts, or says it in two ways.",
        "Give its `wait` a `duration`, or else an `event`, `conditions` or both.",
    ),
    "il.wait-without-limit": warning(
        "A WAIT for an event or a value has no limit: if that never comes, it lasts for ever.",
        "Give its `wait` a `limit`, and the task an `on_failure`.",
    ),
    "il.window-order": error(
        "A time window ends before it begins, so the task can't be done in it.",
        "`latest` comes after `earliest`; both count from the mission's start in seconds.",
    ),
    "il.waypoint-without-pose": error(
        "A WAYPOINT task does not say where it leads.", "Give it a `pose`."
    ),
    "il.within-bounds": error(
        "A WITHIN condition has no upper bound, or no value lies between its bounds.",
        "`param1` is the lower bound, `param2` the upper one.",
    ),
}
