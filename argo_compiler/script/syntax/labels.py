"""The labels of fields, and what is said about one that there is not."""

import re

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.listing import listed
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.spelling import nearest

PROTOCOL_LABELS = (
    "Designation",
    "Mode",
    "Maximum duration",
    "Order",
    "Anomaly specification",
    "Real-time reporting",
    "After-mission report",
    "Initial position",
    "End of the mission",
    "Site",
    "Start area",
    "End area",
    "Dock",
    "Current",
    "Left out",
    "Hint",
)
_LABEL = re.compile(r"[^\W\d_][\w'-]*(?:\s+[\w'-]+){0,6}\s*:")


def name_unknown_label(text: ScriptText, known: tuple[str, ...], diagnostics: Diagnostics) -> None:
    """Makes the last diagnostic one of an unknown label, if the statement begins with one."""
    match = _LABEL.match(text.content)
    last = diagnostics.entries[-1]
    if match is None or last.code != "script.not-understood" or last.span is None:
        return
    span = text.span(0, match.end() - 1)
    if last.span.line != span.line or last.span.column > span.column + span.length:
        return
    label = match.group()[:-1].strip()
    if any(label.lower() == k.lower() for k in known):
        return
    close = nearest(label, known)
    hint = f"the labels are {listed(f'`{k}:`' for k in known)}"
    if close:
        hint = f"`{close[0]}:` is the nearest; {hint}"
    diagnostics.entries[-1] = Diagnostic(
        code="script.unknown-label",
        severity=last.severity,
        message=f"there is no field `{label}`",
        span=span,
        excerpt=last.excerpt,
        hint=hint,
    )
