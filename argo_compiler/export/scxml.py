"""Export of the machine as a W3C state chart (SCXML), for engines with the ECMAScript data model.

Three regions run in parallel. `plan` contains the mission's groups and tasks; `control` records
whether the mission runs, is paused, or a reaction has the robot; `actuator` starts and cancels
actions, one at a time. The expressions are simple enough to be valid Python as well.
`docs/export.md` describes the events that the chart receives and the data that a driver of the
chart reads.
"""

from collections.abc import Sequence

from argo_compiler.base.number_text import number_text
from argo_compiler.export.scxml_control import (
    ControlRegion,
    outcome_code,
    round_due_expression,
    write_outcome_states,
)
from argo_compiler.export.scxml_data import (
    ARGO,
    DEADLINES,
    NEVER,
    ChartIds,
    assign,
    task_attributes,
    write_data_model,
    write_group_timer_start,
    write_timer_cancel,
    write_timer_start,
)
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Composite, Hfsm, Leaf, Outcome, StateTransition, TransitionKind
from argo_compiler.hfsm.model import DONE, RETURN, RepeatRule
from argo_compiler.il import Condition, ConditionType, Mission, Task
from argo_compiler.il.transitions import find_start_pose_task

NAMESPACE = "http://www.w3.org/2005/07/scxml"

_NONE, _VALUE, _UNREADABLE, _UNREACHABLE, _FAILED = range(5)
"""Values of `known_…` in the data: the kind of a checkpoint's last reading."""


def to_scxml(mission: Mission, hfsm: Hfsm, timers: bool = False) -> str:
    """Return the machine as an SCXML document.

    With `timers`, the engine that runs the chart sends the time-outs itself (`<send delay>`).
    Without, the time-outs come from outside like all other events, so that any clock can drive the
    machine.
    """
    start = find_start_pose_task(mission)
    return _Document(hfsm, start, timers).text()


class _Document:
    def __init__(self, hfsm: Hfsm, start: Task | None, timers: bool) -> None:
        self.hfsm = hfsm
        self.start = start
        self.timers = timers
        self.ids = ChartIds(hfsm)
        self.composites = {c.id: c for c in hfsm.composites}
        self.leaves = {leaf.id: leaf for leaf in hfsm.leaves}
        self.xml = XmlWriter()

    def text(self) -> str:
        xml = self.xml
        root = {
            "xmlns": NAMESPACE,
            "xmlns:argo": ARGO,
            "version": "1.0",
            "datamodel": "ecmascript",
            "initial": "run",
            "argo:max_duration": self.hfsm.max_duration,
        }
        with xml.nest_in("scxml", root):
            write_data_model(xml, self.hfsm, self.ids)
            with xml.nest_in("parallel", {"id": "run"}):
                if self.timers and self.hfsm.max_duration is not None:
                    limit = number_text(self.hfsm.max_duration)
                    with xml.nest_in("onentry"):
                        time_up = {"event": "event.time_up", "delay": f"{limit}s"}
                        with xml.nest_in("send", time_up):
                            xml.add("param", {"name": "time", "expr": limit})
                self._mission_region()
                ControlRegion(xml, self.hfsm, self.ids, self.timers).write()
                self._actuator_region()
            write_outcome_states(xml)
        return xml.text()

    def _mission_region(self) -> None:
        """Write the region `plan`, with the states of the mission's groups and tasks.

        This is not recursive, as groups may be nested to any depth.
        """
        xml = self.xml
        xml.open("state", {"id": "plan", "initial": "start", "argo:name": self.hfsm.mission.name})
        attributes = {} if self.start is None else task_attributes(self.start)
        with xml.nest_in("state", {"id": "start", **attributes}):
            xml.add("transition", {"target": self._target(self.hfsm.mission.initial)})
        # None in the stack closes a group.
        pending: list[str | None] = [None, *reversed(self.hfsm.mission.children)]
        while pending:
            id = pending.pop()
            if id is None:
                xml.close()
            elif id == DONE:
                self._end_state()
            elif leaf := self.leaves.get(id):
                self._task_state(leaf)
            else:
                group = self.composites[id]
                self._open_group(group)
                pending += [None, *reversed(group.children)]

    def _end_state(self) -> None:
        xml = self.xml
        with xml.nest_in("state", {"id": "ended"}), xml.nest_in("onentry"):
            self._assign([("visit", "0"), *((f"due_{kind}", "0") for kind in _VISIT_DEADLINES)])
            with xml.nest_in("if", {"cond": "ends == 0 && failures == 0"}):
                assign(xml, "ends", str(outcome_code(Outcome.COMPLETED)))
            with xml.nest_in("if", {"cond": "ends == 0"}):
                assign(xml, "ends", str(outcome_code(Outcome.COMPLETED_WITH_FAILURES)))

    # Groups

    def _open_group(self, group: Composite) -> None:
        xml, n = self.xml, self.ids.groups[group.id]
        repeat = _repeat(group)
        clock = _clock(repeat)
        xml.open(
            "state",
            {
                "id": f"g{n}",
                "initial": self._state(group.children[0]),
                "argo:name": group.name,
                "argo:clock": clock,
            },
        )
        with xml.nest_in("onentry"):
            assign(xml, f"round_{n}", "1")
            self._set_group_clock(group)
            if repeat.duration:
                # In a round that is not due yet: the round's start enters the group again.
                with xml.nest_in("if", {"cond": "awaits != 0"}):
                    assign(xml, f"until_{n}", NEVER)
            if self.timers and group.timeout:
                with xml.nest_in("if", {"cond": "mode == 0 && awaits == 0"}):
                    write_group_timer_start(xml, n, repeat.count_interruptions)
        if group.timeout:
            with xml.nest_in("transition", {"event": f"timeout.g{n}"}):
                self._assign([("now", "_event.data.time"), ("clock", "now - lost")])
                self._assign([("visit", "0"), ("completed", str(n))])
        if repeat.every:
            self._round_start(group)
        for transition in group.transitions:
            self._group_transition(group, transition)
        if self.timers and group.timeout:
            with xml.nest_in("onexit"):
                xml.add("cancel", {"sendid": f"timer_{n}"})

    def _set_group_clock(self, group: Composite) -> None:
        n, repeat = self.ids.groups[group.id], _repeat(group)
        if repeat.duration:
            assign(self.xml, f"until_{n}", f"{_clock(repeat)} + {number_text(repeat.duration)}")
        if repeat.every:
            assign(self.xml, f"entered_{n}", _clock(repeat))

    def _round_start(self, group: Composite) -> None:
        """Write the transition that starts a group's round at its planned time (`every`).

        The transition enters all states inside the group anew, which sets their clocks.
        """
        attributes = {
            "event": "timeout.round",
            "cond": f"mode == 0 && awaits == {self.ids.groups[group.id]}",
            "target": self._state(group.initial),
            "type": "internal",
        }
        with self.xml.nest_in("transition", attributes):
            self._assign([("now", "_event.data.time"), ("clock", "now - lost")])
            self._assign([("awaits", "0"), ("due_round", "0")])

    def _group_transition(self, group: Composite, transition: StateTransition) -> None:
        n, repeat = self.ids.groups[group.id], _repeat(group)
        ended = f"completed == {n}"
        if transition.kind is not TransitionKind.REPEAT:
            self._onward_transition(transition, ended)
            return
        if repeat.until:
            onward = next(t for t in group.transitions if t.kind is not TransitionKind.REPEAT)
            self._onward_transition(onward, " && ".join([ended, *map(self._guard, repeat.until)]))
        cond = ended
        clock = _clock(repeat)
        if repeat.count:
            cond += f" && round_{n} < {repeat.count}"
        if repeat.duration:
            cond += f" && {clock} < until_{n}"
            if repeat.every:
                cond += (
                    f" && round_{n} * {number_text(repeat.every)} < {number_text(repeat.duration)}"
                )
        target = self._target(transition.target)
        attributes = {"cond": cond, "target": target, "type": "internal"}
        with self.xml.nest_in("transition", attributes):
            self._assign([("completed", "0"), ("awaits", "0"), ("due_round", "0")])
            assign(self.xml, f"round_{n}", f"round_{n} + 1")
            if repeat.every:
                due = f"entered_{n} + (round_{n} - 1) * {number_text(repeat.every)}"
                with self.xml.nest_in("if", {"cond": f"{due} > {clock}"}):
                    self._assign(
                        [("awaits", str(n)), ("due_round", round_due_expression(n, repeat))]
                    )

    # Tasks

    def _task_state(self, leaf: Leaf) -> None:
        """Write a task's state: `…_act` until its action or wait is over, then `…_end` to decide.

        `…_end` is active only for the moment in which the next transition is chosen.

        Guards are evaluated before a transition's assignments, so a value has to be stored in one
        transition for the next one to see it.
        """
        xml, id = self.xml, self._state(leaf.id)
        task = leaf.task
        with xml.nest_in("state", {"id": id, "initial": f"{id}_act", **task_attributes(task)}):
            with xml.nest_in("onentry"):
                self._task_entry(leaf, id)
            with xml.nest_in("state", {"id": f"{id}_act"}):
                self._missed_window(leaf)
                if task.wait is not None:
                    self._wait_transitions(leaf, f"{id}_end")
                else:
                    self._action_transitions(leaf, f"{id}_end")
            with xml.nest_in("state", {"id": f"{id}_end"}):
                for transition in leaf.transitions:
                    guards = (self._guard(c) for c in transition.conditions)
                    self._onward_transition(transition, " && ".join(["completed == 0", *guards]))
            if self.timers:
                with xml.nest_in("onexit"):
                    for kind in self.ids.deadlines:
                        write_timer_cancel(xml, kind)

    def _task_entry(self, leaf: Leaf, id: str) -> None:
        xml, task = self.xml, leaf.task
        window = task.window
        waits = task.wait is not None
        self._assign(
            [
                ("fails", "0"),
                ("count", "count + 1"),
                ("visit", "0" if waits else "count"),
                ("first", "count"),
                ("place", f"'{id}'"),
                ("object", str(self.ids.measured_object_number_or_0(task))),
                ("limit", number_text(0 if waits else task.time_limit or 0)),
                ("earliest", number_text(0 if window is None else window.earliest)),
                ("occurred", "0"),
                ("look", "1"),
                ("due_action", "0"),
                ("due_window", number_text(_hard_deadline(task) or 0)),
            ]
        )
        self._set_wait_deadlines(leaf)
        # In a round that is not due yet, the task's own deadlines are set when the round starts.
        own = ["due_wait", "due_limit"] if waits else []
        if _hard_deadline(task) is not None:
            own.append("due_window")
        if own:
            with xml.nest_in("if", {"cond": "awaits != 0"}):
                self._assign([(due, "0") for due in own])
        if self.timers:
            with xml.nest_in("if", {"cond": "mode == 0"}):
                for kind in self.ids.deadlines:
                    write_timer_start(xml, kind)

    def _set_wait_deadlines(self, leaf: Leaf) -> None:
        """Write the assignments of a WAIT's deadlines, which count from the entry of its state.

        For a task that is no WAIT, they clear the deadlines.
        """
        xml, wait = self.xml, leaf.task.wait
        if wait is None:
            self._assign([("due_wait", "0"), ("due_limit", "0")])
            return
        limit = "0" if wait.limit is None else f"now + {number_text(wait.limit)}"
        end = "now" if wait.duration is None else f"now + {number_text(wait.duration)}"
        self._assign([("due_limit", limit), ("due_wait", end)])
        with xml.nest_in("if", {"cond": "due_wait < earliest"}):
            assign(xml, "due_wait", "earliest")
        if wait.duration is None:
            # Without a duration, only the start of the window is a deadline.
            with xml.nest_in("if", {"cond": "due_wait <= now"}):
                assign(xml, "due_wait", "0")

    def _wait_transitions(self, leaf: Leaf, end: str) -> None:
        xml, wait = self.xml, leaf.task.wait
        assert wait is not None
        going = "mode == 0 && awaits == 0 && completed == 0"
        if wait.duration is not None:
            xml.add("transition", {"cond": f"{going} && now >= due_wait", "target": end})
        if wait.event is not None:
            event = {"event": f"event.{wait.event}", "cond": "awaits == 0"}
            with xml.nest_in("transition", event):
                assign(xml, "occurred", "1")
            cond = f"{going} && occurred == 1 && now >= earliest"
            xml.add("transition", {"cond": cond, "target": end})
        if wait.conditions:
            cond = f"{going} && look == 1 && now >= earliest"
            all_satisfied = " && ".join([cond, *map(self._guard, wait.conditions)])
            xml.add("transition", {"cond": all_satisfied, "target": end})
            with xml.nest_in("transition", {"cond": cond}):
                assign(xml, "look", "0")
        with xml.nest_in("transition", {"event": "timeout.wait", "cond": going}):
            self._assign([("now", "_event.data.time"), ("clock", "now - lost")])
            if wait.duration is None:
                assign(xml, "due_wait", "0")
        if wait.limit is not None:
            self._failure_transition("timeout.limit", going, leaf, leaf.failure)

    def _action_transitions(self, leaf: Leaf, end: str) -> None:
        xml = self.xml
        # In `stopping`, the cancellation may be the cause of the failure.
        failed = "running == visit && In('busy')"
        limited = "mode == 0 && running == visit && In('busy')"
        if leaf.task.retries:
            again = f"fails < {leaf.task.retries}"
            event: Attributes = {"event": "action.failed", "cond": f"{failed} && {again}"}
            with xml.nest_in("transition", event):
                assign(xml, "fails", "fails + 1")
            if leaf.task.time_limit is not None:
                event = {"event": "timeout.action", "cond": f"{limited} && {again}"}
                with xml.nest_in("transition", event):
                    self._assign([("now", "_event.data.time"), ("clock", "now - lost")])
                    self._assign([("fails", "fails + 1"), ("count", "count + 1")])
                    self._assign([("visit", "count"), ("due_action", "0")])
        if leaf.task.time_limit is not None:
            self._failure_transition("timeout.action", limited, leaf, leaf.failure)
        served = "running >= first && running_place == place"
        if leaf.id == RETURN:
            self._end_of_visit("action.failed", failed, "ended", Outcome.FAILED)
            self._end_of_visit("action.succeeded", served, "ended", Outcome.RETURNED)
        else:
            self._failure_transition("action.failed", failed, leaf, leaf.failure)
            self._end_of_visit("action.succeeded", served, end, None)

    def _missed_window(self, leaf: Leaf) -> None:
        if _hard_deadline(leaf.task) is None:
            return
        transition = leaf.missed or leaf.failure
        self._failure_transition("timeout.window", "mode == 0 && awaits == 0", leaf, transition)

    def _failure_transition(
        self, event: str, cond: str, leaf: Leaf, transition: StateTransition | None
    ) -> None:
        """Write the transition of the chart for a task that has failed for good.

        It occurs at `event` if `cond` is true. The machine takes `transition`, or if that is None
        the transitions after a success.
        """
        xml, task = self.xml, leaf.task
        target = (
            f"{self._state(leaf.id)}_end" if transition is None else self._target(transition.target)
        )
        with xml.nest_in("transition", {"event": event, "cond": cond, "target": target}):
            self._assign([("now", "_event.data.time"), ("clock", "now - lost")])
            if k := self.ids.measured_object_number_or_0(task):
                self._assign(
                    [
                        (f"known_{k}", str(_FAILED)),
                        (f"time_{k}", "now"),
                        (f"abnormal_{k}", "0"),
                        ("look", "1"),
                    ]
                )
                if event == "action.failed":
                    for name, kind in (("unreachable", _UNREACHABLE), ("unreadable", _UNREADABLE)):
                        with xml.nest_in("if", {"cond": f"_event.data.{name} == 1"}):
                            assign(xml, f"known_{k}", str(kind))
            if not task.optional:
                assign(xml, "failures", "failures + 1")
            if transition is not None and transition.target == DONE:
                assign(xml, "ends", str(outcome_code(Outcome.ABORTED)))
            assign(xml, "visit", "0")

    def _end_of_visit(self, event: str, cond: str, target: str, outcome: Outcome | None) -> None:
        attributes = {"event": event, "cond": cond, "target": target}
        with self.xml.nest_in("transition", attributes):
            assign(self.xml, "visit", "0")
            if outcome is not None:
                assign(self.xml, "ends", str(outcome_code(outcome)))

    def _onward_transition(self, transition: StateTransition, cond: str) -> None:
        if transition.completes is not None:
            n = self.ids.groups[transition.completes]
            with self.xml.nest_in("transition", {"cond": cond}):
                assign(self.xml, "completed", str(n))
            return
        with self.xml.nest_in(
            "transition", {"cond": cond, "target": self._target(transition.target)}
        ):
            self._assign([("completed", "0"), ("awaits", "0"), ("due_round", "0")])

    def _guard(self, condition: Condition) -> str:
        k = self.ids.objects[condition.object_id]
        less = "<=" if condition.inclusive else "<"
        low = number_text(condition.param1 or 0.0)
        value = f"value_{k}"
        age = f"now - time_{k}"
        known = f"known_{k} == {_VALUE}"
        fresh = []
        if condition.max_age is not None:
            fresh = [f"{age} <= {number_text(condition.max_age)}"]
        match condition.type:
            case ConditionType.LESS:
                tests = [known, *fresh, f"{value} {less} {low}"]
            case ConditionType.GREATER:
                tests = [known, *fresh, f"{low} {less} {value}"]
            case ConditionType.WITHIN:
                upper = number_text(condition.param2 or 0.0)
                tests = [known, *fresh, f"{low} {less} {value}", f"{value} {less} {upper}"]
            case ConditionType.UNREADABLE:
                tests = [f"known_{k} == {_UNREADABLE}"]
            case ConditionType.UNREACHABLE:
                tests = [f"known_{k} == {_UNREACHABLE}"]
            case ConditionType.FAILED:
                tests = [f"known_{k} >= {_UNREADABLE}"]
            case ConditionType.STALE:
                tests = [known, f"{age} > {number_text(condition.max_age or 0.0)}"]
            case ConditionType.ABNORMAL:
                tests = [known, f"abnormal_{k} == 1", *fresh]
        return " && ".join(tests)

    # Actions

    def _actuator_region(self) -> None:
        xml = self.xml
        with xml.nest_in("state", {"id": "actuator", "initial": "free"}):
            for k in sorted(self.ids.objects.values()):
                with xml.nest_in("transition", {"event": f"reading.{k}"}):
                    self._store_reading(k)
            with xml.nest_in("state", {"id": "free"}):
                going = "mode == 0 && visit > 0 && awaits == 0"
                with xml.nest_in("transition", {"cond": going, "target": "busy"}):
                    self._start_action("visit", "place", "object")
                    with xml.nest_in("if", {"cond": "limit > 0 && earliest <= now"}):
                        assign(xml, "due_action", "now + limit")
                    with xml.nest_in("if", {"cond": "limit > 0 && earliest > now"}):
                        assign(xml, "due_action", "earliest + limit")
                    if self.timers and "action" in self.ids.deadlines:
                        write_timer_start(xml, "action")
                with xml.nest_in("transition", {"cond": "mode == 1", "target": "busy"}):
                    self._start_action("drive", "drive_place", "0")
            for id in ("busy", "stopping"):
                with xml.nest_in("state", {"id": id}):
                    if id == "busy":
                        xml.add("transition", {"cond": _NOT_WANTED, "target": "stopping"})
                    for k in sorted(self.ids.objects.values()):
                        cond = f"running_object == {k}"
                        attributes = {"event": "action.succeeded", "cond": cond, "target": "free"}
                        with xml.nest_in("transition", attributes):
                            self._store_reading(k)
                            self._end_action()
                    with xml.nest_in("transition", {"event": "action", "target": "free"}):
                        self._end_action()

    def _start_action(self, number: str, place: str, measured: str) -> None:
        self._assign(
            [
                ("running", number),
                ("running_place", place),
                ("running_object", measured),
                ("starts", "starts + 1"),
            ]
        )

    def _end_action(self) -> None:
        self._assign([("running", "0"), ("due_action", "0")])
        if self.timers and "action" in self.ids.deadlines:
            write_timer_cancel(self.xml, "action")

    def _store_reading(self, k: int) -> None:
        """Write the assignments that store checkpoint `k`'s reading from an event's data."""
        self._assign([(f"known_{k}", str(_UNREADABLE)), (f"time_{k}", "_event.data.time")])
        self._assign([(f"abnormal_{k}", "0"), ("look", "1")])
        with self.xml.nest_in("if", {"cond": "_event.data.value != null"}):
            self._assign([(f"known_{k}", str(_VALUE)), (f"value_{k}", "_event.data.value")])
            with self.xml.nest_in("if", {"cond": "_event.data.abnormal == 1"}):
                assign(self.xml, f"abnormal_{k}", "1")

    def _assign(self, assignments: Sequence[tuple[str, str]]) -> None:
        for location, expr in assignments:
            assign(self.xml, location, expr)

    def _state(self, id: str) -> str:
        if id in self.leaves:
            return self.ids.leaves[id]
        return f"g{self.ids.groups[id]}"

    def _target(self, id: str | None) -> str:
        assert id is not None
        return "ended" if id == DONE else self._state(id)


_NOT_WANTED = "(mode != 0 || running != visit) && (mode != 1 || running != drive)"

_VISIT_DEADLINES = tuple(kind for kind in DEADLINES if kind != "hold")
"""Deadlines of a visit; `hold` belongs to a reaction."""


def _repeat(group: Composite) -> RepeatRule:
    assert group.repeat is not None
    return group.repeat


def _hard_deadline(task: Task) -> float | None:
    """Return the end of the task's hard window in s since the mission's start, or None."""
    window = task.window
    return window.latest if window is not None and window.hard else None


def _clock(repeat: RepeatRule) -> str:
    """Return the variable with a group's clock: `now`, or `clock`, which stops in interruptions."""
    return "now" if repeat.count_interruptions else "clock"
