"""What a script says is not to be checked."""

from argo_compiler.script.resolve.context import Context


def check_spared(context: Context) -> None:
    """Looks whether it is in the plan; what is not, is said."""
    for key, span in context.spared.items():
        tasks = context.measured.get(key)
        if tasks:
            lines = sorted({s.line for do in tasks.values() if (s := do.source)})
            asks = f"line {lines[0]} asks for checkpoint #{key}" if lines else "it is asked for"
            hint = "leave one of the two out, or write `except` in the line that asks for it"
            context.diagnostics.error("spared", asks, span, hint)
        else:
            message = f"checkpoint #{key} is not in the plan anyway, so that this has no effect"
            context.diagnostics.note("no-effect", message, span)
