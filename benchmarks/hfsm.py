"""How many events a second machines take, Argo's and others', on the same nested mission.

    python benchmarks/hfsm.py            # needs the extra `bench`
    python benchmarks/hfsm.py --states

The mission, repeated for as long as there are events:

    A, then Alpha three times (B, then Beta twice (D, E), then C), then F

but after C with a value above 8, Alpha is left at once. Each event is the end of the present task's
action, with the value that was measured. In each library the mission is built as its users would,
with its own nesting, guards and callbacks, and it is checked to go through the same tasks before it
is timed. All take the same events in the same process, in turn; the figures are medians of the
repeats, in CPU time, and building is not part of them.

`--states` counts what has to be written by hand, or is made, for one mission with pause, stop,
going home, recharging and going on.
"""

import argparse
import gc
import math
import random
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from itertools import pairwise
from typing import Any

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ActionSucceeded, Executor, lower
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    Reaction,
    Response,
    Task,
    Transition,
)

HIGH = 8.0
EVENTS = 5_000

ISAR = "isar 1.34.28"
ISAR_STATES = 26
"""flat states of its machine: the members of `States` in isar/state_machine/states_enum.py"""
ISAR_STATES_FOR_THESE = 17
"""of them without those for losing the robot, protective stops, lockdown and maintenance"""

Run = Callable[[Sequence[float]], list[str]]
"""Takes the values of the events; returns the task that each of them ended."""


def argo() -> Run:
    """Argo: tasks and groups, lowered."""

    def task(name: str, *ways: Transition) -> Task:
        return Task(name=name, action=Action.MEASURE, object_id=name, transitions=ways)

    high = Condition(type=ConditionType.GREATER, object_id="C", param1=HIGH)
    order = ["A", "B", "D", "E", "C", "F"]
    following = dict(pairwise(order))
    tasks = [
        task(name, *([Transition(target=following[name])] if name in following else []))
        for name in order
    ]
    leave = Transition(target="F", conditions=(high,))
    tasks[4] = task("C", leave, Transition(target="F"))
    mission = Mission(
        tasks=tuple(tasks),
        groups=(
            Group(name="Night", start="A", end="F", max_repeat_count=10**9),
            Group(name="Night/Alpha", start="B", end="C", max_repeat_count=3),
            Group(name="Night/Alpha/Beta", start="D", end="E", max_repeat_count=2),
        ),
    )
    executor = Executor(lower(mission))

    def run(values: Sequence[float]) -> list[str]:
        ended = []
        now = 0.0
        (command,) = executor.start(now)
        for value in values:
            now += 1.0
            name = command.task.name  # type: ignore[union-attr]
            ended.append(name)
            (command,) = executor.handle(ActionSucceeded(name, value), now)
        return ended

    return run


class Rounds:
    """The counters of the rounds, for libraries that have none."""

    def __init__(self) -> None:
        self.alpha = 1
        self.beta = 1

    def enter_alpha(self, *_: Any) -> None:
        self.alpha = 1

    def enter_beta(self, *_: Any) -> None:
        self.beta = 1

    def next_alpha(self, *_: Any) -> None:
        self.alpha += 1

    def next_beta(self, *_: Any) -> None:
        self.beta += 1

    def alpha_again(self, *_: Any) -> bool:
        return self.alpha < 3

    def beta_again(self, *_: Any) -> bool:
        return self.beta < 2

    def high(self, value: float) -> bool:
        return value > HIGH


def transitions_flat() -> Run:
    """transitions, without nesting: entering a group is written into each way that does so."""
    from transitions import Machine

    model: Any = Rounds()
    ways = [
        {"trigger": "ended", "source": "A", "dest": "B", "before": "enter_alpha"},
        {"trigger": "ended", "source": "B", "dest": "D", "before": "enter_beta"},
        {"trigger": "ended", "source": "D", "dest": "E"},
        {"trigger": "ended", "source": "E", "dest": "D", "conditions": "beta_again",
         "before": "next_beta"},
        {"trigger": "ended", "source": "E", "dest": "C"},
        {"trigger": "ended", "source": "C", "dest": "F", "conditions": "high"},
        {"trigger": "ended", "source": "C", "dest": "B", "conditions": "alpha_again",
         "before": "next_alpha"},
        {"trigger": "ended", "source": "C", "dest": "F"},
        {"trigger": "ended", "source": "F", "dest": "A"},
    ]  # fmt: skip
    Machine(model, states=list("ABDECF"), transitions=ways, initial="A", auto_transitions=False)

    return _ending(model)


def transitions_nested() -> Run:
    """transitions' HierarchicalMachine."""
    from transitions.extensions import HierarchicalMachine

    model: Any = Rounds()
    beta = {"name": "Beta", "initial": "D", "children": ["D", "E"], "on_enter": "enter_beta"}
    alpha = {"name": "Alpha", "initial": "B", "children": ["B", beta, "C"],
             "on_enter": "enter_alpha"}  # fmt: skip
    ways = [
        {"trigger": "ended", "source": "A", "dest": "Alpha"},
        {"trigger": "ended", "source": "Alpha_B", "dest": "Alpha_Beta"},
        {"trigger": "ended", "source": "Alpha_Beta_D", "dest": "Alpha_Beta_E"},
        {"trigger": "ended", "source": "Alpha_Beta_E", "dest": "Alpha_Beta_D",
         "conditions": "beta_again", "before": "next_beta"},
        {"trigger": "ended", "source": "Alpha_Beta_E", "dest": "Alpha_C"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "F", "conditions": "high"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "Alpha_B", "conditions": "alpha_again",
         "before": "next_alpha"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "F"},
        {"trigger": "ended", "source": "F", "dest": "A"},
    ]  # fmt: skip
    HierarchicalMachine(
        model, states=["A", alpha, "F"], transitions=ways, initial="A", auto_transitions=False
    )

    return _ending(model)


def _ending(model: Any) -> Run:
    """Return what ends the tasks of a model of transitions; a state's last letter is its task."""

    def run(values: Sequence[float]) -> list[str]:
        ended = []
        for value in values:
            ended.append(model.state[-1])
            model.ended(value)
        return ended

    return run


def python_statemachine() -> Run:
    """python-statemachine's own API, with compound states."""
    from statemachine import State, StateChart

    class Night(StateChart[Any]):
        class Alpha(State.Compound):
            class Beta(State.Compound):
                D = State(initial=True)
                E = State()
                ended = D.to(E) | E.to(D, cond="beta_again", on="next_beta")

            B = State(initial=True)
            C = State()
            ended = (
                B.to(Beta, on="enter_beta")
                | Beta.to(C)
                | C.to(B, cond="alpha_again and not high", on="next_alpha")
            )

        A = State(initial=True)
        F = State()
        ended = A.to(Alpha, on="enter_alpha") | Alpha.to(F) | F.to(A)

    machine: Any = Night(Rounds())

    def run(values: Sequence[float]) -> list[str]:
        ended = []
        for value in values:
            ended.append(next(id for id in machine.configuration_values if len(id) == 1))
            machine.ended(value=value)
        return ended

    return run


SISMIC = """
statechart:
  name: Night
  root state:
    name: Night
    initial: A
    states:
      - name: A
        transitions:
          - {target: Alpha, event: ended}
      - name: Alpha
        initial: B
        on entry: alpha = 1
        states:
          - name: B
            transitions:
              - {target: Beta, event: ended}
          - name: Beta
            initial: D
            on entry: beta = 1
            states:
              - name: D
                transitions:
                  - {target: E, event: ended}
              - name: E
                transitions:
                  - {target: D, event: ended, guard: beta < 2, action: beta += 1}
                  - {target: C, event: ended, guard: beta >= 2}
          - name: C
            transitions:
              - {target: F, event: ended, guard: event.value > 8 or alpha >= 3}
              - {target: B, event: ended, guard: event.value <= 8 and alpha < 3,
                 action: alpha += 1}
      - name: F
        transitions:
          - {target: A, event: ended}
"""


def sismic() -> Run:
    """sismic, from its YAML."""
    from sismic.interpreter import Interpreter
    from sismic.io import import_from_yaml

    interpreter: Any = Interpreter(import_from_yaml(SISMIC))
    interpreter.execute()

    def run(values: Sequence[float]) -> list[str]:
        ended = []
        for value in values:
            ended.append(interpreter.configuration[-1])
            interpreter.queue("ended", value=value).execute()
        return ended

    return run


def py_trees() -> Run:
    """py_trees: sequences and repeats, one tick for each event."""
    import py_trees as pt

    present: dict[str, Any] = {"value": None, "last": 0.0}
    ended: list[str] = []

    class Measure(pt.behaviour.Behaviour):
        def update(self) -> Any:
            if present["value"] is None:
                return pt.common.Status.RUNNING
            present["last"], present["value"] = present["value"], None
            ended.append(self.name)
            return pt.common.Status.SUCCESS

    class NotHigh(pt.behaviour.Behaviour):
        def update(self) -> Any:
            high = present["last"] > HIGH
            return pt.common.Status.FAILURE if high else pt.common.Status.SUCCESS

    def sequence(name: str, *children: Any) -> Any:
        return pt.composites.Sequence(name, memory=True, children=list(children))

    repeat = pt.decorators.Repeat
    beta = repeat("Beta", sequence("beta", Measure("D"), Measure("E")), num_success=2)
    alpha = sequence("alpha", Measure("B"), beta, Measure("C"), NotHigh("not high"))
    rounds = pt.decorators.FailureIsSuccess("left", repeat("Alpha", alpha, num_success=3))
    night = repeat("Night", sequence("night", Measure("A"), rounds, Measure("F")), num_success=-1)
    tree = pt.trees.BehaviourTree(night)

    def run(values: Sequence[float]) -> list[str]:
        for value in values:
            present["value"] = value
            tree.tick()
        return ended

    return run


PEERS: dict[str, tuple[Callable[[], Run], bool]] = {
    "Argo": (argo, True),
    "transitions, flat": (transitions_flat, False),
    "transitions, hierarchical": (transitions_nested, True),
    "python-statemachine": (python_statemachine, True),
    "sismic": (sismic, True),
    "py_trees": (py_trees, True),
}
"""by name: how the machine is built, and whether it is nested"""

MISSING = [
    name
    for name in PEERS
    if name != "Argo" and not find_spec(name.partition(",")[0].replace("python-", ""))
]
for name in MISSING:
    del PEERS[name]


def measure(
    count: int, repeats: int, machines: Mapping[str, tuple[Callable[[], Run], bool]] = PEERS
) -> dict[str, float]:
    """Events a second of each machine, the medians of so many repeats."""
    generator = random.Random(0)
    values = [generator.uniform(0.0, 10.0) for _ in range(count)]
    expected = argo()(values)
    rates: dict[str, list[float]] = {name: [] for name in machines}
    for name, (build, _) in machines.items():
        if build()(values) != expected:
            raise SystemExit(f"{name} goes through other tasks")
    for _ in range(repeats):
        for name, (build, _) in machines.items():
            run = build()
            gc.collect()
            before = time.process_time()
            run(values)
            rates[name].append(count / (time.process_time() - before))
    return {name: statistics.median(found) for name, found in rates.items()}


def compare(count: int, repeats: int) -> None:
    """Prints the table."""
    rates = measure(count, repeats)
    nesting = [rates[name] for name, (_, nests) in PEERS.items() if nests and name != "Argo"]
    nested = max(nesting, default=math.nan)
    print(f"{count} events, median of {repeats} repeats, CPU time\n")
    print(f"{'':28}{'events/s':>12}{'to the fastest hierarchical peer':>36}")
    for name, rate in sorted(rates.items(), key=lambda item: -item[1]):
        print(f"{name:28}{rate:12,.0f}{rate / nested:36.2f}")
    if MISSING:
        print(f"left out, as not installed: {'; '.join(MISSING)}")


def states() -> None:
    """Counts the states of one mission that can be paused, stopped, sent home and recharged."""
    here = Pose(x=0, y=0, z=0)
    mission = Mission(
        tasks=(Task(name="inspect", action=Action.MEASURE, object_id="1"),),
        dock=here,
        reactions=(
            Reaction(
                event=EventKind.LOW_BATTERY,
                response=Response.RETURN,
                until=EventKind.BATTERY_CHARGED,
                afterwards=Afterwards.RESUME,
            ),
        ),
    )
    hfsm = lower(mission)
    made = len(hfsm.composites) + len(hfsm.leaves) + len(hfsm.reactions) + 1
    print(f"Argo: {made} states, all made from the mission; 0 written by hand")
    print("      pause, resume and stop belong to every machine and need no state of their own")
    print(f"{ISAR}: {ISAR_STATES} written by hand, {ISAR_STATES_FOR_THESE} of them for these")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure or count what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--events", type=int, default=EVENTS)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--states", action="store_true", help="count states instead")
    given = parser.parse_args(arguments)
    if given.states:
        states()
    else:
        compare(given.events, given.repeats)


if __name__ == "__main__":
    main()
