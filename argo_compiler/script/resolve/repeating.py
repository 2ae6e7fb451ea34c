"""Steps that are repeated: a round is put where that is said, and filled once all is planned.

Until then a repetition stands in the program as an empty round, so that a condition behind it is
one that is looked at after its last round.
"""

from collections.abc import Container, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import dropwhile, islice, takewhile

from argo_compiler.base.records import dataclass
from argo_compiler.il import Action, WaitRule
from argo_compiler.script.documents.source import RefusedError
from argo_compiler.script.resolve.accepting import said
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.manners import make_round
from argo_compiler.script.resolve.program import (
    Choice,
    Do,
    Leave,
    ProgramBlock,
    ProgramNode,
    ProgramRound,
    all_nodes,
)
from argo_compiler.script.sentences.tree import orders
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.places import Steps

_MOST_AGAIN = 1000


@dataclass(frozen=True, slots=True)
class _Repetition:
    """Steps that are to be repeated."""

    order: orders.Repeat
    round: ProgramRound
    late: Iterable[ProgramNode]
    """the nodes of the step that asks for it; of these, the first `known` were there before"""
    known: int


class Repeating:
    """Makes rounds of steps. Raises RefusedError where it is not clear of which."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.diagnostics = context.diagnostics
        self.pending: list[_Repetition] = []
        """repetitions, whose steps need not all have been planned yet"""

    def repeat(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """Notes that steps are repeated: a round is put here, which they come into later."""
        context = self.context
        order = self._again(order)
        if order.last:
            self._repeat_last(order, block)
        elif order.steps is not None and self._is_once_more(order, order.steps, block):
            self._once_more(order, order.steps, block)
        else:
            points = () if order.steps is None else (order.steps.points[0], order.steps.points[-1])
            base = f"Repeat {' to '.join(str(p) for p in dict.fromkeys(points))}".rstrip()
            if order.steps is not None:
                self._say_where(order, order.steps, block)
            round_ = make_round(order, base, context, order.name)
            self.pending.append(_Repetition(order, round_, context.step, len(context.step)))
            context.put([round_], block, block.last)
            context.recent = []
        context.choice = None

    def _again(self, order: orders.Repeat) -> orders.Repeat:
        """`Repeat step 2 once`: a repetition of one round in all would change nothing."""
        manner = order.manner
        if manner.more is not None or 1 not in (manner.times, manner.at_most):
            return order
        if manner.every is not None and manner.times == 1:  # `once every ten minutes`
            return replace(order, manner=replace(manner, times=None))
        if not order.again:
            message = "this can mean once in total, or once more"
            hint = "write `once in total`, or `once more`"
            self.diagnostics.refuse("ambiguous-repeat", message, order.span, hint)
        message = "`once` is taken as once more, so it is done twice in total"
        hint = "write `once more`, or `once in total` to do it a single time"
        self.diagnostics.warning("once-more", message, order.span, hint)
        return replace(order, manner=replace(manner, more=True))

    def _repeat_last(self, order: orders.Repeat, block: ProgramBlock) -> None:
        """`Repeat this twice`: the step before, or what was said before in the same step."""
        context = self.context
        if not context.step and self._follows_several():
            message = "this can be the previous step, or all steps so far"
            hint = "name the steps: `repeat step 3 twice`, `repeat steps 1 to 3 twice`"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        nodes = _topmost(context.step or context.before, block)
        starts = any(map(_is_start, nodes))
        one = not context.step or len(nodes) == 1 or all(n in context.recent for n in nodes)
        if not nodes or starts or not one or nodes[-1] is not block.last:
            message = "it is not clear what to repeat"
            hint = "name the steps: `repeat steps 2 and 3 twice`"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        round_ = make_round(order, "Repeat", context, order.name)
        anchor = nodes[0].before
        for node in nodes:
            block.remove(node)
            round_.body.append(node)
        block.insert_after(anchor, round_)

    def _follows_several(self) -> bool:
        """Whether more than one step has done anything so far but start."""
        steps = (step for step in self.context.steps.values() if step)
        done = (step for step in steps if not all(map(_is_start, step)))
        return len([*islice(done, 2)]) > 1

    def limited(self, order: orders.Amend, block: ProgramBlock) -> bool:
        """`Stop with it after 5 minutes`, `wait 1 minute in between`: said of the round before.
        False: that is not what it says, or of none."""
        manner, round_ = order.manner, block.last
        if not isinstance(round_, ProgramRound):
            return False
        if said(manner) == {"pause"} and manner.pause is not None and not round_.limits.pause:
            round_.limits = replace(round_.limits, pause=manner.pause)
            return True
        if manner.duration is None or said(manner) - {"duration", "finishing"}:
            return False
        if round_.limits.duration:
            message = "the duration is given twice"
            self.diagnostics.refuse("repeated-limit", message, order.span, "remove one of them")
        soft = bool(manner.finishing)
        round_.limits = replace(round_.limits, duration=manner.duration, soft=soft)
        return True

    def _is_once_more(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> bool:
        """Whether steps are done here again, and not in a round where they stand."""
        manner = order.manner
        if not manner:
            return len(steps.points) == 1
        if not manner.more or manner != Manner(times=manner.times, more=True):
            return False
        known = all(self.context.steps.get(p) for p in steps.points if isinstance(p, int))
        nodes = self.context.nodes_of(steps) if known else []
        return bool(nodes) and _topmost(nodes, block)[-1:] != [block.last]

    def _say_where(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> None:
        """Warns where steps that are repeated stand apart from the line that says so."""
        if not all(isinstance(p, int) and self.context.steps.get(p) for p in steps.points):
            return
        tops = _topmost(self.context.nodes_of(steps), block)
        behind = block.last
        if not tops or isinstance(behind, ProgramRound) or behind in tops:
            return
        if isinstance(behind, Do) and behind.docks:
            return  # nothing can be meant behind the return
        message = "these steps are repeated in their place, before the steps that follow them"
        hint = "write `repeat step 2 again` to do them here once more"
        self.diagnostics.warning("repeated-there", message, order.span, hint)

    def _once_more(self, order: orders.Repeat, steps: Steps, block: ProgramBlock) -> None:
        """`4. Repeat step 2`: what it does is done here again."""
        nodes = self.context.nodes_of(steps)
        tasks = [n for n in nodes if isinstance(n, Do) and not n.branches]
        if not nodes or len(tasks) < len(nodes):
            message = "this does not say how often, and it can't be done once more"
            hint = "write how often: `twice`, `three times in total`, `until ...`"
            self.diagnostics.refuse("endless-repeat", message, order.span, hint)
        tasks *= min(order.manner.times or 1, _MOST_AGAIN)
        again = [replace(task, ways=[], name=None) for task in tasks]
        self.context.put(again, block, block.last)
        self.context.step += again
        self.context.recent = again

    def fill_known(self) -> None:
        """Fills the rounds whose steps are all planned: a change of the plan that follows is one
        of the rounds as well."""
        waiting = [r for r in self.pending if not self._is_planned(r.order.steps)]
        known = [r for r in self.pending if self._is_planned(r.order.steps)]
        self.pending = waiting
        self._fill(known)

    def _is_planned(self, steps: Steps | None) -> bool:
        named, numbered = self.context.named, self.context.steps
        return steps is None or all(p in named or p in numbered for p in steps.points)

    def finish(self) -> None:
        """Fills the rounds with what is to be repeated, in the order in which it was asked for, and
        puts pauses between them."""
        self._fill(self.pending)
        self.pending.clear()
        self._put_pauses()

    def _fill(self, repetitions: Iterable[_Repetition]) -> None:
        for repetition in repetitions:
            with suppress(RefusedError):  # what is wrong with the others is said as well
                self._wrap(repetition)

    # ---- what comes into a round

    def _wrap(self, repetition: _Repetition) -> None:
        """Moves what is to be repeated into the round, and the round to where it stood."""
        order, round_ = repetition.order, repetition.round
        tail = list(_conditions_behind(round_))
        found = self._range(repetition, {id(node) for node in tail})
        if not found:
            return
        follows = _leads_to(found[-1], round_)
        if tail and (not follows or round_ in found):
            message = "this repetition is not directly after the steps that it repeats, so the "
            message += "condition after it can't be evaluated after its last round"
            hint = "write the repetition after the steps that it repeats"
            self.diagnostics.refuse("not-planned", message, order.span, hint)
        for node in (round_, *tail):
            node.home.remove(node)
        found = [node for node in found if node is not round_]
        block, anchor = found[0].home, found[0].before
        for node in found:
            block.remove(node)
            round_.body.append(node)
        block.insert_after(anchor, round_)
        self._behind(round_, tail)

    def _behind(self, round_: ProgramRound, tail: list[Choice]) -> None:
        """Conditions behind a round come before a way that leads on from its last task."""
        block = round_.home
        leave = round_.after if isinstance(round_.after, Leave) else None
        if tail and leave is not None:
            if tail[-1].otherwise.first is not None:
                message = "this leads elsewhere after the last round, and so does `otherwise`"
                self.diagnostics.error("second-route", message, leave.span, "remove one of the two")
            block.remove(leave)
            tail[-1].otherwise.append(leave)
        self.context.put(tail, block, round_)

    # ---- what is to be repeated

    def _range(self, repetition: _Repetition, behind: Container[int]) -> list[ProgramNode]:
        """The neighbouring nodes of one block that are to be repeated."""
        order, round_ = repetition.order, repetition.round
        if order.steps is None:
            if not (found := self._all(round_)):
                message = "there is nothing before this to repeat"
                hint = "write it after the tasks to repeat, or `do the following twice:`"
                self.context.refuse_missing("empty-step", message, order.span, hint)
            return found
        nodes = self.context.nodes_of(order.steps)
        noted = [id(node) for node in repetition.late]
        later = {*noted[repetition.known :]} - {*noted[: repetition.known]}
        nodes = [n for n in nodes if id(n) not in later and id(n) not in behind and _repeats(n)]
        if not nodes:
            said = " to ".join(str(p) for p in order.steps.points)
            message = f"step {said} has no task to repeat"
            hint = "name a step that measures or drives"
            self.diagnostics.refuse("empty-step", message, order.steps.span, hint)
        known = {id(node) for node in nodes}
        if order.steps.through and not all(isinstance(p, int) for p in order.steps.points):
            known |= _between(nodes[0], nodes[-1], self.context.program)
        block = _around(nodes, known, self.context.program, order.name or "")
        tops = _topmost(nodes, block)
        if any(not _covered(top, known) for top in tops):
            message = "these steps overlap with those of another repetition"
            hint = "put one completely within the other, or separate them"
            self.diagnostics.refuse("overlap", message, order.span, hint)
        return self._together(order, tops)

    def _all(self, round_: ProgramRound) -> list[ProgramNode]:
        """Everything before the round; above all tasks, everything up to the way home."""
        before = takewhile(lambda node: node is not round_, self.context.program)
        found = [n for n in before if not (_is_start(n) or _docks(n))]
        return found or [*takewhile(lambda node: not _docks(node), _from(round_.after))]

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
            message = "the first of these steps comes after the last"
            hint = "write the earlier step first"
            self.diagnostics.refuse("step-range", message, order.span, hint)
        listed = len(order.steps.points) > 1 and not order.steps.through
        if listed and any(_repeats(node) and id(node) not in ends for node in found):
            message = "these steps are not next to each other"
            self.diagnostics.refuse("step-range", message, order.span, "repeat consecutive steps")
        return found

    # ---- pauses between rounds, and not behind the last one

    def _put_pauses(self) -> None:
        """Make of `A three times, with a pause of 1 minute`: A, then twice the pause and A. Where
        the rounds end by a condition, those behind the first come only if it does not hold by
        then."""
        for node in list(all_nodes(self.context.program)):
            if isinstance(node, ProgramRound) and node.limits.pause:
                self._put_pause(node)

    def _put_pause(self, round_: ProgramRound) -> None:
        context = self.context
        limits = round_.limits
        tasks = [n for n in round_.body if isinstance(n, Do) and not n.branches]
        whole = len(tasks) == len(list(round_.body))
        ends = limits.count > 1 or (limits.until and not limits.count)
        if limits.duration or limits.every or not whole or not tasks or not ends:
            message = "a pause between rounds needs tasks without conditions, and a number of "
            message += "rounds or a condition that ends them"
            hint = "write the tasks and `wait 1 minute` as often as needed"
            context.diagnostics.error("pause", message, round_.span, hint)
            return
        block, anchor = round_.home, round_.before
        for task in tasks:
            round_.body.remove(task)
        wait = Do("WAIT", Action.WAIT, round_.span, wait=WaitRule(duration=limits.pause))
        copies = [wait, *(replace(task, ways=[], name=None) for task in tasks)]
        only = limits.count == 2 and not limits.until and round_.name is None
        before = [*tasks, *copies] if only else tasks
        context.put(before, block, anchor)
        for nodes in context.steps.values():
            if nodes is not None and round_ in nodes:
                at = nodes.index(round_)
                nodes[at:at] = before  # whoever goes to this step begins with the first round
        if only:
            block.remove(round_)
            return
        context.put(copies, round_.body, None)
        round_.limits = replace(limits, count=max(limits.count - 1, 0), pause=0.0)
        if limits.until:
            choice = Choice((limits.until,), round_.span, negated=True)
            block.insert_after(round_, choice)
            block.remove(round_)
            choice.then.append(round_)


def _is_start(node: ProgramNode) -> bool:
    return isinstance(node, Do) and node.action is Action.START


def _docks(node: ProgramNode) -> bool:
    return isinstance(node, Do) and node.docks


def _topmost(nodes: Iterable[ProgramNode], block: ProgramBlock) -> list[ProgramNode]:
    """The nodes of `block` that hold these, each once, in the block's order of first mention."""
    found: dict[int, ProgramNode] = {}
    for node in nodes:
        at: ProgramNode | None = node
        while at is not None and at.block is not block:
            at = at.owner
        if at is not None:
            found.setdefault(id(at), at)
    return list(found.values())


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
            node = node.owner if isinstance(node.owner, ProgramRound) else None
            continue
        node = node.after
        if node is round_:
            return True
        if _repeats(node):
            return False
    return False


def _between(first: ProgramNode, last: ProgramNode, program: ProgramBlock) -> set[int]:
    """What lies between two nodes, both included; nothing if the last does not follow."""
    (top, *_) = _topmost([first], _around([first, last], set(), program, ""))
    found: set[int] = set()
    for node in dropwhile(lambda node: node is not first, all_nodes(_from(top))):
        found.add(id(node))
        if node is last:
            return found
    return set()


def _from(node: ProgramNode | None) -> Iterator[ProgramNode]:
    """A node and those behind it in its block."""
    while node is not None:
        yield node
        node = node.after


def _around(
    nodes: list[ProgramNode], known: set[int], program: ProgramBlock, name: str
) -> ProgramBlock:
    """The innermost block that all nodes lie in; that around a round which they make up, unless
    the name says that it lies in that round: `Alpha/Beta`."""
    chain = _blocks_around(nodes[0])
    common = {id(block): i for i, block in enumerate(chain)}
    at = 0
    for node in nodes[1:]:
        around = (common.get(id(block)) for block in _blocks_around(node))
        at = max(at, next((i for i in around if i is not None), len(chain) - 1))
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
    at: ProgramNode | None = node
    while at is not None and at.block is not None:
        found.append(at.block)
        at = at.owner
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
