"""What the states of a mission know in common, as a dictionary in the userdata `memory`."""


def new_memory(to, velocity):
    """At the beginning: `to` is where the mission goes on, `velocity` (m/s) how fast.

    A target is the number of a task; or -1 for the end of a round of the outermost group around,
    -2 of the next one inward and so on; or `end` or `aborted`. `groups` has those that have been
    entered, from the outermost inward.
    """
    return {"to": to, "velocity": velocity, "values": {}, "groups": []}


def holds(condition, memory, now):
    """Whether (object_id, low, high, inclusive, max_age) holds; bounds that are None are none."""
    object_id, low, high, inclusive, max_age = condition
    if object_id not in memory["values"]:
        return False
    value, time = memory["values"][object_id]
    if max_age is not None and now - time > max_age:
        return False
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
