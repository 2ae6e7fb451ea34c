"""Random missions for formats that express less than the whole language."""

from hypothesis import strategies as st

from argo_compiler.il import Action, Group, Mission, Stop, Task, Transition
from tests.mission_parts import HERE, assume_sound, groups_over, starts, task_names, tasks_named


def repeated(task):
    """Return a mission with one task in two rounds, whose names are all the task's name."""
    own = task.name.replace("/", "")
    group = Group(name=f"G{own}", start=task.name, end=task.name, max_repeat_count=2)
    return assume_sound(Mission(tasks=(task,), groups=(group,), designation=task.name))


@st.composite
def missions(draw, failures=True):
    """Draw up to nine tasks with transitions in all directions, and nested groups.

    With `failures`, tasks have retries and failure policies.
    """
    names = draw(task_names())
    tasks = [draw(tasks_named(name, names, i, failures)) for i, name in enumerate(names)]
    groups = draw(groups_over(names))
    return Mission(tasks=(*draw(starts(names)), *tasks), groups=groups, dock=HERE)


# Outcomes of actions: duration in s, value, and whether the action fails.
outcome_lists = st.lists(
    st.tuples(st.integers(0, 4), st.one_of(st.none(), st.integers(0, 6)), st.booleans()),
    min_size=1,
    max_size=8,
)


@st.composite
def structured_missions(draw, timeouts=True):
    """Draw a mission that goes back only by a group's rounds; its other transitions go forward.

    Without `timeouts`, no group's time-out interrupts an action.
    """
    names = draw(task_names())
    tasks = []
    for i, name in enumerate(names):
        task = draw(tasks_named(name, names, i))
        ahead = tuple(t for t in task.transitions if names.index(t.target) > i)
        tasks.append(task.model_copy(update={"transitions": ahead}))
    groups = [
        group if timeouts else group.model_copy(update={"stop": Stop.SOFT})
        for group in draw(groups_over(names))
    ]
    start = Task(
        name="S",
        action=Action.START,
        transitions=(Transition(target=draw(st.sampled_from(names))),),
    )
    first = [start] if draw(st.booleans()) else []
    return Mission(tasks=(*first, *tasks), groups=tuple(groups), dock=HERE)
