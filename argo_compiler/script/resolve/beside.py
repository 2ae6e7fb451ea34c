"""`Before you read gauge 2, check valve R12`: both are measured, the one that stands beside too."""

from argo_compiler.script.resolve.context import Context
from argo_compiler.script.resolve.lookup import told
from argo_compiler.script.syntax.tree.orders import Beside, Measure, Side


def measured_beside(order: Beside, context: Context) -> list[Measure]:
    """What is measured, in its order; what is behind the other may have been measured before."""
    anchor = context.nouns.all(order.anchor)
    done = [c for c in anchor if context.measured.get(str(c.id))]
    other = Measure(span=order.span, what=order.anchor)
    if order.side is Side.AFTER:
        both = [order.order] if len(done) == len(anchor) else [other, order.order]
    elif done:
        message = f"{told(done[0])} is measured before this already"
        hint = "write this before it, or say that it is measured once more"
        context.diagnostics.refuse("ambiguous-edit", message, order.span, hint)
    else:
        both = [order.order, other]
    context.once.update((str(c.id), order.span) for c in anchor if c not in done)
    return both


def require_once(context: Context) -> None:
    """Asks about what is measured beside another one, and elsewhere as well."""
    for key, span in context.once.items():
        if len(context.measured.get(key, {})) > 1:
            message = f"checkpoint #{key} is measured elsewhere as well: it can be meant to be "
            message += "measured here, too, or only there"
            hint = "name it in one of the two only, or write `check it again`"
            context.diagnostics.error("ambiguous-edit", message, span, hint)
