"""Events per second of Argo's and other state machines on the same nested mission.

    python benchmarks/hfsm.py            # needs the extra `bench`
    python benchmarks/hfsm.py --states

The mission, repeated for as long as there are events:

    A, then Alpha three times (B, then Beta twice (D, E), then C), then F

but after C with a value above 8, Alpha is left at once. Each event is the end of the current task's
action, with the measured value. In each library the mission is built as its users would build it,
with the library's nesting, guards and callbacks. Before the timing, each machine is checked to
execute the same tasks. All machines handle the same events in the same process, in turn; the
figures are medians of the repeats, in CPU time, without the time to build a machine.

`--states` counts the states that are written by hand, or made, for one mission with pause, stop,
return home, recharging and resumption.
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
"""number of flat states: the members of `States` in isar/state_machine/states_enum.py"""
ISAR_STATES_FOR_THESE = 17
"""number without those for a lost robot, protective stops, lockdown and maintenance"""

Run = Callable[[Sequence[float]], list[str]]
"""Function from the values of the events to the task that each event ended."""


def build_argo() -> Run:
    """Build the mission's machine in Argo, by lowering; return the function that runs it."""

    def task(name: str, *transitions: Transition) -> Task:
        return Task(name=name, action=Action.MEASURE, object_id=name, transitions=transitions)

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
    """Counters of the rounds, for libraries that have none."""

    def __init__(self) -> None:
        self.alpha = 1
        self.beta = 1

    def reset_alpha(self, *_: Any) -> None:
        self.alpha = 1

    def reset_beta(self, *_: Any) -> None:
        self.beta = 1

    def add_alpha_round(self, *_: Any) -> None:
        self.alpha += 1

    def add_beta_round(self, *_: Any) -> None:
        self.beta += 1

    def should_repeat_alpha(self, *_: Any) -> bool:
        return self.alpha < 3

    def should_repeat_beta(self, *_: Any) -> bool:
        return self.beta < 2

    def high(self, value: float) -> bool:
        return value > HIGH


def build_flat_transitions() -> Run:
    """Build the machine in the library transitions, without nesting; return its run function.

    Each transition into a group resets the counter of the group's rounds.
    """
    from transitions import Machine

    model: Any = Rounds()
    rows = [
        {"trigger": "ended", "source": "A", "dest": "B", "before": "reset_alpha"},
        {"trigger": "ended", "source": "B", "dest": "D", "before": "reset_beta"},
        {"trigger": "ended", "source": "D", "dest": "E"},
        {"trigger": "ended", "source": "E", "dest": "D", "conditions": "should_repeat_beta",
         "before": "add_beta_round"},
        {"trigger": "ended", "source": "E", "dest": "C"},
        {"trigger": "ended", "source": "C", "dest": "F", "conditions": "high"},
        {"trigger": "ended", "source": "C", "dest": "B", "conditions": "should_repeat_alpha",
         "before": "add_alpha_round"},
        {"trigger": "ended", "source": "C", "dest": "F"},
        {"trigger": "ended", "source": "F", "dest": "A"},
    ]  # fmt: skip
    Machine(model, states=list("ABDECF"), transitions=rows, initial="A", auto_transitions=False)

    return _transitions_run(model)


def build_hierarchical_transitions() -> Run:
    """Build the machine as a HierarchicalMachine of transitions; return its run function."""
    from transitions.extensions import HierarchicalMachine

    model: Any = Rounds()
    beta = {"name": "Beta", "initial": "D", "children": ["D", "E"], "on_enter": "reset_beta"}
    alpha = {"name": "Alpha", "initial": "B", "children": ["B", beta, "C"],
             "on_enter": "reset_alpha"}  # fmt: skip
    rows = [
        {"trigger": "ended", "source": "A", "dest": "Alpha"},
        {"trigger": "ended", "source": "Alpha_B", "dest": "Alpha_Beta"},
        {"trigger": "ended", "source": "Alpha_Beta_D", "dest": "Alpha_Beta_E"},
        {"trigger": "ended", "source": "Alpha_Beta_E", "dest": "Alpha_Beta_D",
         "conditions": "should_repeat_beta", "before": "add_beta_round"},
        {"trigger": "ended", "source": "Alpha_Beta_E", "dest": "Alpha_C"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "F", "conditions": "high"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "Alpha_B",
         "conditions": "should_repeat_alpha", "before": "add_alpha_round"},
        {"trigger": "ended", "source": "Alpha_C", "dest": "F"},
        {"trigger": "ended", "source": "F", "dest": "A"},
    ]  # fmt: skip
    HierarchicalMachine(
        model, states=["A", alpha, "F"], transitions=rows, initial="A", auto_transitions=False
    )

    return _transitions_run(model)


def _transitions_run(model: Any) -> Run:
    """Return the function that runs a model of the library transitions.

    The last letter of a state's name is its task.
    """

    def run(values: Sequence[float]) -> list[str]:
        ended = []
        for value in values:
            ended.append(model.state[-1])
            model.ended(value)
        return ended

    return run


def build_python_statemachine() -> Run:
    """Build the machine in python-statemachine, with compounds; return its run function."""
    from statemachine import State, StateChart

    class Night(StateChart[Any]):
        class Alpha(State.Compound):
            class Beta(State.Compound):
                D = State(initial=True)
                E = State()
                ended = D.to(E) | E.to(D, cond="should_repeat_beta", on="add_beta_round")

            B = State(initial=True)
            C = State()
            ended = (
                B.to(Beta, on="reset_beta")
                | Beta.to(C)
                | C.to(B, cond="should_repeat_alpha and not high", on="add_alpha_round")
            )

        A = State(initial=True)
        F = State()
        ended = A.to(Alpha, on="reset_alpha") | Alpha.to(F) | F.to(A)

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


def build_sismic() -> Run:
    """Build the machine in sismic, from a statechart in YAML; return its run function."""
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


def build_py_trees() -> Run:
    """Build the mission in py_trees as sequences and repeats; return its run function.

    It ticks the tree once for each event.
    """
    import py_trees as pt

    values_seen: dict[str, Any] = {"value": None, "last": 0.0}
    ended: list[str] = []

    class Measure(pt.behaviour.Behaviour):
        def update(self) -> Any:
            if values_seen["value"] is None:
                return pt.common.Status.RUNNING
            values_seen["last"], values_seen["value"] = values_seen["value"], None
            ended.append(self.name)
            return pt.common.Status.SUCCESS

    class NotHigh(pt.behaviour.Behaviour):
        def update(self) -> Any:
            high = values_seen["last"] > HIGH
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
            values_seen["value"] = value
            tree.tick()
        return ended

    return run


MACHINES: dict[str, tuple[Callable[[], Run], bool]] = {
    "Argo": (build_argo, True),
    "transitions, flat": (build_flat_transitions, False),
    "transitions, hierarchical": (build_hierarchical_transitions, True),
    "python-statemachine": (build_python_statemachine, True),
    "sismic": (build_sismic, True),
    "py_trees": (build_py_trees, True),
}
"""function that builds each machine, and whether the machine is hierarchical"""

MISSING = [
    name
    for name in MACHINES
    if name != "Argo" and not find_spec(name.partition(",")[0].replace("python-", ""))
]
for name in MISSING:
    del MACHINES[name]


def measure_median_rates(
    event_count: int,
    repeats: int,
    machines: Mapping[str, tuple[Callable[[], Run], bool]] = MACHINES,
) -> dict[str, float]:
    """Return the events per second of each machine, the medians of the repeats.

    Args:
        event_count: number of events in a repeat
        repeats: number of repeats
        machines: function that builds each machine, and whether it is hierarchical, which has no
            effect

    Raises:
        SystemExit: A machine executes other tasks than Argo's.
    """
    generator = random.Random(0)
    values = [generator.uniform(0.0, 10.0) for _ in range(event_count)]
    expected = build_argo()(values)
    rates: dict[str, list[float]] = {name: [] for name in machines}
    for name, (build, _) in machines.items():
        if build()(values) != expected:
            raise SystemExit(f"{name} executes other tasks than Argo")
    for _ in range(repeats):
        for name, (build, _) in machines.items():
            run = build()
            gc.collect()
            before = time.process_time()
            run(values)
            rates[name].append(event_count / (time.process_time() - before))
    return {name: statistics.median(repeated) for name, repeated in rates.items()}


def print_rates(count: int, repeats: int) -> None:
    """Print the table of events per second, the fastest machine first."""
    rates = measure_median_rates(count, repeats)
    peers = [rates[name] for name, (_, nested) in MACHINES.items() if nested and name != "Argo"]
    fastest = max(peers, default=math.nan)
    print(f"{count} events, median of {repeats} repeats, CPU time\n")
    print(f"{'':28}{'events/s':>12}{'times the fastest hierarchical peer':>36}")
    for name, rate in sorted(rates.items(), key=lambda item: -item[1]):
        print(f"{name:28}{rate:12,.0f}{rate / fastest:36.2f}")
    if MISSING:
        print(f"not installed: {'; '.join(MISSING)}")


def print_state_counts() -> None:
    """Print the number of states of a mission with pause, stop, return home and recharging."""
    dock = Pose(x=0, y=0, z=0)
    mission = Mission(
        tasks=(Task(name="inspect", action=Action.MEASURE, object_id="1"),),
        dock=dock,
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
    count = len(hfsm.composites) + len(hfsm.leaves) + len(hfsm.reactions) + 1
    print(f"Argo: {count} states, all made from the mission; 0 written by hand")
    print("      pause, resume and stop belong to every machine and need no state of their own")
    print(f"{ISAR}: {ISAR_STATES} written by hand, {ISAR_STATES_FOR_THESE} of them for these")


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure rates or count states, as the command line asks."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--events", type=int, default=EVENTS, help="number of events")
    parser.add_argument("--repeats", type=int, default=7, help="repeats of each machine")
    parser.add_argument("--states", action="store_true", help="count states instead")
    options = parser.parse_args(arguments)
    if options.states:
        print_state_counts()
    else:
        print_rates(options.events, options.repeats)


if __name__ == "__main__":
    main()
