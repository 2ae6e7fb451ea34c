"""Whether a mission makes sense: the structure of its tasks, transitions, groups and reactions.

What is found here needs no knowledge of the paths that a run may take. An error means that the
mission has no agreed meaning and can't be lowered; a warning, that it has one that may surprise.
"""

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.remembering import remembering
from argo_compiler.checks.groups import check_groups
from argo_compiler.checks.header import check_header
from argo_compiler.checks.instant_loops import check_instant_loops
from argo_compiler.checks.precedence import check_precedence
from argo_compiler.checks.reactions import check_reactions
from argo_compiler.checks.tasks import TaskChecks
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.il import Mission

__all__ = ["check"]


def check(mission: Mission, catalog: Catalog | None = None) -> tuple[Diagnostic, ...]:
    """All that is wrong or odd about a mission: its tasks, groups, reactions and header.

    With a catalogue, what the mission names on the site is looked up in it. Linear time. Each
    diagnostic names what it is about as its `subject`.
    """
    if not mission.tasks:
        return (
            diagnostic_of(
                "il.empty-mission",
                "the mission has no tasks",
                "add a task; a mission that does nothing has a START task only",
                "tasks",
            ),
        )
    if catalog and mission.site and mission.site != catalog.site:
        known = None  # its numbers mean checkpoints of another site
    else:
        known = None if catalog is None else frozenset(str(c.id) for c in catalog.checkpoints)
    return (
        *TaskChecks(mission, known).diagnostics(),
        *_check_structure(mission),
        *check_header(mission, catalog),
        *check_precedence(mission),
    )


@remembering
def _check_structure(mission: Mission) -> tuple[Diagnostic, ...]:
    """What no catalogue is needed for, and takes longest."""
    return (
        *check_instant_loops(mission),
        *check_groups(mission),
        *check_reactions(mission),
    )
