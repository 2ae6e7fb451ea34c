"""Short ways to write the parts of a mission, and a mission apart from where it was read."""

from argo_compiler.il import Action, Mission, Task, Transition, WaitRule


def way(target, *conditions):
    return Transition(target=target, conditions=conditions)


def _ways(ways):
    return tuple(way(one) if isinstance(one, str) else one for one in ways)


def measure(name, *ways, **fields):
    """A task that measures the checkpoint of its own name unless another one is given. A way is
    the name of the next task, or a whole transition."""
    given = {"object_id": name, "transitions": _ways(ways), **fields}
    return Task(name=name, action=Action.MEASURE, **given)


def wait(name, *ways, **fields):
    """A WAIT; those of the fields that a wait rule has are its rule."""
    rule = {key: fields.pop(key) for key in WaitRule.model_fields if key in fields}
    given = {"wait": WaitRule(**rule), "transitions": _ways(ways), **fields}
    return Task(name=name, action=Action.WAIT, **given)


def unplaced(mission: Mission) -> Mission:
    """The mission without the places in its source."""
    return mission.model_copy(
        update={
            name: tuple(part.model_copy(update={"source": None}) for part in getattr(mission, name))
            for name in ("tasks", "groups", "reactions")
        }
    )
