"""State of a mission that its FlexBE states share: a dictionary in the userdata `memory`."""


def new_memory(to):
    """Return the memory at the start of a mission whose first target is `to`.

    `to` holds the target of the last transition: the number of a task; or -1 for the end of a round
    of the outermost group, -2 for the next group inside, and so on; or `end` or `aborted`. `groups`
    lists the groups that have been entered, from the outermost to the innermost. `readings` maps
    each checkpoint to its last measurement: the result (value, unreadable, unreachable or
    failed), the time, the value, and whether it is abnormal. `failures` is True if a task that is
    not optional has failed with all retries.
    """
    return {"to": to, "readings": {}, "groups": [], "failures": False}


def is_satisfied(condition, memory, now):
    """Return True if the condition (kind, object_id, low, high, inclusive, max_age) is satisfied.

    The kind is `value`, which compares the reading with its bounds (None: no bound), or one of
    `unreadable`, `unreachable`, `failed`, `stale` and `abnormal`.
    """
    kind, object_id, low, high, inclusive, max_age = condition
    if object_id not in memory["readings"]:
        return False
    result, time, value, abnormal = memory["readings"][object_id]
    if kind in ("unreadable", "unreachable"):
        return result == kind
    if kind == "failed":
        return result != "value"
    old = max_age is not None and now - time > max_age
    if kind == "stale" or result != "value" or old:
        return kind == "stale" and result == "value" and old
    if kind == "abnormal":
        return abnormal
    if inclusive:
        return (low is None or low <= value) and (high is None or value <= high)
    return (low is None or low < value) and (high is None or value < high)


def time_up(depth, memory, now):
    """Return the target after the time-out of a containing group, or None if no time is up.

    `depth` is the number of groups to check, from the outermost. If the time of several groups is
    up, the group whose time ended first determines the target.
    """
    ends = [
        (group["entered"] + group["limit"], -number)
        for number, group in enumerate(memory["groups"][:depth], 1)
        if group["limit"] and group["entered"] + group["limit"] <= now
    ]
    return min(ends, key=lambda end: end[0])[1] if ends else None
