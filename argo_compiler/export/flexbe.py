"""Export to FlexBE: a behaviour of nested state machines, its manifest, and its states' classes.

An outcome can only lead to a state of the same machine. So a transition writes its target to the
memory that all states share. If the transition crosses groups, each machine between has a state
that leads on to the target: `enter` at the start of a group, `route` after a part of the machine
has ended without reaching the target.
"""

import re
from bisect import bisect
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.export.exporter import (
    Exporter,
    battery_level_report_refusals,
    raise_refusals,
    refusal,
)
from argo_compiler.export.xml import XmlWriter
from argo_compiler.hfsm import Composite, Hfsm, Leaf, StateTransition, TransitionKind
from argo_compiler.hfsm.model import DONE, MISSION, RETURN
from argo_compiler.il import Action, Condition, ConditionType, Mission, Mode, Response, Task

STATES = "argo_flexbe_states"
BEHAVIORS = "argo_flexbe_behaviors"

OUTCOMES = ("completed", "completed_with_failures", "returned", "failed", "aborted")


def to_flexbe(mission: Mission, hfsm: Hfsm) -> Mapping[str, bytes]:
    """Return the files of two Python packages and of the behaviour's manifest, by path.

    Raises:
        DiagnosticError: The mission has parts that a behaviour can't express.
    """
    raise_refusals((*_refusals(hfsm), *_time_refusals(mission)))
    name = _identifier(hfsm.mission.name) or "mission"
    sources = files("argo_compiler.export").joinpath("flexbe_states")
    contents = {
        f"{STATES}/{source.name}": source.read_bytes()
        for source in sorted(sources.iterdir(), key=lambda source: source.name)
        if source.name.endswith(".py")
    }
    contents[f"{BEHAVIORS}/__init__.py"] = b'"""Missions exported by Argo."""\n'
    contents[f"{BEHAVIORS}/{name}_sm.py"] = _Behavior(hfsm, name).source().encode()
    contents[f"manifest/{name}.xml"] = _manifest(hfsm, name).encode()
    return contents


EXPORTER = Exporter(
    "FlexBE behaviour, its states and its manifest",
    (),
    lambda given: to_flexbe(given.mission, given.machine),
)


def _refusals(hfsm: Hfsm) -> Iterator[Diagnostic]:
    yield from battery_level_report_refusals(state.reaction for state in hfsm.reactions)
    for state in hfsm.reactions:
        if state.reaction.response is not Response.REPORT:
            yield refusal(
                "reaction",
                f"the reaction to '{state.reaction.event}' can't be exported to FlexBE: no "
                "container of FlexBE resumes what it interrupted",
                "let the operator pause the behaviour, or export SCXML",
                state.reaction.source,
            )


def _time_refusals(mission: Mission) -> Iterator[Diagnostic]:
    if mission.mode is Mode.SUPERVISORY:
        yield refusal(
            "supervisory",
            "the mission starts paused, but a behaviour runs as soon as it is started",
            "set its mode to autonomous, and start the behaviour when a person allows it",
        )
    for task in mission.tasks:
        window, wait = task.window, task.wait
        if wait is not None and wait.duration is None:
            yield refusal(
                "wait",
                f"task '{task.name}' waits for an event or for conditions, which the states of a "
                "FlexBE behaviour can't do",
                "wait for a duration, or export SCXML",
                task.source,
            )
        if window is not None and (window.earliest or (window.hard and window.latest is not None)):
            yield refusal(
                "window",
                f"task '{task.name}' has a time window, but the states of a FlexBE behaviour do "
                "not know when the mission started",
                "remove `earliest` and make the window soft, or export SCXML",
                task.source,
            )
    for group in mission.groups:
        if group.every:
            yield refusal(
                "every",
                f"group '{group.name}' starts its rounds at fixed times, which the states of a "
                "FlexBE behaviour can't do",
                "let each round follow the previous one, or export SCXML",
                group.source,
            )


def _manifest(hfsm: Hfsm, name: str) -> str:
    xml = XmlWriter()
    with xml.nest_in("behavior", {"name": name}):
        xml.add("executable", {"package_path": f"{BEHAVIORS}.{name}_sm", "class": f"{name}SM"})
        xml.add_text("tagstring", "inspection")
        xml.add_text("author", "Argo")
        xml.add_text("date", "")
        xml.add_text("description", hfsm.mission.name or "an inspection mission")
    return xml.text()


class _Behavior:
    """Writer of the behaviour's source; holds its lines, and labels and numbers of the states."""

    def __init__(self, hfsm: Hfsm, name: str) -> None:
        self.hfsm = hfsm
        self.name = name
        self.composites = {c.id: c for c in hfsm.composites}
        self.leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self.numbers = {leaf.id: i for i, leaf in enumerate(hfsm.leaves, 1)}
        self.labels = {
            leaf.id: self._label(f"t{i}", leaf.task.name) for i, leaf in enumerate(hfsm.leaves, 1)
        }
        self.variables = {c.id: f"_sm_g{i}" for i, c in enumerate(hfsm.composites)}
        self.depths = {MISSION: 0}
        for i, group in enumerate(hfsm.composites[1:], 1):
            self.labels[group.id] = self._label(f"g{i}", group.name)
            self.depths[group.id] = self.depths[group.parent or MISSION] + 1
        self.ranges = self._ranges()
        self.parts = {c.id: self._parts(c) for c in hfsm.composites}
        self.lines: list[str] = []

    def _label(self, id: str, name: str) -> str:
        """Return a state's label: its unique `id`, and its name in characters FlexBE accepts."""
        return f"{id} {_identifier(name)}".strip()

    def _ranges(self) -> dict[str, tuple[int, int]]:
        """Return the numbers of the first and the last task in each state, by the state's id.

        Both numbers are included. A task's state has one task; the state of a group or of the
        mission has those inside it, (1, 0) if there are none.
        """
        ranges = {id: (number, number) for id, number in self.numbers.items()}
        for composite in reversed(self.hfsm.composites):
            inside = [ranges[child] for child in composite.children if child != DONE]
            ranges[composite.id] = (inside[0][0], inside[-1][1]) if inside else (1, 0)
        return ranges

    def _parts(self, composite: Composite) -> list[tuple[int, str]]:
        """Return each direct child of a composite: the number of its first task, and its label."""
        children = (child for child in composite.children if child != DONE)
        return [(self.ranges[child][0], self.labels[child]) for child in children]

    def _outcome(self, machine: str, target: int | str) -> str:
        """Return the outcome with which a state inside a FlexBE machine leads towards the target.

        `machine` is the id of the composite. `target` is as in the memory that the states share:
        the number of a task, the negative of a group's depth for the end of the group's round, or
        `end` or `aborted`. The outcome is the label of the machine's child that is the target or
        contains it, `round` for the end of this machine's round, and `left` for all else.
        """
        if isinstance(target, str):
            return "left"
        if target < 0:
            return "round" if -target == self.depths[machine] else "left"
        first, last = self.ranges[machine]
        if not first <= target <= last:
            return "left"
        parts = self.parts[machine]
        return parts[bisect(parts, target, key=lambda part: part[0]) - 1][1]

    def source(self) -> str:
        """Return the behaviour's Python source."""
        hfsm = self.hfsm
        states = ("count", "decide", "measure", "route", "wait", "waypoint")
        initial = hfsm.mission.initial
        self.lines += [
            f'"""The mission as a FlexBE behaviour: {self.name}."""',
            "",
            "from flexbe_core import Autonomy, Behavior, OperatableStateMachine",
            f"from {STATES}.memory import new_memory",
            *(f"from {STATES}.{s}_state import {s.capitalize()}State" for s in states),
            "",
            "",
            f"class {self.name}SM(Behavior):",
            '    """Written by Argo; to change it, change the mission and export it again."""',
            "",
            "    def __init__(self):",
            "        super().__init__()",
            f"        self.name = {self.name!a}",
            "",
            "    def create(self):",
            "        keys = {'input_keys': ['memory'], 'output_keys': ['memory']}",
            "        remapping = {'memory': 'memory'}",
        ]
        # Inner machines come first, as a machine must exist before it is added to another one.
        for composite in reversed(hfsm.composites[1:]):
            self._add_machine(composite, self.variables[composite.id], ["left"])
        self._add_machine(hfsm.mission, "_state_machine", list(OUTCOMES))
        to = "end" if initial == DONE else self.numbers[initial]
        self.lines += [
            f"        memory = new_memory({to!r})",
            "        _state_machine.userdata.memory = memory",
            "        return _state_machine",
        ]
        return "\n".join(self.lines) + "\n"

    def _add_machine(self, composite: Composite, variable: str, outcomes: list[str]) -> None:
        self.lines += [
            f"        {variable} = OperatableStateMachine(outcomes={outcomes!r}, **keys)",
            f"        with {variable}:",
        ]
        # A machine starts with the state that is added first.
        outcomes = [label for _, label in self.parts[composite.id]]
        if composite.repeat is None:
            ends = {"left": "completed", "end": "completed", "aborted": "aborted"}
            ends["failures"] = "completed_with_failures"
            self._add_route_state("route", composite, [*outcomes, *ends], ends)
        else:
            limit = composite.repeat.duration if composite.timeout else 0.0
            all_outcomes = [*outcomes, "round", "left"]
            self._add_route_state("enter", composite, all_outcomes, {}, limit)
            self._add_route_state("route", composite, all_outcomes, {})
        for child in composite.children:
            if leaf := self.leaves.get(child):
                self._add_task(leaf)
            elif child != DONE:
                self._add_state(self.labels[child], self.variables[child], {"left": "route"})
        if composite.repeat is not None:
            self._add_count_state(composite)

    def _add_route_state(
        self,
        label: str,
        composite: Composite,
        outcomes: list[str],
        ends: Mapping[str, str],
        limit: float | None = None,
    ) -> None:
        arguments = (
            f"outcomes={outcomes!r}, depth={self.depths[composite.id]}, "
            f"inside={self.parts[composite.id]!r}, last={self.ranges[composite.id][1]}"
        )
        if limit is not None:
            arguments += f", limit={limit!r}"
        transitions = {outcome: ends.get(outcome, outcome) for outcome in outcomes}
        self._add_state(label, f"RouteState({arguments})", transitions)

    def _add_task(self, leaf: Leaf) -> None:
        label, task = self.labels[leaf.id], leaf.task
        decide = f"{label} decide"
        if leaf.id == RETURN:
            self._add_state(
                label,
                self._action_state(leaf),
                {"done": "returned", "failed": "failed", "time_up": "route"},
            )
            return
        outcomes = {"done": decide, "time_up": "route"}
        if task.action is Action.WAIT:
            assert task.wait is not None
            arguments = f"duration={task.wait.duration or 0.0!r}, depth={self.depths[leaf.parent]}"
            self._add_state(label, f"WaitState({arguments})", outcomes)
        else:
            outcomes["failed"] = f"{label} failed"
            self._add_state(label, self._action_state(leaf), outcomes)
            if leaf.failure is None:
                self._add_decide_state(
                    outcomes["failed"], leaf, leaf.transitions, "end", not task.optional
                )
            else:
                transitions = (leaf.failure,)
                self._add_decide_state(
                    outcomes["failed"], leaf, transitions, "aborted", not task.optional
                )
        self._add_decide_state(decide, leaf, leaf.transitions, "end")

    def _add_decide_state(
        self,
        label: str,
        leaf: Leaf,
        transitions: Iterable[StateTransition],
        end: str,
        fails: bool = False,
    ) -> None:
        choices = []
        for transition in transitions:
            to = self._target(transition, end)
            conditions = [_condition(c) for c in transition.conditions]
            choices.append((self._outcome(leaf.parent, to), to, conditions))
        outcomes = sorted({outcome for outcome, _, _ in choices})
        exit_target = "route" if leaf.parent == MISSION else "left"
        self._add_state(
            label,
            f"DecideState(outcomes={outcomes!r}, ways={choices!a}, fails={fails!r})",
            {outcome: exit_target if outcome == "left" else outcome for outcome in outcomes},
        )

    def _action_state(self, leaf: Leaf) -> str:
        """Return the Python call, as source, that makes the FlexBE state for a task's action."""
        task = leaf.task
        arguments = (
            f"task={task.name!a}, pose={_pose(task)!r}, way={_travel_arguments(task)!a}, "
            f"retries={task.retries}, time_limit={task.time_limit or 0.0!r}, "
            f"depth={self.depths[leaf.parent]}"
        )
        if task.action is Action.MEASURE:
            limit = f"reading_limit={task.reading_limit or 0.0!r}"
            return f"MeasureState(object_id={task.object_id!a}, {limit}, {arguments})"
        return f"WaypointState({arguments})"

    def _add_count_state(self, composite: Composite) -> None:
        repeat = composite.repeat
        assert repeat is not None
        onward = next(t for t in composite.transitions if t.kind is not TransitionKind.REPEAT)
        until = [_condition(c) for c in repeat.until]
        self._add_state(
            "round",
            f"CountState(depth={self.depths[composite.id]}, count={repeat.count}, "
            f"duration={repeat.duration!r}, until={until!a}, "
            f"start={self.numbers[composite.initial]}, onward={self._target(onward, 'end')!r})",
            {"again": "route", "over": "left"},
        )

    def _target(self, transition: StateTransition, end: str) -> int | str:
        if transition.completes is not None:
            return -self.depths[transition.completes]
        id = transition.target or DONE
        return end if id == DONE else self.numbers[id]

    def _add_state(self, label: str, state: str, transitions: Mapping[str, str]) -> None:
        autonomy = ", ".join(f"{outcome!r}: Autonomy.Off" for outcome in transitions)
        self.lines += [
            f"            OperatableStateMachine.add({label!r}, {state},",
            f"                transitions={dict(transitions)!r},",
            f"                autonomy={{{autonomy}}},",
            "                remapping=remapping)",
        ]


_KINDS = {
    ConditionType.UNREADABLE: "unreadable",
    ConditionType.UNREACHABLE: "unreachable",
    ConditionType.FAILED: "failed",
    ConditionType.STALE: "stale",
    ConditionType.ABNORMAL: "abnormal",
}


def _condition(c: Condition) -> tuple[str, str, float | None, float | None, bool, float | None]:
    if not c.type.compares:
        return _KINDS[c.type], c.object_id, None, None, False, c.max_age
    low = None if c.type is ConditionType.LESS else c.param1
    high = {ConditionType.LESS: c.param1, ConditionType.GREATER: None}.get(c.type, c.param2)
    return "value", c.object_id, low, high, c.inclusive, c.max_age


def _travel_arguments(task: Task) -> dict[str, object]:
    joints = None if task.joint_states is None else task.joint_states.model_dump()
    named = {} if joints is None else {name: list(values) for name, values in joints.items()}
    return {"velocity": task.velocity or 0.0, "joints": named}


def _pose(task: Task) -> list[float]:
    pose = task.pose
    return [] if pose is None else [pose.x, pose.y, pose.z, pose.yaw]


def _identifier(name: str) -> str:
    """Return the name as an identifier of at most 42 ASCII characters; the result may be empty."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40]
    return f"m_{plain}" if plain[:1].isdigit() else plain
