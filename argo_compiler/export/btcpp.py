"""BehaviorTree.CPP 4: the mission as a behaviour tree.

Every task has its position in the mission's list. The blackboard entry `to` is the position that a
transition has chosen, 0 for the next task; tasks and groups that lie before it are skipped. So a
tree can leave tasks out, but can't go back other than by a group's rounds.
"""

from collections.abc import Iterator

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.export.exporter import refusal, refuse
from argo_compiler.export.xml import Attributes, XmlWriter, number
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Mission,
    OnFailure,
    Response,
    Stop,
    Task,
)
from argo_compiler.il.grouping import GroupNesting, GroupRange
from argo_compiler.il.reserved import RETURN_TASK
from argo_compiler.model import Pose

MAX_MSEC = 2**32 - 1

_PORTS = {
    "Measure": (
        ("input_port", "object_id", "std::string", "the checkpoint"),
        ("input_port", "velocity", "double", "m/s on the way to it; 0: the robot's own"),
        ("input_port", "joint_names", "std::string", "separated by ;"),
        ("input_port", "joint_positions", "std::string", "rad or m, separated by ;"),
        ("output_port", "value", "double", "what was read; left alone if that is no number"),
        ("output_port", "known", "double", "1 if `value` was set; left alone otherwise"),
        ("output_port", "time", "double", "s on the clock of `Clock`, if `value` was set"),
    ),
    "DriveTo": (
        ("input_port", "x", "double", "m"),
        ("input_port", "y", "double", "m"),
        ("input_port", "z", "double", "m"),
        ("input_port", "yaw", "double", "rad"),
        ("input_port", "velocity", "double", "m/s on the way to it; 0: the robot's own"),
        ("input_port", "joint_names", "std::string", "separated by ;"),
        ("input_port", "joint_positions", "std::string", "rad or m, separated by ;"),
    ),
    "Clock": (("output_port", "now", "double", "s on a clock that never runs backwards"),),
}
"""The nodes that the robot's side provides: direction, name, type and meaning of their ports."""


def to_btcpp(mission: Mission) -> str:
    """The mission, in which `check` finds no errors, as XML for BehaviorTree.CPP 4.

    Raises:
        DiagnosticError: the mission has what a tree can't say.
    """
    return _Tree(mission).text()


class _Tree:
    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.layout = GroupNesting.of(mission)
        start = next((t for t in mission.tasks if t.action is Action.START), None)
        self.start = start
        self.position = {task.name: i for i, task in enumerate(mission.tasks, 1)}
        self.end = len(mission.tasks) + 1
        self.objects: dict[str, int] = {}
        for task in mission.tasks:
            if task.object_id is not None:
                self._number(task.object_id)
            for condition in _conditions(task):
                self._number(condition.object_id)
        self.group_numbers: dict[str, int] = {}
        self.xml = XmlWriter()

    def _number(self, object_id: str) -> None:
        self.objects.setdefault(object_id, len(self.objects) + 1)

    def text(self) -> str:
        refuse(self._refusals())
        with self.xml.element("root", {"BTCPP_format": "4", "main_tree_to_execute": "Mission"}):
            with self.xml.element("BehaviorTree", {"ID": "Mission"}):
                self._mission()
            self._models()
        return self.xml.text()

    def _refusals(self) -> Iterator[Diagnostic]:
        for reaction in self.mission.reactions:
            if reaction.response is not Response.REPORT:
                yield refusal(
                    "reaction",
                    f"the reaction to '{reaction.event}' can't be said in a behaviour tree: no "
                    "node of BehaviorTree.CPP goes on with what it interrupted",
                    "let the robot's own tree react, with this one as a subtree",
                    reaction.source,
                )
        for task in self.mission.tasks:
            yield from self._task_refusals(task)
        for group in self.mission.groups:
            if group.max_repeat_duration * 1000 > MAX_MSEC:
                yield refusal(
                    "too-long",
                    f"the duration of group '{group.name}' is longer than a Timeout node takes, "
                    f"{MAX_MSEC / 1000:g} s",
                    span=group.source,
                )

    def _task_refusals(self, task: Task) -> Iterator[Diagnostic]:
        if task.action is not Action.START:
            for transition in task.transitions:
                if self.position[transition.target] <= self.position[task.name]:
                    yield refusal(
                        "backward",
                        f"the transition of task '{task.name}' back to '{transition.target}' is "
                        "none of a group's rounds: a behaviour tree has no such edges",
                        "put the tasks in between into a group",
                        task.source,
                    )
        texts = [task.object_id or "", *(task.joint_states.names if task.joint_states else ())]
        for text in texts:
            if _means_something(text):
                yield refusal(
                    "name",
                    f"task '{task.name}' uses the name '{text}', which BehaviorTree.CPP would not "
                    "take as text",
                    "choose a name without braces, semicolons and 'json:'",
                    task.source,
                )

    def _mission(self) -> None:
        xml = self.xml
        with xml.element("Sequence", {"name": self.mission.designation or None}):
            self._script(self._initially())
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
            self._return()

    def _initially(self) -> str:
        first = 0
        if self.start is not None:
            targets = [t.target for t in self.start.transitions if not t.conditions]
            first = self.position[targets[0]] if targets else 0
        velocity = (self.start.velocity if self.start else None) or 0.0
        # An entry keeps the type that it begins with: 0 would never hold 0.5.
        entries = [f"to := {first}", "returning := 0", "outcome := 1", "now := 0.0"]
        entries.append(f"velocity := {velocity!r}")
        for k in self.objects.values():
            entries += (f"{port}_{k} := 0.0" for port in ("known", "value", "time"))
        return "; ".join(entries)

    def _task(self, task: Task, ends_group: bool) -> None:
        xml, at = self.xml, self.position[task.name]
        with xml.element("Sequence", {"name": task.name, "_skipIf": f"to > {at}"}):
            if task.on_failure is OnFailure.CONTINUE:
                with xml.element("ForceSuccess"):
                    self._attempts(task)
                self._decide(task, ends_group)
            else:
                with xml.element("Fallback"):
                    with xml.element("Sequence"):
                        self._attempts(task)
                        self._decide(task, ends_group)
                    if task.on_failure is OnFailure.RETURN:
                        self._script(f"to := {self.end}; returning := 1")
                    else:
                        self._script(f"to := {self.end}; outcome := 5")

    def _attempts(self, task: Task) -> None:
        if not task.retries:
            self._action(task)
            return
        with self.xml.element("RetryUntilSuccessful", {"num_attempts": task.retries + 1}):
            self._action(task)

    def _action(self, task: Task) -> None:
        joints: Attributes = {}
        if task.joint_states is not None:
            joints = {
                "joint_names": ";".join(task.joint_states.names),
                "joint_positions": ";".join(number(p) for p in task.joint_states.positions),
            }
        if task.action is Action.MEASURE:
            k = self.objects[task.object_id or ""]
            outputs = {port: f"{{{port}_{k}}}" for port in ("value", "known", "time")}
            where: Attributes = {"object_id": task.object_id, **outputs}
        else:
            where = _pose_ports(task.pose)
        name = "Measure" if task.action is Action.MEASURE else "DriveTo"
        self.xml.add(name, {"name": task.name, **where, "velocity": "{velocity}", **joints})

    def _decide(self, task: Task, ends_group: bool) -> None:
        """Sets `to`. The last condition is looked at first, so that the first one prevails."""
        if any(condition.max_age is not None for condition in _conditions(task)):
            self.xml.add("Clock", {"now": "{now}"})
        # The unconditional transition of a group's end is for the time after its last round.
        statements = [f"to := {0 if ends_group else self._default(task)}"]
        for transition in reversed([t for t in task.transitions if t.conditions]):
            holds = " && ".join(f"({self._holds(c)})" for c in transition.conditions)
            statements.append(f"to := ({holds}) ? {self.position[transition.target]} : to")
        statements.append(f"velocity := {task.velocity or 0.0!r}")
        self._script("; ".join(statements))

    def _default(self, task: Task) -> int:
        target = next((t.target for t in task.transitions if not t.conditions), None)
        to = self.end if target is None else self.position[target]
        return 0 if to == self.position[task.name] + 1 else to

    def _holds(self, condition: Condition) -> str:
        k = self.objects[condition.object_id]
        less = "<=" if condition.inclusive else "<"
        more = ">=" if condition.inclusive else ">"
        tests = [f"known_{k} == 1"]
        if condition.max_age is not None:
            tests.append(f"(now - time_{k}) <= {number(condition.max_age)}")
        if condition.type is ConditionType.LESS:
            tests.append(f"value_{k} {less} {number(condition.param1 or 0.0)}")
        else:
            tests.append(f"value_{k} {more} {number(condition.param1 or 0.0)}")
        if condition.type is ConditionType.WITHIN:
            tests.append(f"value_{k} {less} {number(condition.param2 or 0.0)}")
        return " && ".join(f"({test})" for test in tests)

    def _open_group(self, r: GroupRange, n: int) -> None:
        xml, group = self.xml, r.group
        xml.open("Sequence", {"name": group.name, "_skipIf": f"to > {r.last + 1}"})
        self._script(f"round_{n} := 1")
        if group.max_repeat_duration:
            xml.add("Clock", {"now": f"{{entered_{n}}}"})
        if _is_timed(r):
            xml.open("Fallback")
            msec = -int(-group.max_repeat_duration * 1000 // 1)
            xml.open("Timeout", {"msec": msec})
        xml.open("ForceSuccess")
        xml.open("Repeat", {"num_cycles": -1})
        xml.open("Sequence")
        self.group_numbers[group.name] = n

    def _close_group(self, r: GroupRange, end: Task | None) -> None:
        """The end of a round. `end`: the end task, of the outermost group that ends with it."""
        xml, group = self.xml, r.group
        n = self.group_numbers[group.name]
        tests = [f"to <= {r.last + 1}"]
        if group.max_repeat_count:
            tests.append(f"round_{n} < {group.max_repeat_count}")
        if group.max_repeat_duration:
            xml.add("Clock", {"now": "{now}"})
            tests.append(f"(now - entered_{n}) < {number(group.max_repeat_duration)}")
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

    def _return(self) -> None:
        if all(task.on_failure is not OnFailure.RETURN for task in self.mission.tasks):
            return
        dock = _pose_ports(self.mission.dock)
        with self.xml.element("Fallback", {"_skipIf": "returning == 0"}):
            with self.xml.element("Sequence"):
                self.xml.add("DriveTo", {"name": RETURN_TASK, **dock, "velocity": "0"})
                self._script("outcome := 2")
            self._script("outcome := 4")

    def _script(self, code: str) -> None:
        self.xml.add("Script", {"code": code})

    def _models(self) -> None:
        with self.xml.element("TreeNodesModel"):
            for node, ports in _PORTS.items():
                with self.xml.element("Action", {"ID": node}):
                    for direction, name, type, meaning in ports:
                        self.xml.add_text(direction, meaning, {"name": name, "type": type})


def _conditions(task: Task) -> Iterator[Condition]:
    for transition in task.transitions:
        yield from transition.conditions


def _pose_ports(pose: Pose | None) -> Attributes:
    return {} if pose is None else pose.model_dump()


def _is_timed(r: GroupRange) -> bool:
    return bool(r.group.max_repeat_duration) and r.group.stop is Stop.HARD


def _means_something(text: str) -> bool:
    """Whether a port would not take the text as it is."""
    return text.startswith("json:") or any(character in text for character in "{};")
