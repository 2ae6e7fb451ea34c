"""Registry of all diagnostic codes with severity, meaning and remedy.

Codes are explained only here, in one file for each part of Argo. SARIF's rules and the tables in
`docs/diagnostics.md`, which `make generated` writes, are made from this registry.
"""

from argo_compiler.diagnostics.codes.analysis import ANALYSIS
from argo_compiler.diagnostics.codes.code import Code
from argo_compiler.diagnostics.codes.edit import EDIT
from argo_compiler.diagnostics.codes.evaluation import EVALUATION
from argo_compiler.diagnostics.codes.export import EXPORT
from argo_compiler.diagnostics.codes.faults import FAULTS
from argo_compiler.diagnostics.codes.file import FILE
from argo_compiler.diagnostics.codes.handover import HANDOVER
from argo_compiler.diagnostics.codes.il import IL
from argo_compiler.diagnostics.codes.isar import ISAR
from argo_compiler.diagnostics.codes.ros import ROS
from argo_compiler.diagnostics.codes.route import ROUTE
from argo_compiler.diagnostics.codes.script import SCRIPT
from argo_compiler.diagnostics.codes.site import SITE

CODES: dict[str, Code] = {
    **SCRIPT,
    **FILE,
    **IL,
    **ANALYSIS,
    **EXPORT,
    **ISAR,
    **ROS,
    **SITE,
    **FAULTS,
    **EVALUATION,
    **HANDOVER,
    **ROUTE,
    **EDIT,
}
"""explanations by the code's name"""


BEGIN, END = "<!-- codes -->", "<!-- end of codes -->"
"""the marks around the tables in `docs/diagnostics.md`"""


def as_markdown() -> str:
    """Return the codes as Markdown tables, one for each part of Argo."""
    parts: dict[str, list[str]] = {}
    for name, code in CODES.items():
        row = f"| `{name}` | {code.severity} | {code.meaning} | {code.remedy} |"
        parts.setdefault(name.partition(".")[0], []).append(row)
    head = "| code | | meaning | remedy |\n|---|---|---|---|"
    return "\n\n".join("\n".join((f"### `{part}`\n", head, *rows)) for part, rows in parts.items())
