"""Static checks of a mission: the structure of its tasks, transitions, groups and reactions.

They need no knowledge of the execution paths of a run. An error means that the mission has no
defined meaning and can't be lowered; a warning, that its meaning may surprise.
"""

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.memoization import cache_last_results_by_identity
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
    """Return the diagnostics of a mission: its tasks, groups, reactions and header.

    With a catalogue, the names of things on the site are looked up in it. Runs in linear time. The
    `subject` of each diagnostic is the part of the mission that it is about.
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
        known = None  # the mission's numbers are those of another site
    else:
        known = None if catalog is None else frozenset(str(c.id) for c in catalog.checkpoints)
    return (
        *TaskChecks(mission, known).diagnostics(),
        *_check_structure(mission),
        *check_header(mission, catalog),
        *check_precedence(mission),
    )


@cache_last_results_by_identity
def _check_structure(mission: Mission) -> tuple[Diagnostic, ...]:
    """Return the diagnostics that need no catalogue, with a cache, as these checks take longest."""
    return (
        *check_instant_loops(mission),
        *check_groups(mission),
        *check_reactions(mission),
    )
