"""What is done in one case only, and where a case leads."""

from collections.abc import Callable, Sequence

from argo_compiler.script.resolve.accepting import require_used
from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.program import (
    Ahead,
    HomeAhead,
    Leave,
    ProgramBlock,
    Target,
    leads_away,
)
from argo_compiler.script.syntax.tree import orders
from argo_compiler.script.syntax.tree.orders import PlainWord, ScriptOrder

_ENDINGS = {
    PlainWord.ABORT: Ahead.END,
    PlainWord.END: Ahead.END,
    PlainWord.GO_ON: Ahead.GO_ON,
}


class CaseBranches:
    """Plans branches; the way home ends one, and the mission."""

    def __init__(
        self,
        context: Context,
        carry_out: Callable[[Sequence[ScriptOrder], ProgramBlock], None],
    ) -> None:
        self.context = context
        self.carry_out = carry_out
        """plans orders as any others are planned"""

    def plan(self, said: Sequence[ScriptOrder], branch: ProgramBlock) -> None:
        """Plans the orders of one case."""
        context = self.context
        before, ending = self._ending(list(said))
        memory = context.memory.last
        docked, recent, step = context.docked, context.recent, context.step
        context.docked, context.step = None, []
        self.carry_out(before, branch)
        if ending is not None:
            context.put([ending], branch, branch.last)
        if leads_away(branch.last):
            context.memory.last = memory
        context.docked, context.recent, context.step = docked, recent, step

    def _ending(self, said: list[ScriptOrder]) -> tuple[list[ScriptOrder], Leave | None]:
        """The orders of a case, and how it ends."""
        ending = None
        if said and isinstance(last := said[-1], orders.Plain) and last.word in _ENDINGS:
            require_used(last, self.context.diagnostics)
            ending = Leave(_ENDINGS[last.word], last.span)
            said.pop()
        if ending is not None and ending.target is Ahead.GO_ON:
            return said, ending
        if said and isinstance(home := said[-1], orders.Home):
            if home.manner is not None or home.name is not None:
                return said, Leave(Ahead.END, home.span)
            said.pop()
            ending = Leave(self._home_ahead(home), home.span)
        return said, ending

    def target(self, said: Sequence[ScriptOrder]) -> Target | None:
        """Where a case leads whose only order is to go elsewhere."""
        if len(said) != 1 or said[0].manner is not None or said[0].name is not None:
            return None
        match said[0]:
            case orders.Jump(step=step):
                return step
            case orders.Home() as home:
                return self._home_ahead(home)
            case orders.Plain(word=word):
                return _ENDINGS.get(word)
        return None

    def _home_ahead(self, order: orders.Home) -> HomeAhead:
        """The way home with which the mission ends where a condition leads to it."""
        named = order.dock.area
        area = None if named is None else self.context.lookup.area(named.area, order.dock.span)
        return HomeAhead(None if area is None else area.dock, order.dock.span)
