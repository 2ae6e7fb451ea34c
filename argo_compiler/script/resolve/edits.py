"""Changes of the plan: what is added, taken out, moved or replaced."""

from collections.abc import Sequence

from argo_compiler.il import Action
from argo_compiler.listing import listed
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import Manners
from argo_compiler.script.resolve.program import Choice, Do, ProgramNode
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.nouns import Nouns
from argo_compiler.script.syntax.tree.orders import Side
from argo_compiler.script.syntax.tree.places import Steps

Edit = orders.Add | orders.Delete | orders.Move | orders.Replace


class Edits:
    """Carries changes out, in the order of the script."""

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
                for do in self._found(edit.what) or ():
                    self._take_out(do, edit)
            case orders.Move():
                self._move(edit)
            case orders.Replace():
                self._replace(edit)

    def _add(self, edit: orders.Add) -> None:
        checkpoints = self.context.nouns.all(edit.what)
        anchors = self._found(edit.anchor)
        if checkpoints is None or anchors is None:
            self.context.fail()
            return
        tasks = [making.measurement(c.id, edit.span) for c in checkpoints]
        self.manners.name(edit, tasks)
        nodes = self.manners.apply(edit, tasks)
        self._put(nodes, anchors, edit.side)
        self.context.step += nodes
        self.context.recent = tasks
        self.context.remember(checkpoints)

    def _put(
        self, nodes: Sequence[ProgramNode], anchors: Sequence[ProgramNode], side: Side
    ) -> None:
        anchor = anchors[0] if side is Side.BEFORE else anchors[-1]
        block = anchor.block
        assert block is not None
        if side is Side.BEFORE:
            before = anchor.before
        else:
            before = anchor
            # What a condition behind it leads to belongs to it.
            while isinstance(before.after, Choice):
                before = before.after
        self.context.put(nodes, block, before)

    def _take_out(self, do: ProgramNode, edit: Edit) -> bool:
        if isinstance(do.after, Choice) or not isinstance(do, Do) or do.failure is not None:
            message = "this task belongs to a condition, so it can't be moved or taken out"
            hint = "change the line that asks for it"
            self.diagnostics.error("bound-task", message, edit.span, hint)
            return False
        if do.block is not self.context.program and do.block is not None:
            owner = do.block.owner
            if isinstance(owner, Choice):
                message = "this task belongs to a condition, so it can't be moved or taken out"
                hint = "change the line that asks for it"
                self.diagnostics.error("bound-task", message, edit.span, hint)
                return False
        assert do.block is not None
        do.block.remove(do)
        self.context.forget(do)
        return True

    def _move(self, edit: orders.Move) -> None:
        nodes = self._found(edit.what)
        anchors = self._found(edit.anchor)
        if not nodes or anchors is None:
            return
        if any(node is anchor for node in nodes for anchor in anchors):
            message = "this is to stand before or after itself"
            self.diagnostics.error("self-move", message, edit.span, "name another place")
            return
        if all(self._take_out(node, edit) for node in nodes):
            self._put(nodes, anchors, edit.side)

    def _replace(self, edit: orders.Replace) -> None:
        checkpoint = self.context.nouns.one(edit.by)
        nodes = self._found(edit.what)
        if checkpoint is None or nodes is None:
            self.context.fail()
            return
        do = nodes[0]
        single = len(nodes) == 1 and isinstance(do, Do) and do.action is Action.MEASURE
        if not single or isinstance(do.after, Choice):
            message = "only a single measurement can be replaced"
            hint = "delete what is there, and add the other behind it"
            self.diagnostics.error("bound-task", message, edit.span, hint)
            return
        assert isinstance(do, Do)
        self.context.forget(do)
        new = making.measurement(checkpoint.id, edit.span)
        do.base, do.object_id, do.source = new.base, new.object_id, new.source
        self.context.note(do)
        self.context.step.append(do)
        self.context.recent = [do]
        self.context.remember([checkpoint])

    def _found(self, thing: Nouns | Steps) -> list[ProgramNode] | None:
        """The planned tasks that are meant; None if it is not clear which."""
        if isinstance(thing, Steps):
            return self._of_steps(thing)
        checkpoints = self.context.nouns.all(thing)
        if checkpoints is None:
            self.context.fail()
            return None
        found: list[ProgramNode] = []
        for checkpoint in checkpoints:
            tasks = list(self.context.measured.get(str(checkpoint.id), {}).values())
            name = f"checkpoint #{checkpoint.id}"
            if len(tasks) == 1:
                found += tasks
                continue
            if tasks:
                lines = sorted({s.line for do in tasks[:20] if (s := do.source)})
                where = listed(str(line) for line in lines)
                message = f"{name} is measured more than once at this point: lines {where}"
                hint = "say which of them is meant by its step: `step 3`"
                self.diagnostics.error("ambiguous-edit", message, thing.span, hint)
            elif self.context.whole:
                hint = f"ask for it before this line: `Check the {name}`"
                message = f"{name} is not in the plan at this point"
                self.diagnostics.error("not-planned", message, thing.span, hint)
            return None
        return found

    def _of_steps(self, steps: Steps) -> list[ProgramNode] | None:
        planned = [self.context.steps.get(p) for p in steps.points if isinstance(p, int)]
        known = all(isinstance(p, int) for p in steps.points) and all(planned)
        named = all(isinstance(p, str) and p in self.context.named for p in steps.points)
        nodes = self.context.nodes_of(steps) if known or named else []
        if nodes:
            return nodes
        if self.context.whole:
            message = "no task of this step is in the plan at this point"
            hint = "name a step above this line that measures or drives"
            self.diagnostics.error("not-planned", message, steps.span, hint)
        return None
