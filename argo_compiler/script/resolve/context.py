"""What all parts of the planning share: the program, and what the script has said so far."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import field, replace
from typing import Any, NoReturn

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action
from argo_compiler.script.documents.source import Diagnostics, RefusedError
from argo_compiler.script.resolve.conditions import ConditionResolver
from argo_compiler.script.resolve.lookup import Lookup
from argo_compiler.script.resolve.nouns import Memory, NounResolver
from argo_compiler.script.resolve.program import (
    Choice,
    Do,
    ProgramBlock,
    ProgramNode,
    Way,
    all_nodes,
    leads_away,
    own_names,
)
from argo_compiler.script.resolve.reacting import Reactions
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.nouns import Kind
from argo_compiler.script.sentences.tree.orders import ScriptOrder
from argo_compiler.script.sentences.tree.places import Steps


@dataclass
class Context:
    """The program while it is made. Mutable: each order changes it."""

    lookup: Lookup
    diagnostics: Diagnostics
    memory: Memory = field(default_factory=Memory)
    program: ProgramBlock = field(default_factory=ProgramBlock)
    steps: dict[int, list[ProgramNode] | None] = field(default_factory=dict)
    """the nodes that each step planned; None for a number that more than one step has"""
    step: list[ProgramNode] = field(default_factory=list)
    """those of the step that is being planned"""
    number: int | None = None
    """that step's, where what is said next ends it"""
    recent: list[Do] = field(default_factory=list)
    """the tasks of the last order"""
    choice: Choice | Way | Do | None = None
    """the condition, or the task whose failure, `otherwise` belongs to"""
    spared: dict[str, Span] = field(default_factory=dict)
    """the checkpoints that are not to be measured, and where that is said"""
    stays: Span | None = None
    """where it is said that the robot stays there, if nothing is said of how long"""
    once: dict[str, Span] = field(default_factory=dict)
    """the checkpoints that are measured because another one is before or after them"""
    before: list[ProgramNode] = field(default_factory=list)
    """the nodes of the step before"""
    measured: dict[str, dict[int, Do]] = field(default_factory=dict)
    """the measurements in the program, by checkpoint"""
    named: dict[str, Do] = field(default_factory=dict)
    docked: Do | None = None
    """the drive into the docking station after which nothing more can come"""
    own_names: dict[str, Do] | None = None
    """the tasks by name, as long as the program is not changed"""
    rounds: int = 0
    """how many rounds have been asked for"""

    def __post_init__(self) -> None:
        self.nouns = NounResolver(self.lookup, self.diagnostics, self.memory)
        self.conditions = ConditionResolver(self.nouns, self.diagnostics)
        self.reactions = Reactions(self.lookup, self.diagnostics)

    def begin_step(self, number: int | None) -> None:
        """What is planned from now on belongs to this step; without a number, to the one before."""
        if number is not None:
            self.before = self.step or self.before
            self.step = []
            self.steps[number] = None if number in self.steps else self.step

    def put(
        self, nodes: Iterable[ProgramNode], block: ProgramBlock, anchor: ProgramNode | None
    ) -> None:
        """Puts nodes into a block, behind the anchor; None: before all."""
        for node in nodes:
            self.own_names = None
            block.insert_after(anchor, node)
            anchor = node
            if isinstance(node, Do):
                self.note(node)

    def note(self, do: Do) -> None:
        """Takes note of a task that is in the program now."""
        if do.action is Action.MEASURE and do.object_id is not None:
            self.measured.setdefault(do.object_id, {})[id(do)] = do
        if do.name is not None:
            self.named[do.name] = do

    def forget(self, do: Do) -> None:
        """Takes note of a task that is no longer in the program."""
        self.own_names = None
        if do.object_id is not None:
            self.measured.get(do.object_id, {}).pop(id(do), None)

    def fail(self) -> None:
        """Something that was ordered is not in the program: what misses it has no error."""
        self.memory.known = False

    @property
    def whole(self) -> bool:
        """Whether all that was asked for so far is planned: what is not found is not there."""
        return self.memory.known

    def refuse_missing(self, code: str, message: str, span: Span, hint: str) -> NoReturn:
        """Refuse what misses something; without a word if that may be what was not understood."""
        if not self.whole:
            raise RefusedError
        self.diagnostics.refuse(code, message, span, hint)

    def measurements(self, checkpoint: CheckpointInfo) -> list[Do]:
        """The tasks in the program that measure a checkpoint."""
        return list(self.measured.get(str(checkpoint.id), {}).values())

    def readings(self, kind: Kind = Kind.CHECKPOINT) -> list[Do]:
        """Return the tasks in the program that measure a checkpoint of a kind."""
        ids = {str(checkpoint.id) for checkpoint in self.lookup.of_kind(kind, ())}
        return [do for id, tasks in self.measured.items() if id in ids for do in tasks.values()]

    def nodes_of(self, steps: Steps) -> list[ProgramNode]:
        """What steps or named tasks stand for. Raises RefusedError if there are none."""
        points = list(steps.points)
        first, last = points[0], points[-1]
        if steps.through and isinstance(first, int) and isinstance(last, int):
            if first > last:
                message = "the first of these steps comes after the last"
                hint = "write the earlier step first"
                self.diagnostics.refuse("step-range", message, steps.span, hint)
            points = list(range(first, min(last, first + len(self.steps) + 1) + 1))
        return [node for point in points for node in self._of_point(point, steps.span)]

    def target_of(self, steps: Steps) -> ProgramNode | None:
        """The node with which the mission goes on at steps; None if it ends, or with an error."""
        with suppress(RefusedError):
            nodes = self.nodes_of(steps)
            if nodes and steps.behind:
                last = nodes[-1]
                if last.after is None and last.block is not self.program:
                    message = "this can't skip the last step of a repetition or of a case"
                    hint = "write the opposite condition before that step: `if ..., check "
                    hint += "checkpoint 4`"
                    self.diagnostics.refuse("step-range", message, steps.span, hint)
                return last.after
            if nodes:
                return nodes[0]
            message = f"step {steps.points[0]} has no task with which the mission could go on"
            hint = "name a step that measures or drives"
            self.diagnostics.error("empty-step", message, steps.span, hint)
        return None

    def _by_own_name(self, name: str) -> Do | None:
        """A task by the name that it has where the script gives none: `MEASURE 4 (2)`."""
        if self.own_names is None:
            tasks = [node for node in all_nodes(self.program) if isinstance(node, Do)]
            self.own_names = dict(zip(own_names(tasks), tasks, strict=True))
        return self.own_names.get(name)

    def _of_point(self, point: int | str, span: Span) -> list[ProgramNode]:
        if isinstance(point, str):
            do = self.named.get(point)
            if do is None or not do.is_listed:
                do = self._by_own_name(point)
            if do is None:
                message = f"there is no task `{point}`"
                self.diagnostics.refuse("unknown-step", message, span, "name a task or a step")
            return [do, *_bound_to(do)]
        if point not in self.steps:
            known = sorted(self.steps, key=lambda n: (abs(n - point), n))[:3]
            near = ", ".join(str(number) for number in sorted(known))
            hint = f"the nearest steps are {near}" if known else None
            self.diagnostics.refuse("unknown-step", f"there is no step {point}", span, hint)
        nodes = self.steps[point]
        if nodes is None:
            message = f"more than one step has the number {point}"
            hint = "give the steps new numbers, or name the task"
            self.diagnostics.refuse("ambiguous-step", message, span, hint)
        return [node for node in nodes if node.is_listed]

    def require_reached(self, span: Span, block: ProgramBlock) -> None:
        """Raise RefusedError unless the mission comes to the end of a block, or a step begins."""
        last, step = block.last, self.step
        begins = block is self.program and (not step or last is not step[-1])
        if leads_away(last) and not begins:
            message = "the mission never reaches this, because the words before it lead elsewhere"
            hint = "write it before those words, or as a separate step"
            self.diagnostics.refuse("second-route", message, span, hint)

    # ---- steps that are counted from the one that is being planned: `the next step`

    def counted(self, order: ScriptOrder) -> ScriptOrder:
        """The order with the numbers of the steps that it means."""
        for name in order.field_names:
            steps = getattr(order, name)
            if type(steps) is Steps and steps.ahead:
                given: dict[str, Any] = {name: self._numbered(steps)}
                return replace(order, **given)
        return order

    def skipping(self, order: ScriptOrder) -> ScriptOrder:
        """`Skip the next step`, in one case only: it goes on behind it."""
        if not isinstance(order, orders.Delete) or not isinstance(order.what, Steps):
            return order
        steps = self._numbered(order.what) if order.what.ahead else order.what
        following = (self.number or 0) + 1
        several = steps.points == (*range(following, following + len(steps.points)),)
        neighbours = steps.points[0] == following and (steps.through or several)
        if not order.what.ahead and not (neighbours and self.number):
            return order
        return orders.Jump(span=order.span, step=replace(steps, behind=True))

    def _numbered(self, steps: Steps) -> Steps:
        if self.number is None:
            message = "it is not clear which step is the next one"
            hint = "number the steps, and write the number: `step 4`"
            self.diagnostics.refuse("step-range", message, steps.span, hint)
        points = tuple(self.number + n for n in steps.points if isinstance(n, int))
        return replace(steps, points=points, ahead=False)


def _bound_to(do: Do) -> Iterator[ProgramNode]:
    """The conditions that are looked at after a task, in its own step."""
    node = do.after
    while isinstance(node, Choice) and node.bound:
        yield node
        node = node.after
