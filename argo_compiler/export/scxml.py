"""SCXML: the whole machine as a W3C state chart, for any engine with the ECMAScript data model.

Three regions run in parallel. `plan` holds the mission, its groups and tasks; `control` says
whether the mission goes on, is paused, or a reaction has the robot; `actuator` starts and cancels
actions, one at a time. The expressions are plain enough to be Python as well. `docs/export.md` has
the events that come in and the data that a driver looks at.
"""

from argo_compiler.export.scxml_control import (
    ABORTED,
    FAILED,
    RETURNED,
    ControlRegion,
    outcome_states,
)
from argo_compiler.export.scxml_data import (
    ARGO,
    ActionIds,
    assign,
    data_model,
    send_time_out,
    task_attributes,
)
from argo_compiler.export.xml import XmlWriter, number
from argo_compiler.hfsm import Composite, Hfsm, Leaf, StateTransition, TransitionKind
from argo_compiler.hfsm.model import DONE, RETURN
from argo_compiler.il import Action, Condition, ConditionType, Mission, Task

NAMESPACE = "http://www.w3.org/2005/07/scxml"


def to_scxml(mission: Mission, hfsm: Hfsm, timers: bool = False) -> str:
    """The machine as an SCXML document.

    With `timers`, the engine's own clock sends the time-outs (`<send delay>`). Without, they come
    from outside like all other events, so that any clock can drive the machine.
    """
    start = next((t for t in mission.tasks if t.action is Action.START), None)
    return _Document(hfsm, start, timers).text()


class _Document:
    def __init__(self, hfsm: Hfsm, start: Task | None, timers: bool) -> None:
        self.hfsm = hfsm
        self.start = start
        self.timers = timers
        self.ids = ActionIds(hfsm)
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
        with xml.element("scxml", root):
            data_model(xml, self.hfsm, self.ids)
            with xml.element("parallel", {"id": "run"}):
                if self.timers and self.hfsm.max_duration is not None:
                    limit = number(self.hfsm.max_duration)
                    with xml.element("onentry"):
                        time_up = {"event": "event.time_up", "delay": f"{limit}s"}
                        with xml.element("send", time_up):
                            xml.add("param", {"name": "time", "expr": limit})
                self._plan()
                ControlRegion(xml, self.hfsm, self.ids, self.timers).write()
                self._actuator()
            outcome_states(xml)
        return xml.text()

    def _plan(self) -> None:
        """The mission's states. Not recursive, as groups may be nested to any depth."""
        xml = self.xml
        xml.open("state", {"id": "plan", "initial": "start", "argo:name": self.hfsm.mission.name})
        where = {} if self.start is None else task_attributes(self.start)
        with xml.element("state", {"id": "start", **where}):
            self._transition({"target": self._target(self.hfsm.mission.initial)})
        # None closes a group.
        pending: list[str | None] = [None, *reversed(self.hfsm.mission.children)]
        while pending:
            id = pending.pop()
            if id is None:
                xml.close()
            elif id == DONE:
                with xml.element("state", {"id": "ended"}), xml.element("onentry"):
                    assign(xml, "done", "1")
            elif leaf := self.leaves.get(id):
                self._leaf(leaf)
            else:
                group = self.composites[id]
                self._open_group(group)
                pending += [None, *reversed(group.children)]

    def _open_group(self, group: Composite) -> None:
        xml, n = self.xml, self.ids.groups[group.id]
        repeat = group.repeat
        assert repeat is not None
        clock = "now" if repeat.count_interruptions else "clock"
        xml.open(
            "state",
            {
                "id": f"g{n}",
                "initial": self._state(group.children[0]),
                "argo:name": group.name,
                "argo:clock": clock,
            },
        )
        with xml.element("onentry"):
            assign(xml, f"round_{n}", "1")
            if repeat.duration:
                assign(xml, f"until_{n}", f"{clock} + {number(repeat.duration)}")
            if self.timers and group.timeout:
                with xml.element("if", {"cond": "mode == 0"}):
                    send_time_out(xml, n, repeat.count_interruptions)
        if group.timeout:
            with xml.element("transition", {"event": f"timeout.g{n}"}):
                assign(xml, "now", "_event.data.time")
                assign(xml, "visit", "0")
                assign(xml, "completed", str(n))
        for transition in group.transitions:
            self._group_transition(group, transition)
        if self.timers and group.timeout:
            with xml.element("onexit"):
                xml.add("cancel", {"sendid": f"timer_{n}"})

    def _group_transition(self, group: Composite, transition: StateTransition) -> None:
        n = self.ids.groups[group.id]
        repeat = group.repeat
        assert repeat is not None
        cond = f"completed == {n}"
        if transition.kind is TransitionKind.REPEAT:
            clock = "now" if repeat.count_interruptions else "clock"
            if repeat.count:
                cond += f" && round_{n} < {repeat.count}"
            if repeat.duration:
                cond += f" && {clock} < until_{n}"
            attributes = {
                "cond": cond,
                "target": self._target(transition.target),
                "type": "internal",
            }
            with self.xml.element("transition", attributes):
                assign(self.xml, "completed", "0")
                assign(self.xml, f"round_{n}", f"round_{n} + 1")
        else:
            self._onward(transition, cond)

    def _leaf(self, leaf: Leaf) -> None:
        """A task: `..._act` while its action is wanted, then `..._end` to decide how to go on.

        Guards are evaluated before a transition's assignments, so a value has to be stored in one
        transition for the next one to see it.
        """
        xml, id = self.xml, self._state(leaf.id)
        with xml.element("state", {"id": id, "initial": f"{id}_act", **task_attributes(leaf.task)}):
            with xml.element("onentry"):
                assign(xml, "fails", "0")
                assign(xml, "count", "count + 1")
                assign(xml, "visit", "count")
                assign(xml, "visits", "visits + 1")
                assign(xml, "place", f"'{id}'")
                assign(xml, "object", str(self.ids.object_of(leaf.task)))
            with xml.element("state", {"id": f"{id}_act"}):
                self._act(leaf, f"{id}_end")
            with xml.element("state", {"id": f"{id}_end"}):
                for transition in leaf.transitions:
                    self._onward(
                        transition,
                        " && ".join(
                            ["completed == 0", *(self._holds(c) for c in transition.conditions)]
                        ),
                    )

    def _act(self, leaf: Leaf, end: str) -> None:
        xml = self.xml
        served = "running == visit"
        # The failure of an action that is being cancelled may be the work of the cancellation.
        failed = f"{served} && In('busy')"
        if leaf.task.retries:
            again = f"{failed} && fails < {leaf.task.retries}"
            with xml.element("transition", {"event": "action.failed", "cond": again}):
                assign(xml, "fails", "fails + 1")
        outcome, target = None, end
        if leaf.id == RETURN:
            outcome, target = FAILED, "ended"
        elif leaf.failure:
            outcome = ABORTED if leaf.failure.target == DONE else None
            target = self._target(leaf.failure.target)
        self._leave("action.failed", failed, target, outcome)
        if leaf.id == RETURN:
            self._leave("action.succeeded", served, "ended", RETURNED)
        else:
            self._leave("action.succeeded", served, end, None)

    def _leave(self, event: str, cond: str, target: str, outcome: int | None) -> None:
        attributes = {"event": event, "cond": cond, "target": target}
        with self.xml.element("transition", attributes):
            assign(self.xml, "visit", "0")
            if outcome is not None:
                assign(self.xml, "outcome", str(outcome))

    def _onward(self, transition: StateTransition, cond: str) -> None:
        if transition.completes is not None:
            n = self.ids.groups[transition.completes]
            with self.xml.element("transition", {"cond": cond}):
                assign(self.xml, "completed", str(n))
            return
        with self.xml.element(
            "transition", {"cond": cond, "target": self._target(transition.target)}
        ):
            assign(self.xml, "completed", "0")

    def _transition(self, attributes: dict[str, str | int | float | None]) -> None:
        self.xml.add("transition", attributes)

    def _holds(self, condition: Condition) -> str:
        k = self.ids.objects[condition.object_id]
        less = "<=" if condition.inclusive else "<"
        low = number(condition.param1 or 0.0)
        value = f"value_{k}"
        tests = [f"known_{k} == 1"]
        if condition.max_age is not None:
            tests.append(f"now - time_{k} <= {number(condition.max_age)}")
        match condition.type:
            case ConditionType.LESS:
                tests.append(f"{value} {less} {low}")
            case ConditionType.GREATER:
                tests.append(f"{low} {less} {value}")
            case ConditionType.WITHIN:
                upper = number(condition.param2 or 0.0)
                tests += [f"{low} {less} {value}", f"{value} {less} {upper}"]
        return " && ".join(tests)

    def _actuator(self) -> None:
        xml = self.xml
        with xml.element("state", {"id": "actuator", "initial": "free"}):
            with xml.element("state", {"id": "free"}):
                for mode, visit, place in ((0, "visit", "place"), (1, "drive", "drive_place")):
                    cond = f"mode == {mode} && {visit} > 0"
                    with xml.element("transition", {"cond": cond, "target": "busy"}):
                        assign(xml, "running", visit)
                        assign(xml, "running_place", place)
                        assign(xml, "running_object", "object" if mode == 0 else "0")
                        assign(xml, "starts", "starts + 1")
            for id in ("busy", "stopping"):
                with xml.element("state", {"id": id}):
                    if id == "busy":
                        xml.add("transition", {"cond": _NOT_WANTED, "target": "stopping"})
                    for k in sorted(self.ids.objects.values()):
                        cond = f"running_object == {k} && _event.data.value != null"
                        attributes = {"event": "action.succeeded", "cond": cond, "target": "free"}
                        with xml.element("transition", attributes):
                            assign(xml, f"known_{k}", "1")
                            assign(xml, f"value_{k}", "_event.data.value")
                            assign(xml, f"time_{k}", "_event.data.time")
                            assign(xml, "running", "0")
                    with xml.element("transition", {"event": "action", "target": "free"}):
                        assign(xml, "running", "0")

    def _state(self, id: str) -> str:
        if id in self.leaves:
            return self.ids.leaves[id]
        return f"g{self.ids.groups[id]}"

    def _target(self, id: str | None) -> str:
        assert id is not None
        return "ended" if id == DONE else self._state(id)


_NOT_WANTED = "(mode != 0 || running != visit) && (mode != 1 || running != drive)"
