"""Changes of the plan: what is added, taken out, moved or replaced."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NoReturn

from argo_compiler.base.catalog import CheckpointInfo
from argo_compiler.base.listing import listed
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import (
    Choice,
    Do,
    Leave,
    ProgramNode,
    ProgramRound,
    all_nodes,
    measurement,
)
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.nouns import Nouns
from argo_compiler.script.sentences.tree.orders import Side
from argo_compiler.script.sentences.tree.places import Steps

Edit = orders.Add | orders.Delete | orders.Move | orders.Replace


class Edits:
    """Carries changes out, in the order of the script. Raises RefusedError where it can't."""

    def __init__(self, context: Context, manners: Manners) -> None:
        self.context = context
        self.manners = manners
        self.diagnostics = context.diagnostics

    def carry_out(self, edit: Edit) -> None:
        """Changes the program."""
        self.context.choice = None
        match edit:
            case orders.Add():
                self._add(edit)
            case orders.Delete():
                for do in self._found(edit.what):
                    self._take_out(do, edit)
            case orders.Move():
                self._move(edit)
            case orders.Replace():
                self._replace(edit)

    def _add(self, edit: orders.Add) -> None:
        checkpoints = self.context.nouns.all(edit.what)
        anchors = self._found(edit.anchor)
        tasks = [measurement(c, edit.span) for c in checkpoints]
        self.manners.name(edit, tasks)
        nodes = self.manners.apply(edit, tasks)
        self._put(nodes, anchors, edit.side)
        self.context.step += nodes
        self.context.recent = tasks
        self.context.memory.measured(checkpoints)

    def _put(
        self, nodes: Sequence[ProgramNode], anchors: Sequence[ProgramNode], side: Side
    ) -> None:
        anchor = _outside(anchors[0] if side is Side.BEFORE else anchors[-1], side)
        before = anchor.before if side is Side.BEFORE else anchor
        self.context.put(nodes, anchor.home, before)

    def put_between(
        self, between: Nouns | Steps, nodes: Sequence[ProgramNode]
    ) -> tuple[ProgramNode, ProgramNode]:
        """Put nodes between two neighbouring tasks, and return these.

        Raises RefusedError if they are not neighbours.
        """
        first, second = self._ends(between)
        before, after = _behind(first), _ahead(second)
        if first is second or before.after is not after:
            self._refuse_ends(between, first, second)
        if _goes_elsewhere(before):
            message = "the mission may go elsewhere after the first of these, and not to this wait"
            hint = "write the wait in a line of its own, between the lines of the two"
            self.diagnostics.refuse("bound-task", message, between.span, hint)
        self.context.put(nodes, before.home, before)
        self.context.step += nodes
        self.context.recent = [node for node in nodes if isinstance(node, Do)]
        return first, second

    def _ends(self, between: Nouns | Steps) -> tuple[ProgramNode, ProgramNode]:
        """The last task of the first, and the first task of the second."""
        things: list[Nouns | Steps | CheckpointInfo] = []
        if isinstance(between, Steps):
            things += [replace(between, points=(point,)) for point in between.points]
        else:
            nouns = self.context.nouns
            things += nouns.all(between) if between.either else nouns.each(between)
        if len(things) != 2:
            message = f"this names {len(things)} checkpoints, but a wait is between two tasks"
            hint = "name two: `between #1 and #3`"
            self.diagnostics.refuse("not-neighbours", message, between.span, hint)

        def found(thing: Nouns | Steps | CheckpointInfo) -> Sequence[ProgramNode]:
            if isinstance(thing, CheckpointInfo):
                return [self._measured(thing, between.span)]
            return self._found(thing)

        first, second = self.diagnostics.each(found, things)
        return first[-1], second[0]

    def _refuse_ends(
        self, between: Nouns | Steps, first: ProgramNode, second: ProgramNode
    ) -> NoReturn:
        if first is second:
            message = "nothing is between a task and itself"
            hint = "name two tasks, one after the other"
        else:
            nodes = list(all_nodes(self.context.program))
            start, end = nodes.index(first), nodes.index(second)
            inner = len(list(all_nodes([first])))
            tasks = [node for node in nodes[start + inner : end] if isinstance(node, Do)]
            message = "these two do not come one right after the other"
            hint = "write the wait in a line of its own, where it is to be"
            if end < start:
                message = "the second of these comes before the first"
                hint = "name first what is done first"
            elif tasks and (source := tasks[0].source):
                message += f": `{tasks[0].base}` (line {source.line}) comes between"
        self.diagnostics.refuse("not-neighbours", message, between.span, hint)

    def _take_out(self, do: ProgramNode, edit: Edit) -> list[ProgramNode]:
        """Takes a task out of the program, with where it leads."""
        whole = _emptied(do)
        bound = any(isinstance(n, Choice) for n in (do.after, whole.after, whole.owner))
        if bound or not isinstance(do, Do) or do.failure is not None:
            message = "this task belongs to a condition, so it can't be moved or deleted"
            hint = "change the line of the condition"
            self.diagnostics.refuse("bound-task", message, edit.span, hint)
        taken: list[ProgramNode] = [do]
        if isinstance(do.after, Leave):
            taken.append(do.after)
        for node in [*taken, whole] if whole is not do else taken:
            node.home.remove(node)
        self.context.forget(do)
        return taken

    def _move(self, edit: orders.Move) -> None:
        nodes, anchors = self.diagnostics.each(self._found, (edit.what, edit.anchor))
        if any(node is anchor for node in nodes for anchor in anchors):
            message = "this can't be before or after itself"
            self.diagnostics.refuse("self-move", message, edit.span, "name another position")
        self._put([n for node in nodes for n in self._take_out(node, edit)], anchors, edit.side)

    def _replace(self, edit: orders.Replace) -> None:
        checkpoint = self.context.nouns.one(edit.by)
        nodes = self._found(edit.what)
        do = nodes[0]
        single = len(nodes) == 1 and not isinstance(do.after, Choice)
        if not single or not isinstance(do, Do) or do.action is not Action.MEASURE:
            message = "only a single measurement can be replaced"
            hint = "delete this, and add the other one after it"
            self.diagnostics.refuse("bound-task", message, edit.span, hint)
        self.context.forget(do)
        new = measurement(checkpoint, edit.span)
        do.base, do.object_id, do.source = new.base, new.object_id, new.source
        self.context.note(do)
        self.context.step.append(do)
        self.context.recent = [do]
        self.context.memory.measured([checkpoint])

    def _found(self, thing: Nouns | Steps) -> list[ProgramNode]:
        """The planned tasks that are meant."""
        if isinstance(thing, Steps):
            return self._of_steps(thing)
        return [self._measured(c, thing.span) for c in self.context.nouns.all(thing)]

    def _measured(self, checkpoint: CheckpointInfo, span: Span) -> Do:
        """The only measurement of a checkpoint."""
        tasks = self.context.measurements(checkpoint)
        name = f"checkpoint #{checkpoint.id}"
        if len(tasks) == 1:
            return tasks[0]
        if tasks:
            lines = sorted({s.line for do in tasks[:20] if (s := do.source)})
            where = listed(str(line) for line in lines)
            message = f"{name} is measured more than once at this point: in lines {where}"
            hint = "name it by its step: `step 3`"
            self.diagnostics.refuse("ambiguous-edit", message, span, hint)
        message = f"{name} is not in the mission at this point"
        hint = f"write before this line: `Check the {name}`"
        self.context.refuse_missing("not-planned", message, span, hint)

    def _of_steps(self, steps: Steps) -> list[ProgramNode]:
        planned = [self.context.steps.get(p) for p in steps.points if isinstance(p, int)]
        known = all(isinstance(p, int) for p in steps.points) and all(planned)
        named = all(isinstance(p, str) and p in self.context.named for p in steps.points)
        nodes = self.context.nodes_of(steps) if known or named else []
        if not nodes:
            message = "no task of this step is in the mission at this point"
            hint = "name a step above this line that measures or drives"
            self.context.refuse_missing("not-planned", message, steps.span, hint)
        return nodes


def _outside(node: ProgramNode, side: Side) -> ProgramNode:
    """The node; or the round that begins with it, or ends, as what is put before or behind that is
    none of the round. Behind a node is what is looked at after it, and where it leads."""
    while True:
        while side is Side.AFTER and isinstance(node.after, Choice | Leave):
            node = node.after
        inner = node.before if side is Side.BEFORE else node.after
        if inner is not None or not isinstance(node.owner, ProgramRound):
            return node
        node = node.owner


def _behind(node: ProgramNode) -> ProgramNode:
    """The node; or the round that ends with it."""
    while node.after is None and isinstance(node.owner, ProgramRound):
        node = node.owner
    return node


def _ahead(node: ProgramNode) -> ProgramNode:
    """The node; or the round that begins with it."""
    while node.before is None and isinstance(node.owner, ProgramRound):
        node = node.owner
    return node


def _goes_elsewhere(node: ProgramNode) -> bool:
    """Return True if the mission may leave a node for another one than what stands behind it."""
    nodes = all_nodes([node])
    return any(isinstance(n, Leave) or (isinstance(n, Do) and bool(n.ways)) for n in nodes)


def _emptied(node: ProgramNode) -> ProgramNode:
    """The node; or the round that has nothing to do without it."""
    while node.block is not None and node.block.first is node:
        owner, behind = node.block.owner, node.after
        if behind is not None and not (isinstance(behind, Leave) and behind.after is None):
            break
        if not isinstance(owner, ProgramRound):
            break
        node = owner
    return node
