"""Puts the clauses of a step together: which condition, speed or limit belongs to which command.

A step's clauses come as a flat list. A command opens a draft, and what follows is added to it:
manner and limits to the last command, routes to the last one outside a route's own commands.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from argo_compiler.diagnostics import Span
from argo_compiler.il import Afterwards, EventKind, OnFailure, Response
from argo_compiler.script.syntax.clauses import Clause, Count, Detail, LineBuilder, ValueTest
from argo_compiler.script.syntax.commands import (
    Add,
    Amend,
    Branch,
    Command,
    Comparison,
    Delete,
    Done,
    Go,
    Limits,
    Manner,
    Measure,
    Meet,
    Move,
    Patrol,
    Plain,
    React,
    Repeat,
    Replace,
    SetStart,
    Side,
)
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.terms import (
    Coordinates,
    DockLocation,
    FloorName,
    Number,
    Reference,
    StepRef,
)

JOINTS = frozenset(["comma", "semicolon", "full stop", "and", "or", "then", "afterwards"])
_BREAKS = frozenset(["semicolon", "full stop"])
_LISTS = frozenset(["comma", "and", "or"])
_NO_DETAIL = Detail()


@dataclass(slots=True)
class _Draft:
    """A command while its clauses are gathered."""

    kind: str
    start: int
    end: int
    name: str | None = None
    things: list[Any] = field(default_factory=list)
    """checkpoints, places, steps: what the command is about"""
    anchor: Any = None
    side: Side = Side.AFTER
    manner: Manner | None = None
    limits: Limits | None = None
    routes: list["_Path"] = field(default_factory=list)
    here: bool = False
    # of a reaction
    events: list[EventKind] = field(default_factory=list)
    response: Response | None = None
    until: EventKind | None = None
    afterwards: Afterwards = Afterwards.END
    priority: int | None = None
    reported: bool = False


@dataclass(slots=True)
class _Path:
    """A route while its clauses are gathered."""

    start: int
    end: int
    alternatives: list[list[Comparison]] | None
    """None: unconditional"""
    target: Plain | StepRef | DockLocation | None = None
    otherwise: bool = False
    drafts: list[_Draft] = field(default_factory=list)


class SentenceBuilder:
    """Puts the clauses of one step together; what does not fit is an error."""

    def __init__(self, text: ScriptText, diagnostics: Diagnostics) -> None:
        self.text = text
        self.diagnostics = diagnostics
        self.drafts: list[_Draft] = []
        self.last: _Draft | None = None
        """the command that manner and limits belong to"""
        self.owner: _Draft | None = None
        """the command that routes belong to"""
        self.path: _Path | None = None
        """the route whose conditions or target are awaited"""
        self.mode = "plain"
        self.joints: set[str] = set()
        """what stood since the clause before"""
        self.name: Clause | None = None
        self.subject: Reference | None = None
        self.detail = _NO_DETAIL
        self.age: float | None = None
        self.compared = False
        """whether the present subject has been compared"""
        self.wanted: Clause | None = None
        """a clause that something must follow"""

    def commands(self, clauses: Sequence[Clause]) -> tuple[Command, ...]:
        """The commands that the clauses amount to."""
        errors = self.diagnostics.errors
        for i, clause in enumerate(clauses):
            if clause.kind in JOINTS:
                self.joints.add(clause.kind)
                continue
            if self.mode == "plain" and clause.kind in _OPENERS:
                self._command_clause(clause)
            else:
                if self.mode in ("then", "failure", "detour") and self.joints & _BREAKS:
                    self._close_path()
                self._take(clause, clauses, i)
            self.joints.clear()
            if self.diagnostics.errors > errors:
                return ()
        if self.mode != "plain" or self.path is not None or self.wanted is not None:
            self._close_path()
        if self.name is not None:
            self._misfit(self.name, "a name stands before a command")
        commands = tuple([self._command(draft) for draft in self.drafts])
        return commands if self.diagnostics.errors == errors else ()

    # ---- the course of a sentence

    def _take(self, clause: Clause, clauses: Sequence[Clause], i: int) -> None:
        kind = clause.kind
        if kind in ("if", "occasion"):
            self._begin_if(clause, clauses, i)
        elif kind == "otherwise":
            self._close_path()
            self.path = _Path(clause.start, clause.end, None, otherwise=True)
            self.mode = "then"
            self.wanted = clause
        elif kind == "unless":
            hint = "turn it round: `if ..., go on; otherwise ...`"
            self._misfit(clause, "a mission has no condition such as `unless`", "condition", hint)
        elif kind == "adverb":
            word = self._said(clause)
            hint = "write a number, such as `at 0.3 m/s`"
            self._misfit(clause, f"how fast is `{word}`?", "speed", hint)
        elif kind == "nothing":
            self._extend(clause)
        elif (
            (self.mode == "if" and self._condition(clause))
            or (self.mode == "react" and self._reaction(clause))
            or (self.mode == "failure" and self._policy(clause))
        ):
            return
        elif not (self._manner(clause) or self._limit(clause) or self._target(clause)):
            self._command_clause(clause)

    def _begin_if(self, clause: Clause, clauses: Sequence[Clause], i: int) -> None:
        following = clauses[i + 1] if i + 1 < len(clauses) else None
        kind = following.kind if following else None
        self._close_path()
        if clause.kind == "occasion" or kind == "event":
            self._open("react", clause, None)
            if clause.kind == "occasion":
                self.drafts[-1].events.append(clause.value)
            self.mode = "react"
        elif kind == "fails":
            self.mode = "failure"
        else:
            self.path = _Path(clause.start, clause.end, [[]])
            self.mode = "if"
            self.subject, self.detail, self.age = None, _NO_DETAIL, None
        self.wanted = clause

    def _close_path(self) -> None:
        """Ends a route, a failure policy or a reaction, of which nothing may be missing."""
        wanted, self.wanted = self.wanted, None
        path, self.path = self.path, None
        draft = self.drafts[-1] if self.mode == "react" and self.drafts else None
        self.mode = "plain"
        if draft is not None and draft.response is None:
            if draft.reported:
                draft.response = Response.REPORT
            elif draft.until is not None:
                draft.response = Response.PAUSE
            else:
                self._missing(draft.start, draft.end, "what to do", "`report it` or `pause`")
        elif wanted is not None and (path is None or not (path.drafts or path.target)):
            hint = "`go to step 5` or `return to the docking station`"
            self._missing(wanted.start, wanted.end, "where to go on", hint)

    def _missing(self, start: int, end: int, what: str, example: str) -> None:
        message = f"this does not say {what}"
        span = self.text.span(start, end)
        self.diagnostics.error("unfinished", message, span, f"add, say, {example}")

    # ---- conditions

    def _condition(self, clause: Clause) -> bool:
        assert self.path is not None
        alternatives = self.path.alternatives
        if "or" in self.joints and alternatives and alternatives[-1] and clause.kind in _TESTS:
            alternatives.append([])
        match clause.kind:
            case "subject":
                self.subject, self.detail, self.age = clause.value, _NO_DETAIL, None
                self.compared = False
            case "bracket":
                if self.subject is None:
                    return False
                self.subject = _both(self.subject, clause.value)
            case "it":
                self.subject, self.detail, self.age = None, _NO_DETAIL, None
                self.compared = False
            case "detail":
                self.detail = clause.value
            case "age":
                self._age(clause.value)
            case "comparison":
                self._compare(clause)
            case _:
                if not any(self.path.alternatives or ()):
                    return False
                self.mode = "then"
                if not self._target(clause):
                    self._command_clause(clause)
                return True
        self.path.end = clause.end
        return True

    def _age(self, seconds: float) -> None:
        assert self.path is not None
        assert self.path.alternatives is not None
        last = self.path.alternatives[-1]
        if not self.compared or not last:
            self.age = seconds
        else:
            last[-1] = _aged(last[-1], seconds)

    def _compare(self, clause: Clause) -> None:
        assert self.path is not None
        assert self.path.alternatives is not None
        bounds: ValueTest = clause.value
        alternatives = self.path.alternatives
        if self.detail.second_bound is not None and bounds.param2 is not None:
            self._misfit(clause, "this comparison has a second bound of its own")
        param2 = bounds.param2 if bounds.param2 is not None else self.detail.second_bound
        self.compared = True
        alternatives[-1].append(
            Comparison(
                span=self.text.span(clause.start, clause.end),
                subject=self.subject,
                test=bounds.test,
                param1=bounds.param1,
                param2=param2,
                inclusive=bounds.inclusive,
                units=bounds.units,
                max_age=self.age,
                id=self.detail.id or "",
            )
        )

    # ---- where a route leads

    def _target(self, clause: Clause) -> bool:
        target: Plain | StepRef | DockLocation
        match clause.kind:
            case "jump":
                target = clause.value
            case "go on":
                target = Plain.GO_ON
            case "end" | "abort":
                target = Plain.END
            case "home":
                target = DockLocation(span=self.text.span(clause.start, clause.end))
            case "go" if (
                self.mode == "then"
                and isinstance(clause.value, DockLocation)
                and self.path is not None
                and not self.path.drafts
            ):
                target = clause.value
            case _:
                return False
        if isinstance(target, StepRef) and target.last is not None:
            self._misfit(clause, "a mission goes on with one step", "step-range", "name one step")
            return True
        path = self.path
        if self.mode == "then" and path is not None and not path.drafts:
            path.target = target
            path.end = clause.end
            self._own(path)
            self.path, self.wanted, self.mode = None, None, "plain"
        elif self.mode == "then" and path is not None:
            path.drafts[-1].routes.append(_Path(clause.start, clause.end, None, target))
            self.path, self.wanted, self.mode = None, None, "plain"
        else:
            self._own(_Path(clause.start, clause.end, None, target))
        return True

    def _own(self, path: _Path) -> None:
        """Adds the route to the command that it belongs to."""
        if self.owner is None:
            self.owner = _Draft("amend", path.start, path.end)
            self.drafts.append(self.owner)
            self.last = self.owner
        self.owner.routes.append(path)

    # ---- failures

    def _policy(self, clause: Clause) -> bool:
        match clause.kind:
            case "fails":
                return True
            case "retry":
                self._manners().retries = clause.value
                return True
            case "go on":
                policy = OnFailure.CONTINUE
            case "abort" | "end":
                policy = OnFailure.ABORT
            case "home":
                policy = OnFailure.RETURN
            case "go" if isinstance(clause.value, DockLocation):
                policy = OnFailure.RETURN
                self._manners().failure_dock = clause.value
            case _:
                if self.wanted is None:
                    self.mode = "plain"
                    return False
                hint = "write `continue`, `return to the docking station` or `abort the mission`"
                message = "a mission has no such way to go on after a failure"
                self._misfit(clause, message, "failure", hint)
                return True
        self._manners().on_failure = policy
        self.mode, self.wanted = "plain", None
        return True

    # ---- reactions

    def _reaction(self, clause: Clause) -> bool:
        draft = self.drafts[-1]
        drives = draft.response is not None and draft.response.drives
        match clause.kind:
            case "event":
                self._event(clause, draft)
            case "report":
                draft.reported = True
            case "home":
                self._respond(clause, draft, Response.RETURN)
            case "go":
                dock = isinstance(clause.value, DockLocation)
                self._respond(clause, draft, Response.RETURN if dock else Response.SAFE_AREA)
                draft.things = [clause.value]
            case "pause":
                if draft.response is None:
                    draft.response = Response.PAUSE
            case "abort":
                self._respond(clause, draft, Response.ABORT)
            case "end" if drives or "afterwards" in self.joints:
                draft.afterwards = Afterwards.END
            case "end":
                self._respond(clause, draft, Response.ABORT)
            case "wait" if drives or "afterwards" in self.joints:
                draft.afterwards = Afterwards.WAIT
            case "wait":
                draft.response = draft.response or Response.PAUSE
            case "until":
                draft.until = clause.value
            case "wait until":
                draft.until = clause.value
                draft.response = draft.response or Response.PAUSE
            case "recharge":
                draft.until = EventKind.BATTERY_CHARGED
                draft.response = draft.response or Response.PAUSE
            case "resume" | "go on":
                draft.afterwards = Afterwards.RESUME
            case "priority":
                draft.priority = clause.value
            case "at":
                draft.things = [clause.value]
            case "height" | "heading" | "on floor" | "floor":
                self._place_further(clause, draft)
            case _:
                hint = (
                    "write `report it`, `pause`, `return to the docking station`, "
                    "`go to (x, y, z)` or `abort the mission`"
                )
                message = "a mission has no such response to an event"
                self._misfit(clause, message, "reaction", hint)
        draft.end = clause.end
        self.wanted = None
        return True

    def _event(self, clause: Clause, draft: _Draft) -> None:
        """One more event with the same reaction."""
        if draft.events and (draft.response or draft.reported or draft.until):
            hint = "write a sentence of its own for it, or name it before the response"
            self._misfit(clause, "this event stands behind the response", "reaction", hint)
        elif draft.events and "or" not in self.joints and self.joints != {"comma"}:
            hint = "join them by `or`: `if a gas leak or a hot spot is detected, ...`"
            self._misfit(clause, "a reaction is one to each single event", "reaction", hint)
        elif clause.value not in draft.events:
            draft.events.append(clause.value)

    def _respond(self, clause: Clause, draft: _Draft, response: Response) -> None:
        if draft.response is not None and draft.response is not Response.PAUSE:
            message = "this reaction already has a response"
            self._misfit(clause, message, "reaction", "leave one of the two out")
        draft.response = response

    # ---- manner and limits

    def _manners(self) -> Manner:
        """The manner of the last command; of the step before if this one has none yet."""
        draft = self.last
        if draft is None:
            draft = self.last = self.owner = _Draft("amend", 0, 0)
            self.drafts.append(draft)
        if draft.manner is None:
            draft.manner = Manner()
        return draft.manner

    def _manner(self, clause: Clause) -> bool:
        match clause.kind:
            case "speed":
                self._manners().speed = clause.value
            case "leaving":
                self._manners().leaving = clause.value
            case "standing":
                self._manners().pose = clause.value
            case "shown":
                self._manners().shown_in = clause.value
            case "about":
                self._manners().object_id = clause.value
            case "joints":
                self._manners().joints = clause.value
            case "retry":
                self._manners().retries = clause.value
                self.mode = "failure" if self.mode == "plain" else self.mode
            case "height" | "heading" | "on floor" if self.last is not None:
                manner = self.last.manner
                if manner is not None and manner.pose is not None:
                    manner.pose = LineBuilder.placed(manner.pose, clause)
                else:
                    self._place_further(clause, self.last)
            case "floor" if self.last is not None and _point(self.last) is not None:
                self._place_further(clause, self.last)
            case _:
                return False
        self._extend(clause)
        return True

    def _place_further(self, clause: Clause, draft: _Draft) -> None:
        point = _point(draft)
        if point is None:
            hint = "it stands behind coordinates: `go to (12.5, 3, 2.5) heading 90 degrees`"
            self._misfit(clause, "this belongs to no coordinates", "stray-clause", hint)
        else:
            draft.things[-1] = LineBuilder.placed(point, clause)

    def _limit(self, clause: Clause) -> bool:
        if clause.kind not in _LIMITS:
            return False
        draft = self.last
        if draft is None or draft.limits is None:
            hint = "patrols and repetitions have limits: `repeat steps 2 to 4 three times`"
            self._misfit(clause, "this is no limit of the command before", "stray-clause", hint)
            return True
        limits = draft.limits
        match clause.kind:
            case "rounds":
                self._rounds(clause, clause.value, limits)
            case "for":
                seconds, count = clause.value
                if limits.duration:
                    self._misfit(clause, "a second duration", "repeated-limit", "leave one out")
                limits.duration = seconds
                if count is not None:
                    self._rounds(clause, count, limits)
            case "soft":
                limits.soft = True
            case "hard":
                limits.soft = False
            case "endless":
                limits.endless = True
            case "included" | "excluded":
                limits.count_interruptions = clause.kind == "included"
        self._extend(clause)
        return True

    def _rounds(self, clause: Clause, count: Count, limits: Limits) -> None:
        if limits.count:
            self._misfit(clause, "a second number of rounds", "repeated-limit", "leave one out")
        # The steps that are repeated have been carried out once when they are.
        limits.count = count.rounds + count.more

    def _extend(self, clause: Clause) -> None:
        if self.last is not None:
            self.last.end = max(self.last.end, clause.end)

    # ---- commands

    def _command_clause(self, clause: Clause) -> None:
        match clause.kind:
            case "name":
                if self.name is not None:
                    self._misfit(clause, "a second name", "stray-clause", "leave one out")
                self.name = clause
            case "measure" | "add":
                self._open(clause.kind, clause, self._checkpoint(clause.value))
            case "delete" | "move" | "replace":
                self._open(clause.kind, clause, clause.value.value)
            case "go" | "patrol":
                self._open(clause.kind, clause, clause.value)
            case "set start":
                self._open("start", clause, clause.value)
            case "start here":
                self._open("start", clause, clause.value)
                self.drafts[-1].here = True
            case "meet":
                self._open("meet", clause, None)
            case "repeat":
                self._open("repeat", clause, clause.value)
            case "done":
                self._open("done", clause, None)
            case "side" | "by":
                self._anchor(clause)
            case _:
                self._further(clause)

    def _checkpoint(self, clause: Clause) -> Reference:
        if clause.kind not in ("subject", "bracket"):
            hint = "name a checkpoint: `check checkpoint #14`"
            self._misfit(clause, "this does not say which checkpoint", "which-checkpoint", hint)
            return Reference(span=self.text.span(clause.start, clause.end))
        reference: Reference = clause.value
        return reference

    def _open(self, kind: str, clause: Clause, thing: Any) -> None:
        draft = _Draft(kind, clause.start, clause.end)
        if thing is not None:
            draft.things.append(thing)
        if kind in ("patrol", "repeat"):
            draft.limits = Limits()
        if self.name is not None and kind in _NAMED:
            draft.name = self.name.value
            self.name = None
        if self.mode == "then" and self.path is not None and kind in _TASKS:
            path = self.path
            if not path.drafts:
                self._own(path)
            path.drafts.append(draft)
            path.end = clause.end
            self.wanted = None
        else:
            if self.mode == "then" or (self.mode == "if" and self.path is not None):
                message = "this can't follow a condition"
                hint = "after a condition the mission can go to a step, drive or measure"
                self._misfit(clause, message, "route", hint)
            self.drafts.append(draft)
            if kind in _NAMED:
                self.owner = draft
        self.last = draft

    def _anchor(self, clause: Clause) -> None:
        draft = self.last
        wanted = ("add", "move") if clause.kind == "side" else ("replace",)
        if draft is None or draft.kind not in wanted or draft.anchor is not None:
            hint = "write, say, `move checkpoint #4 before checkpoint #1`"
            self._misfit(clause, "this belongs to no change of the plan", "stray-clause", hint)
            return
        if clause.kind == "side":
            draft.side, anchor = clause.value
        else:
            anchor = clause.value
        draft.anchor = anchor.value if anchor.kind == "step" else self._checkpoint(anchor)
        draft.end = clause.end

    def _further(self, clause: Clause) -> None:
        """One more checkpoint, floor or place for the last command."""
        draft = self.last
        kind = draft.kind if draft else None
        if draft is not None and clause.kind == "bracket" and kind in ("measure", "add"):
            draft.things[-1] = _both(draft.things[-1], clause.value)
        elif draft is None or not (self.joints & _LISTS) or self.joints & _BREAKS:
            self._stray(clause)
        elif (clause.kind == "subject" and kind in ("measure", "add", "delete", "move")) or (
            clause.kind == "step" and kind in ("delete", "move")
        ):
            draft.things.append(clause.value)
        elif clause.kind == "bare" and kind in ("measure", "add", "delete", "move"):
            number: Number = clause.value
            draft.things.append(Reference(span=number.span, number=number.value))
        elif clause.kind in ("bare", "floor") and kind == "patrol":
            value = clause.value
            if isinstance(value, Number):
                value = FloorName(span=value.span, number=value.value)
            draft.things.append(value)
        elif clause.kind == "place" and kind == "patrol":
            draft.things.append(clause.value)
        else:
            self._stray(clause)
        self._extend(clause)

    def _stray(self, clause: Clause) -> None:
        hint = "write one sentence for each command, such as `Check the checkpoint #14.`"
        self._misfit(clause, f"can't tell what `{self._said(clause)}` belongs to", hint=hint)

    def _said(self, clause: Clause) -> str:
        return self.text.content[clause.start : clause.end]

    def _misfit(
        self, clause: Clause, message: str, code: str = "stray-clause", hint: str | None = None
    ) -> None:
        span = self.text.span(clause.start, clause.end)
        self.diagnostics.error(code, message, span, hint)

    # ---- the commands themselves

    def _command(self, draft: _Draft) -> Command:
        span = self.text.span(draft.start, draft.end)
        things = tuple(draft.things)
        planned: dict[str, Any] = {}
        if draft.kind in _TASKS:
            planned = {"name": draft.name, "manner": draft.manner}
            planned["routes"] = tuple([self._route(path) for path in draft.routes])
        match draft.kind:
            case "start":
                location = things[0] if things else None
                return SetStart(span=span, location=location, here=draft.here, **planned)
            case "patrol":
                return Patrol(span=span, places=things, limits=draft.limits or Limits(), **planned)
            case "measure":
                return Measure(span=span, checkpoints=things, **planned)
            case "add" if draft.anchor is None:
                return Measure(span=span, checkpoints=things, **planned)
            case "add":
                return Add(
                    span=span, checkpoints=things, anchor=draft.anchor, side=draft.side, **planned
                )
            case "go":
                return Go(span=span, location=things[0], **planned)
            case "delete":
                return Delete(span=span, things=things)
            case "move":
                if draft.anchor is None:
                    self._missing(draft.start, draft.end, "where to", "`before checkpoint #1`")
                return Move(span=span, things=things, anchor=draft.anchor, side=draft.side)
            case "replace":
                if draft.anchor is None:
                    self._missing(draft.start, draft.end, "by what", "`by checkpoint #2`")
                return Replace(span=span, thing=things[0], by=draft.anchor)
            case "repeat":
                return self._repeat(draft, span)
            case "meet":
                return Meet(span=span, **planned)
            case "react":
                return self._react(draft, span)
            case "done":
                return Done(span=span)
        return Amend(span=span, **planned)

    def _repeat(self, draft: _Draft, span: Span) -> Repeat:
        if draft.manner is not None:
            hint = "say it of the steps that are repeated"
            message = "a repetition has no way of its own to be carried out"
            self.diagnostics.error("stray-clause", message, span, hint)
        return Repeat(
            span=span,
            name=draft.name,
            steps=draft.things[0] if draft.things else None,
            limits=draft.limits or Limits(),
            routes=tuple([self._route(path) for path in draft.routes]),
        )

    def _react(self, draft: _Draft, span: Span) -> React:
        return React(
            span=span,
            events=tuple(draft.events),
            response=draft.response or Response.REPORT,
            location=draft.things[0] if draft.things else None,
            until=draft.until,
            afterwards=draft.afterwards,
            priority=draft.priority,
        )

    def _route(self, path: _Path) -> Branch:
        alternatives = [tuple(tests) for tests in path.alternatives or () if tests]
        target: Any = path.target
        if path.drafts:
            target = tuple(self._command(draft) for draft in path.drafts)
        return Branch(
            span=self.text.span(path.start, path.end),
            alternatives=tuple(alternatives),
            target=target,
            otherwise=path.otherwise,
        )


_TASKS = frozenset(["start", "patrol", "measure", "meet", "add", "go", "amend"])
_NAMED = _TASKS | {"repeat"}
_OPENERS = frozenset(
    ["name", "measure", "go", "meet", "patrol", "repeat", "set start", "add", "done"]
)
_LIMITS = frozenset(["rounds", "for", "soft", "hard", "endless", "included", "excluded"])
_TESTS = frozenset(["subject", "it", "comparison"])


def _both(a: Reference, b: Reference | None) -> Reference:
    """A checkpoint that is named by its number and by its name; None: `read the value` alone."""
    if b is None:
        return a
    return Reference(
        span=a.span,
        number=a.number if a.number is not None else b.number,
        name=a.name or b.name,
        quantity=a.quantity or b.quantity,
        last=a.last,
    )


def _aged(test: Comparison, seconds: float) -> Comparison:
    return Comparison(
        span=test.span,
        subject=test.subject,
        test=test.test,
        param1=test.param1,
        param2=test.param2,
        inclusive=test.inclusive,
        units=test.units,
        max_age=seconds,
        id=test.id,
    )


def _point(draft: _Draft) -> Coordinates | None:
    last = draft.things[-1] if draft.things else None
    return last if isinstance(last, Coordinates) else None
