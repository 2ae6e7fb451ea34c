"""Export of the mission as a behaviour tree for BehaviorTree.CPP 4.

Every task has its position in the mission's list. The blackboard entry `to` is the position of the
transition's target, 0 for the next task; tasks and groups before that position are skipped. So a
tree can skip tasks, but it can go back only by starting another round of a group.
"""

from collections.abc import Iterable, Iterator

from argo_compiler.base.model import Pose
from argo_compiler.base.number_text import number_text
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.export.exporter import (
    Exporter,
    battery_level_report_refusals,
    raise_refusals,
    refusal,
)
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Response,
    Task,
)
from argo_compiler.il.grouping import GroupNesting, GroupRange
from argo_compiler.il.reserved import RETURN_TASK
from argo_compiler.il.transitions import default_target, find_start_pose_task

MAX_MSEC = 2**32 - 1

_TRAVEL_PORTS = (
    ("input_port", "x", "double", "m"),
    ("input_port", "y", "double", "m"),
    ("input_port", "z", "double", "m"),
    ("input_port", "yaw", "double", "rad"),
    ("input_port", "velocity", "double", "m/s on the path to it; 0: the robot's own speed"),
    ("input_port", "not_before", "double", "s on the clock of `Clock`; if it is given, the robot "
     "waits at the pose, and does not start its action before that time"),
    ("input_port", "joint_names", "std::string", "separated by ;"),
    ("input_port", "joint_positions", "std::string", "rad or m, separated by ;"),
    ("input_port", "joint_velocities", "std::string", "rad/s or m/s, separated by ;"),
    ("input_port", "joint_efforts", "std::string", "Nm or N, separated by ;"),
)  # fmt: skip

_READING_PORTS = ("value", "known", "abnormal", "unreadable", "unreachable", "time")
"""Output ports of a Measure node, and names of the blackboard entries that store them."""

_FAILURE_PORTS = ("unreadable", "unreachable")
"""Output ports that state how a measurement has failed."""

_PORTS = {
    "Measure": (
        ("input_port", "object_id", "std::string", "the checkpoint"),
        *_TRAVEL_PORTS,
        ("input_port", "reading_limit", "double", "s for trying to read; 0: the robot's own"),
        ("output_port", "value", "double", "the reading, if it is a number"),
        ("output_port", "known", "double", "1 if `value` was set, else 0"),
        ("output_port", "abnormal", "double", "1 if it is outside the nominal range, else 0"),
        ("output_port", "unreadable", "double", "1 if the robot could not read it, else 0"),
        ("output_port", "unreachable", "double", "1 if the robot could not get to it, else 0"),
        ("output_port", "time", "double", "s on the clock of `Clock`"),
    ),
    "DriveTo": _TRAVEL_PORTS,
    "Clock": (("output_port", "now", "double", "s on a clock that never runs backwards"),),
}
"""Nodes that the robot's side provides: direction, name, type and meaning of their ports."""


def to_btcpp(mission: Mission) -> str:
    """Return a mission in which `check` finds no errors as XML for BehaviorTree.CPP 4.

    Raises:
        DiagnosticError: The mission has parts that a behaviour tree can't express.
    """
    return _Tree(mission).text()


EXPORTER = Exporter("BehaviorTree.CPP 4 tree", (".xml",), lambda given: to_btcpp(given.mission))


class _Tree:
    """Writer of a behaviour tree; holds the positions of tasks and the numbers of checkpoints."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.layout = GroupNesting.from_mission(mission)
        start = find_start_pose_task(mission)
        self.start = start
        self.positions = {task.name: i for i, task in enumerate(mission.tasks, 1)}
        self.end = len(mission.tasks) + 1
        self.objects: dict[str, int] = {}
        for task in mission.tasks:
            if task.object_id is not None:
                self._number(task.object_id)
            for condition in _conditions(task):
                self._number(condition.object_id)
        for group in mission.groups:
            for condition in group.until:
                self._number(condition.object_id)
        self.group_numbers: dict[str, int] = {}
        self.xml = XmlWriter()

    def _number(self, object_id: str) -> None:
        self.objects.setdefault(object_id, len(self.objects) + 1)

    def text(self) -> str:
        """Return the tree as XML. Raises DiagnosticError if a tree can't express the mission."""
        raise_refusals(self._refusals())
        with self.xml.nest_in("root", {"BTCPP_format": "4", "main_tree_to_execute": "Mission"}):
            with self.xml.nest_in("BehaviorTree", {"ID": "Mission"}):
                self._mission()
            self._models()
        return self.xml.text()

    def _refusals(self) -> Iterator[Diagnostic]:
        yield from battery_level_report_refusals(self.mission.reactions)
        for reaction in self.mission.reactions:
            if reaction.response is not Response.REPORT:
                yield refusal(
                    "reaction",
                    f"the reaction to '{reaction.event}' can't be exported to a behaviour tree: no "
                    "node of BehaviorTree.CPP resumes what it interrupted",
                    "let the robot's own tree react, with this tree as a subtree",
                    reaction.source,
                )
        if self.mission.mode is Mode.SUPERVISORY:
            yield refusal(
                "supervisory",
                "the mission starts paused, but a behaviour tree runs as soon as it is ticked",
                "set its mode to autonomous, and tick the tree when a person allows it",
            )
        for task in self.mission.tasks:
            yield from self._task_refusals(task)
            yield from _time_refusals(task)
        for group in self.mission.groups:
            if group.every:
                yield refusal(
                    "every",
                    f"group '{group.name}' starts its rounds at fixed times: no node of "
                    "BehaviorTree.CPP waits until a given time, and a wait between rounds would "
                    "drift",
                    "let each round follow the previous one, or export SCXML",
                    group.source,
                )
            if group.max_repeat_duration * 1000 > MAX_MSEC:
                yield refusal(
                    "too-long",
                    f"the duration of group '{group.name}' is longer than a Timeout node allows: "
                    f"at most {MAX_MSEC / 1000:g} s",
                    span=group.source,
                )

    def _task_refusals(self, task: Task) -> Iterator[Diagnostic]:
        if task.action is not Action.START:
            targets = [transition.target for transition in task.transitions]
            if task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
                targets.append(task.failure_target)
            for target in targets:
                if self.positions[target] <= self.positions[task.name]:
                    yield refusal(
                        "backward",
                        f"the transition from task '{task.name}' back to '{target}' is not a "
                        "group's next round: a behaviour tree can't go back in any other way",
                        "put these tasks and those in between into a group",
                        task.source,
                    )
        texts = [task.object_id or "", *(task.joint_states.names if task.joint_states else ())]
        for text in texts:
            if _is_interpreted(text):
                yield refusal(
                    "name",
                    f"task '{task.name}' uses the name '{text}', which BehaviorTree.CPP would not "
                    "read as plain text",
                    "choose a name without braces and semicolons that does not begin with 'json:'",
                    task.source,
                )

    def _mission(self) -> None:
        """Write the nodes of the whole mission: groups, tasks, and the drive back to the dock."""
        xml = self.xml
        with xml.nest_in("Sequence", {"name": self.mission.designation or None}):
            self._script(self._initial_script())
            if any(task.window and task.window.earliest for task in self.mission.tasks):
                xml.add("Clock", {"now": "{began}"})
            # Not recursive, as groups may be nested to any depth.
            opened: list[GroupRange] = []
            ranges = list(reversed(self.layout.ranges))
            for index, task in enumerate(self.mission.tasks):
                while ranges and ranges[-1].first == index:
                    opened.append(ranges.pop())
                    self._open_group(opened[-1], len(self.layout.ranges) - len(ranges))
                if task.action is not Action.START:
                    self._task(task, bool(self.layout.ending[index]))
                while opened and opened[-1].last == index:
                    closing = opened.pop()
                    outermost = not opened or opened[-1].last != index
                    self._close_group(closing, task if outermost else None)
            self._return_to_dock()

    def _initial_script(self) -> str:
        first = 0
        if self.start is not None:
            target = default_target(self.start)
            first = 0 if target is None else self.positions[target]
        # An entry keeps the type of its first value: one that starts as 0 could never become 0.5.
        entries = [f"to := {first}", "returning := 0", "outcome := 1", "now := 0.0"]
        entries += (f"{name} := 0.0" for name in _READING_PORTS)
        for k in self.objects.values():
            entries += (f"{name}_{k} := 0.0" for name in (*_READING_PORTS, "failed"))
        return "; ".join(entries)

    def _task(self, task: Task, ends_group: bool) -> None:
        xml, position = self.xml, self.positions[task.name]
        with xml.nest_in("Sequence", {"name": task.name, "_skipIf": f"to > {position}"}):
            if task.action is Action.WAIT:
                self._wait(task)
                self._decide(task, ends_group)
            elif task.on_failure is OnFailure.CONTINUE:
                if statements := self._failure_statements(task):
                    with xml.nest_in("Fallback"):
                        self._attempts(task)
                        self._script("; ".join(statements))
                else:
                    with xml.nest_in("ForceSuccess"):
                        self._attempts(task)
                self._decide(task, ends_group)
            else:
                with xml.nest_in("Fallback"):
                    with xml.nest_in("Sequence"):
                        self._attempts(task)
                        self._decide(task, ends_group)
                    self._script(
                        "; ".join(
                            [*self._failure_statements(task), *self._failure_transition(task)]
                        )
                    )

    def _wait(self, task: Task) -> None:
        if task.wait is not None and task.wait.duration:
            self.xml.add("Sleep", {"name": task.name, "msec": _msec(task.wait.duration)})

    def _failure_statements(self, task: Task) -> list[str]:
        """Return the assignments to the blackboard after the task's last attempt has failed."""
        statements = [] if task.optional else ["outcome := 7"]
        if task.action is Action.MEASURE:
            k = self.objects[task.object_id or ""]
            statements += [f"known_{k} := 0.0", f"failed_{k} := 1.0"]
            statements += [f"{kind}_{k} := {kind}" for kind in _FAILURE_PORTS]
        return statements

    def _failure_transition(self, task: Task) -> list[str]:
        if task.on_failure is OnFailure.BRANCH:
            return [f"to := {self.positions[task.failure_target or '']}"]
        if task.on_failure is OnFailure.RETURN:
            return [f"to := {self.end}", "returning := 1"]
        return [f"to := {self.end}", "outcome := 5"]

    def _attempts(self, task: Task) -> None:
        """Write the attempts at a task until one succeeds; after a MEASURE, store its reading."""
        with self.xml.nest_in("Sequence"):
            if task.window is not None and task.window.earliest:
                earliest = number_text(task.window.earliest)
                self._script(f"not_before := began + {earliest}")
            if task.retries:
                attempts = {"num_attempts": task.retries + 1}
                with self.xml.nest_in("RetryUntilSuccessful", attempts):
                    self._attempt(task)
            else:
                self._attempt(task)
            if task.action is Action.MEASURE:
                k = self.objects[task.object_id or ""]
                stored = [name for name in _READING_PORTS if name not in _FAILURE_PORTS]
                statements = [f"{name}_{k} := {name}" for name in stored]
                statements += [f"failed_{k} := 1.0 - known", f"unreadable_{k} := 1.0 - known"]
                self._script("; ".join([*statements, f"unreachable_{k} := 0.0"]))

    def _attempt(self, task: Task) -> None:
        measures = task.action is Action.MEASURE
        if measures:
            self.xml.open("Sequence")
            # They stay so if the attempt times out.
            self._script("; ".join(f"{kind} := 0.0" for kind in _FAILURE_PORTS))
        if task.time_limit is None:
            self._action(task)
        else:
            with self.xml.nest_in("Timeout", {"msec": _msec(task.time_limit)}):
                self._action(task)
        if measures:
            self.xml.close()

    def _action(self, task: Task) -> None:
        ports: Attributes = _pose_ports(task.pose)
        if task.action is Action.MEASURE:
            outputs = {name: f"{{{name}}}" for name in _READING_PORTS}
            limit = task.reading_limit or 0.0
            ports = {"object_id": task.object_id, **ports, "reading_limit": limit, **outputs}
        if task.window is not None and task.window.earliest:
            ports = {**ports, "not_before": "{not_before}"}
        name = "Measure" if task.action is Action.MEASURE else "DriveTo"
        velocity = {"velocity": task.velocity or 0.0}
        self.xml.add(name, {"name": task.name, **ports, **velocity, **_joints(task.joint_states)})

    def _decide(self, task: Task, ends_group: bool) -> None:
        """Write the tree's script that sets the blackboard entry `to`: the position to continue at.

        The position is that of a task or of the mission's end; 0 stands for what comes next in the
        tree. The script evaluates the transitions from the last to the first, so that the first one
        whose conditions are satisfied prevails. If there is none, `to` is the target of the
        unconditional transition, or 0 if the task ends a group (`ends_group`).
        """
        if _use_ages(_conditions(task)):
            self.xml.add("Clock", {"now": "{now}"})
        # At a group's end, `_close_group` takes the unconditional transition after the last round.
        statements = [f"to := {0 if ends_group else self._default(task)}"]
        for transition in reversed([t for t in task.transitions if t.conditions]):
            guard = self._conjunction(transition.conditions)
            statements.append(f"to := ({guard}) ? {self.positions[transition.target]} : to")
        self._script("; ".join(statements))

    def _default(self, task: Task) -> int:
        target = default_target(task)
        to = self.end if target is None else self.positions[target]
        return 0 if to == self.positions[task.name] + 1 else to

    def _conjunction(self, conditions: Iterable[Condition]) -> str:
        return " && ".join(f"({self._guard(c)})" for c in conditions)

    def _guard(self, condition: Condition) -> str:
        k = self.objects[condition.object_id]
        age = f"(now - time_{k})"
        if condition.type is ConditionType.UNREADABLE:
            return f"unreadable_{k} == 1"
        if condition.type is ConditionType.UNREACHABLE:
            return f"unreachable_{k} == 1"
        if condition.type is ConditionType.FAILED:
            return f"failed_{k} == 1"
        if condition.type is ConditionType.STALE:
            return f"(known_{k} == 1) && ({age} > {number_text(condition.max_age or 0.0)})"
        tests = [f"known_{k} == 1"]
        if condition.max_age is not None:
            tests.append(f"{age} <= {number_text(condition.max_age)}")
        if condition.type is ConditionType.ABNORMAL:
            tests.append(f"abnormal_{k} == 1")
        else:
            tests += self._comparisons(condition, f"value_{k}")
        return " && ".join(f"({test})" for test in tests)

    def _comparisons(self, condition: Condition, value: str) -> Iterator[str]:
        less = "<=" if condition.inclusive else "<"
        more = ">=" if condition.inclusive else ">"
        if condition.type is ConditionType.LESS:
            yield f"{value} {less} {number_text(condition.param1 or 0.0)}"
        else:
            yield f"{value} {more} {number_text(condition.param1 or 0.0)}"
        if condition.type is ConditionType.WITHIN:
            yield f"{value} {less} {number_text(condition.param2 or 0.0)}"

    def _open_group(self, r: GroupRange, n: int) -> None:
        xml, group = self.xml, r.group
        xml.open("Sequence", {"name": group.name, "_skipIf": f"to > {r.last + 1}"})
        self._script(f"round_{n} := 1")
        if group.max_repeat_duration:
            xml.add("Clock", {"now": f"{{entered_{n}}}"})
        if _is_timed(r):
            xml.open("Fallback")
            xml.open("Timeout", {"msec": _msec(group.max_repeat_duration)})
        xml.open("ForceSuccess")
        xml.open("Repeat", {"num_cycles": -1})
        xml.open("Sequence")
        self.group_numbers[group.name] = n

    def _close_group(self, r: GroupRange, end: Task | None) -> None:
        """Write the nodes that end a group's round: another round, or what follows the group.

        `end` is the last task of the group if no group around it ends with that task too. It is
        None otherwise, and what follows is not written: it is decided only once, after the
        outermost of these groups.
        """
        xml, group = self.xml, r.group
        n = self.group_numbers[group.name]
        tests = [f"to <= {r.last + 1}"]
        if group.max_repeat_count:
            tests.append(f"round_{n} < {group.max_repeat_count}")
        if group.max_repeat_duration or _use_ages(group.until):
            xml.add("Clock", {"now": "{now}"})
        if group.until:
            self._script(f"over_{n} := ({self._conjunction(group.until)}) ? 1 : 0")
            tests.append(f"over_{n} == 0")
        if group.max_repeat_duration:
            tests.append(f"(now - entered_{n}) < {number_text(group.max_repeat_duration)}")
        xml.add("ScriptCondition", {"code": " && ".join(f"({test})" for test in tests)})
        self._script(f"round_{n} := round_{n} + 1")
        for _ in range(3):
            xml.close()
        if _is_timed(r):
            xml.close()
            self._script("to := 0")
            xml.close()
        if end is not None and self._default(end):
            self._script(f"to := (to > {r.last + 1}) ? to : {self._default(end)}")
        xml.close()

    def _return_to_dock(self) -> None:
        if all(task.on_failure is not OnFailure.RETURN for task in self.mission.tasks):
            return
        dock = _pose_ports(self.mission.dock)
        with self.xml.nest_in("Fallback", {"_skipIf": "returning == 0"}):
            with self.xml.nest_in("Sequence"):
                self.xml.add("DriveTo", {"name": RETURN_TASK, **dock, "velocity": "0"})
                self._script("outcome := 2")
            self._script("outcome := 4")

    def _script(self, code: str) -> None:
        self.xml.add("Script", {"code": code})

    def _models(self) -> None:
        with self.xml.nest_in("TreeNodesModel"):
            for node, ports in _PORTS.items():
                with self.xml.nest_in("Action", {"ID": node}):
                    for direction, name, type, meaning in ports:
                        self.xml.add_text(direction, meaning, {"name": name, "type": type})


def _conditions(task: Task) -> Iterator[Condition]:
    for transition in task.transitions:
        yield from transition.conditions


def _time_refusals(task: Task) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each wait, window or limit of a task that a tree can't express."""
    window, wait = task.window, task.wait
    if wait is not None and wait.duration is None:
        yield refusal(
            "wait",
            f"task '{task.name}' waits for an event or for conditions: no node of "
            "BehaviorTree.CPP does that",
            "wait for a duration, or export SCXML",
            task.source,
        )
    if window is not None and window.hard and window.latest is not None:
        yield refusal(
            "window",
            f"task '{task.name}' has a hard time window: no node of BehaviorTree.CPP ends at a "
            "given time after the mission's start",
            "make the window soft, or export SCXML",
            task.source,
        )
    if window is not None and window.earliest and (wait is not None or task.time_limit is not None):
        use = "waits" if wait is not None else "has a time limit"
        yield refusal(
            "window",
            f"task '{task.name}' {use} and has a window with an earliest time: a behaviour tree "
            "can't express both together",
            "remove one of the two, or export SCXML",
            task.source,
        )
    for duration_name, seconds in (
        ("the time limit", task.time_limit),
        ("the wait", None if wait is None else wait.duration),
    ):
        if seconds is not None and seconds * 1000 > MAX_MSEC:
            yield refusal(
                "too-long",
                f"{duration_name} of task '{task.name}' is longer than a node allows: at most "
                f"{MAX_MSEC / 1000:g} s",
                span=task.source,
            )


def _msec(seconds: float) -> int:
    """Return the duration in whole milliseconds, rounded up."""
    return -int(-seconds * 1000 // 1)


def _joints(joints: JointState | None) -> Attributes:
    if joints is None:
        return {}
    values = {
        "joint_positions": joints.positions,
        "joint_velocities": joints.velocities,
        "joint_efforts": joints.efforts,
    }
    listed = {
        port: ";".join(map(number_text, numbers)) for port, numbers in values.items() if numbers
    }
    return {"joint_names": ";".join(joints.names), **listed}


def _use_ages(conditions: Iterable[Condition]) -> bool:
    return any(condition.max_age is not None for condition in conditions)


def _pose_ports(pose: Pose | None) -> Attributes:
    return {} if pose is None else pose.model_dump()


def _is_timed(r: GroupRange) -> bool:
    return r.group.has_hard_stop


def _is_interpreted(text: str) -> bool:
    """Return True if a port of a tree's node would not read the text as plain text.

    It takes `{x}` for an entry of the blackboard, `;` for a list, and `json:` for data.
    """
    return text.startswith("json:") or any(character in text for character in "{};")
