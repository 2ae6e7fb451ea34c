"""The planning language: from a mission's script to a checked plan, its machine and best route.

What common jobs need is here by name, and imported when it is first used:

- a mission: `import_script`, `format_script`, `read_mission`, `write_mission`; a `Mission` is made
  of `Task`, `Group`, `Transition`, `Condition` and `Reaction`;
- what is wrong with it: `check` and `analyse` give a `Diagnostic` each;
- its run: `lower` makes the machine that an `Executor` carries out, told by `Pause`,
  `ActionSucceeded` and their like what happens; its `Progress` is stored, and a person may do
  a part of it (`ByHand`, `hand_over`);
- the best order: `suggest_route` for a `RouteProblem` of `Visit`s and `Precedence`s;
- what goes wrong: `ArgoError` and its kinds.
"""

import logging
from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names
from argo_compiler.base.version import __version__ as __version__

__all__ = [
    "ActionFailed",
    "ActionStopped",
    "ActionSucceeded",
    "ArgoError",
    "ByHand",
    "Catalog",
    "Condition",
    "Conflict",
    "Diagnostic",
    "DiagnosticError",
    "Executor",
    "Group",
    "Invalid",
    "Mission",
    "NotFound",
    "Pause",
    "Precedence",
    "Progress",
    "Reaction",
    "Resume",
    "RouteProblem",
    "Task",
    "Transition",
    "Unavailable",
    "Unreachable",
    "Visit",
    "analyse",
    "check",
    "format_script",
    "hand_over",
    "import_script",
    "lower",
    "read_mission",
    "suggest_route",
    "write_mission",
]

if TYPE_CHECKING:
    from argo_compiler.analysis.analysing import analyse
    from argo_compiler.base.catalog import Catalog
    from argo_compiler.base.errors import (
        ArgoError,
        Conflict,
        Invalid,
        NotFound,
        Unavailable,
        Unreachable,
    )
    from argo_compiler.checks import check
    from argo_compiler.diagnostics import Diagnostic, DiagnosticError
    from argo_compiler.files.mission_file import read_mission, write_mission
    from argo_compiler.hfsm import (
        ActionFailed,
        ActionStopped,
        ActionSucceeded,
        ByHand,
        Executor,
        Pause,
        Progress,
        Resume,
    )
    from argo_compiler.hfsm.handover import hand_over
    from argo_compiler.hfsm.lowering import lower
    from argo_compiler.il import Condition, Group, Mission, Reaction, Task, Transition
    from argo_compiler.route import Precedence, RouteProblem, Visit, suggest_route
    from argo_compiler.script import format_script, import_script
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "analysis.analysing": ["analyse"],
            "base.catalog": ["Catalog"],
            "checks": ["check"],
            "diagnostics": ["Diagnostic", "DiagnosticError"],
            "base.errors": [
                "ArgoError",
                "Conflict",
                "Invalid",
                "NotFound",
                "Unavailable",
                "Unreachable",
            ],
            "files.mission_file": ["read_mission", "write_mission"],
            "hfsm.handover": ["hand_over"],
            "hfsm": [
                "ActionFailed",
                "ActionStopped",
                "ActionSucceeded",
                "ByHand",
                "Executor",
                "Pause",
                "Progress",
                "Resume",
            ],
            "hfsm.lowering": ["lower"],
            "il": ["Condition", "Group", "Mission", "Reaction", "Task", "Transition"],
            "route": ["Precedence", "RouteProblem", "Visit", "suggest_route"],
            "script": ["format_script", "import_script"],
        },
    )

# What a library logs is shown where its user asks for it.
logging.getLogger(__name__).addHandler(logging.NullHandler())
