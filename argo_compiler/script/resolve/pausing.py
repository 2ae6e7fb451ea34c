"""Pauses between the rounds of a repetition, and not behind the last one."""

from dataclasses import replace

from argo_compiler.il import WaitRule
from argo_compiler.script.resolve import making
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import Choice, Do, ProgramRound, all_nodes


def put_pauses(context: Context) -> None:
    """Makes of `A three times, with a pause of 1 minute`: A, then twice the pause and A. Where the
    rounds end by a condition, those behind the first come only if it does not hold by then."""
    for node in list(all_nodes(context.program)):
        if isinstance(node, ProgramRound) and node.limits.pause:
            _put(node, context)


def _put(round_: ProgramRound, context: Context) -> None:
    limits = round_.limits
    tasks = [n for n in round_.body if isinstance(n, Do) and not (n.ways or n.failure or n.missed)]
    whole = len(tasks) == len(list(round_.body))
    ends = limits.count > 1 or (limits.until and not limits.count)
    if limits.duration or limits.every or not whole or not tasks or not ends:
        message = "a pause can only be between rounds of tasks without conditions, of which it is "
        message += "said how many they are, or until what"
        hint = "write the tasks and `wait 1 minute` out as often as they are done"
        context.diagnostics.error("pause", message, round_.span, hint)
        return
    block, anchor = round_.block, round_.before
    assert block is not None
    for task in tasks:
        round_.body.remove(task)
    wait = making.wait(WaitRule(duration=limits.pause), round_.span)
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
