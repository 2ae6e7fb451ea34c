"""Puts steps into the rounds that repeat them, once all steps are planned.

A repetition stands in the program as an empty round until then, so that a condition behind it is
one that is looked at after its last round.
"""

from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from itertools import takewhile

from argo_compiler.il import Action
from argo_compiler.script.resolve.context import Context, topmost
from argo_compiler.script.resolve.program import (
    Choice,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    ProgramRound,
    nodes_from,
)
from argo_compiler.script.syntax.tree import orders


@dataclass(frozen=True, slots=True)
class Repetition:
    """Steps that are to be repeated."""

    order: orders.Repeat
    round: ProgramRound
    late: Iterable[ProgramNode]
    """the nodes of the step that asks for it; of these, the first `known` were there before"""
    known: int


class Wrapping:
    """Fills the rounds of repetitions, in the order in which they were asked for."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics

    def wrap(self, repetition: Repetition) -> None:
        """Moves what is to be repeated into the round, and the round to where it stood."""
        order, round_ = repetition.order, repetition.round
        tail = list(_conditions_behind(round_))
        found = self._range(repetition, {id(node) for node in tail})
        assert round_.block is not None
        if not found:
            return
        follows = _leads_to(found[-1], round_)
        if tail and (not follows or round_ in found):
            message = "a condition behind a repetition is looked at after its last round"
            hint = "write the repetition behind the steps that it repeats"
            self.diagnostics.refuse("not-planned", message, order.span, hint)
        for node in (round_, *tail):
            assert node.block is not None
            node.block.remove(node)
        found = [node for node in found if node is not round_]
        block, anchor = found[0].block, found[0].before
        assert block is not None
        for node in found:
            block.remove(node)
            round_.body.append(node)
        block.insert_after(anchor, round_)
        self._behind(round_, tail)

    def _behind(self, round_: ProgramRound, tail: list[Choice]) -> None:
        """Conditions behind a round come before a way that leads on from its last task."""
        block = round_.block
        assert block is not None
        leave = round_.after if isinstance(round_.after, Leave) else None
        if tail and leave is not None:
            if tail[-1].otherwise.first is not None:
                message = "after the last round this leads elsewhere, and so does `otherwise`"
                hint = "leave one of the two out"
                self.diagnostics.error("second-route", message, leave.span, hint)
            block.remove(leave)
            tail[-1].otherwise.append(leave)
        self.context.put(tail, block, round_)

    # ---- what is to be repeated

    def _range(self, repetition: Repetition, behind: Container[int]) -> list[ProgramNode]:
        """The neighbouring nodes of one block that are to be repeated."""
        order, round_ = repetition.order, repetition.round
        if order.steps is None:
            if not (found := self._all(round_)):
                message = "nothing is planned before this that could be repeated"
                hint = "write it behind what is to be repeated, or `do the following twice:`"
                self.diagnostics.refuse("empty-step", message, order.span, hint)
            return found
        nodes = self.context.nodes_of(order.steps)
        noted = [id(node) for node in repetition.late]
        later = {*noted[repetition.known :]} - {*noted[: repetition.known]}
        nodes = [n for n in nodes if id(n) not in later and id(n) not in behind and _repeats(n)]
        if not nodes:
            said = " to ".join(str(p) for p in order.steps.points)
            message = f"step {said} leaves nothing to do that could be repeated"
            hint = "name a step that measures or drives"
            self.diagnostics.refuse("empty-step", message, order.steps.span, hint)
        known = {id(node) for node in nodes}
        if order.steps.through and not all(isinstance(p, int) for p in order.steps.points):
            known |= _between(nodes[0], nodes[-1])
        block = _around(nodes, known, self.context.program, order.name or "")
        tops = topmost(nodes, block)
        if any(not _covered(top, known) for top in tops):
            message = "these steps and those of another repetition have only some in common"
            hint = "let one lie in the other as a whole, or separate them"
            self.diagnostics.refuse("overlap", message, order.span, hint)
        return self._together(order, tops)

    def _all(self, round_: ProgramRound) -> list[ProgramNode]:
        before = takewhile(lambda node: node is not round_, self.context.program)
        return [
            node
            for node in before
            if not (isinstance(node, Do) and (node.docks or node.action is Action.START))
        ]

    def _together(self, order: orders.Repeat, tops: list[ProgramNode]) -> list[ProgramNode]:
        """From the first to the last of the nodes, in the order of their block."""
        assert order.steps is not None
        ends = {id(node) for node in tops}
        first = tops[0]
        while first.before is not None and id(first.before) in ends:
            first = first.before
        found: list[ProgramNode] = [first]
        missing = len(ends) - 1
        while missing and found[-1].after is not None:
            found.append(found[-1].after)
            missing -= id(found[-1]) in ends
        if missing:
            message = "the first of these steps comes after the last one"
            hint = "write the earlier one first"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        listed = len(order.steps.points) > 1 and not order.steps.through
        if listed and any(_repeats(node) and id(node) not in ends for node in found):
            message = "these steps are not next to each other"
            hint = "repeat steps that follow each other"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        return found


def _repeats(node: ProgramNode) -> bool:
    """Whether a node is something that a round can begin or end with."""
    if isinstance(node, Leave) or (isinstance(node, ProgramRound) and node.body.first is None):
        return False
    return not (isinstance(node, Do) and node.action is Action.START)


def _conditions_behind(round_: ProgramRound) -> Iterator[Choice]:
    node = round_.after
    while isinstance(node, Choice):
        yield node
        node = node.after


def _leads_to(last: ProgramNode, round_: ProgramRound) -> bool:
    """Whether nothing is done between a node and a repetition behind it."""
    node: ProgramNode | None = last
    while node is not None:
        if node.after is None:
            owner = node.block.owner if node.block is not None else None
            node = owner if isinstance(owner, ProgramRound) else None
            continue
        node = node.after
        if node is round_:
            return True
        if _repeats(node):
            return False
    return False


def _between(first: ProgramNode, last: ProgramNode) -> set[int]:
    """What lies between two nodes, both included; nothing if the last does not follow."""
    found: set[int] = set()
    for node in nodes_from(first):
        found.add(id(node))
        if node is last:
            return found
    return set()


def _around(
    nodes: list[ProgramNode], known: set[int], program: ProgramBlock, name: str
) -> ProgramBlock:
    """The innermost block that all nodes lie in; that around a round which they make up, unless
    the name says that it lies in that round: `Alpha/Beta`."""
    chain = _blocks_around(nodes[0])
    common = {id(block): i for i, block in enumerate(chain)}
    at = 0
    for node in nodes[1:]:
        block = node.block
        while block is not None and id(block) not in common:
            block = block.owner.block if block.owner is not None else None
        at = max(at, common[id(block)] if block is not None else len(chain) - 1)
    while at + 1 < len(chain):
        owner = chain[at].owner
        if not (isinstance(owner, ProgramRound) and _covered(owner, known)):
            break
        if name.startswith(f"{owner.title}/"):
            break
        known.add(id(owner))
        at += 1
    return chain[at] if chain else program


def _blocks_around(node: ProgramNode) -> list[ProgramBlock]:
    found: list[ProgramBlock] = []
    block = node.block
    while block is not None:
        found.append(block)
        block = block.owner.block if block.owner is not None else None
    return found


def _covered(node: ProgramNode, known: set[int]) -> bool:
    """Whether a node is one of these, or a round of them."""
    waiting = [node]
    while waiting:
        node = waiting.pop()
        if id(node) in known or not _repeats(node):
            continue
        if not isinstance(node, ProgramRound):
            return False
        waiting += [inner for inner in node.body if not isinstance(inner, Choice)]
    return True
