"""What the states of a mission know in common, as a dictionary in the userdata `memory`."""


def new_memory(to):
    """At the beginning: `to` is where the mission goes on.

    A target is the number of a task; or -1 for the end of a round of the outermost group around,
    -2 of the next one inward and so on; or `end` or `aborted`. `groups` has those that have been
    entered, from the outermost inward. `readings` has for each checkpoint what came of its last
    measurement (value, unreadable or failed), when, the value, and whether it is abnormal.
    `failures` tells whether a task that is not optional has failed for good.
    """
    return {"to": to, "readings": {}, "groups": [], "failures": False}


def holds(condition, memory, now):
    """Whether (kind, object_id, low, high, inclusive, max_age) holds.

    The kind is `value`, whose bounds that are None are none, or what else a reading may be:
    `unreadable`, `failed`, `stale`, `abnormal`.
    """
    kind, object_id, low, high, inclusive, max_age = condition
    if object_id not in memory["readings"]:
        return False
    read, time, value, abnormal = memory["readings"][object_id]
    if kind == "unreadable":
        return read == "unreadable"
    if kind == "failed":
        return read != "value"
    old = max_age is not None and now - time > max_age
    if kind == "stale" or read != "value" or old:
        return kind == "stale" and read == "value" and old
    if kind == "abnormal":
        return abnormal
    if inclusive:
        return (low is None or low <= value) and (high is None or value <= high)
    return (low is None or low < value) and (high is None or value < high)


def time_up(depth, memory, now):
    """The target where the time of one of the `depth` groups around is up, or None."""
    ends = [
        (group["entered"] + group["limit"], -number)
        for number, group in enumerate(memory["groups"][:depth], 1)
        if group["limit"] and group["entered"] + group["limit"] <= now
    ]
    return min(ends, key=lambda end: end[0])[1] if ends else None
