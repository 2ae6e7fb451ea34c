"""Check of a mission without running it."""

from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import TYPE_CHECKING

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import INCOMPLETE, ArgoError
from argo_compiler.base.message import Message
from argo_compiler.base.stages import stage
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    Severity,
    by_position,
    has_errors,
    severity_counts_text,
    to_json,
    to_sarif,
    to_text,
)
from argo_compiler.files.loading import FileError
from argo_env.planning.opening import OpenedSite
from argo_env.planning.site_warnings import above_own_speed_warnings, not_seen_from_pose_warnings
from argo_planner.use_cases.importing import (
    SourceKind,
    Upload,
    guess_source_kind,
    load_unchecked_mission,
    require_no_areas,
)

if TYPE_CHECKING:
    from argo_compiler.analysis import Travel
    from argo_compiler.script import DraftLine

MAX_POSES = 1_000
"""highest number of poses between which a check plans paths; each takes some milliseconds"""


class Format(StrEnum):
    """Format of written diagnostics."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"


def check_source(
    upload: Upload,
    catalog: Catalog,
    start_area: int | None = None,
    end_area: int | None = None,
    travel: "Travel | None" = None,
    site: OpenedSite | None = None,
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics of a mission, by position in the source.

    A stage that finds errors is the last one: reading, then checks, then analysis.

    Args:
        upload: script or mission
        catalog: names and poses of the site
        start_area: starting area, for a script that names none; an error if it names another
        end_area: area to end in, likewise
        travel: travel times; None: times are not checked
        site: the site; None: views of checkpoints and speeds are not checked

    Raises:
        Invalid: Areas are given for a mission, which has its own.
        IncompleteDraft: The script has lines to confirm or to answer.
    """
    if guess_source_kind(upload) is not SourceKind.SCRIPT:
        require_no_areas(upload.name, start_area, end_area)
    try:
        loaded = load_unchecked_mission(upload, catalog, start_area, end_area, site)
    except ArgoError as error:
        if error.code == INCOMPLETE:
            raise
        return error_diagnostics(error)
    found = check(loaded.mission, catalog)
    if not has_errors(found):
        poses = len({task.pose for task in loaded.mission.tasks if task.pose is not None})
        if travel is not None and poses > MAX_POSES:
            travel = None
            found += (_too_many_poses(poses),)
        from argo_compiler.analysis import analyse  # late: an incomplete draft needs none

        with stage("analysing the mission's paths"):
            found += analyse(loaded.mission, catalog, travel).diagnostics
        if site is not None:
            found += tuple(not_seen_from_pose_warnings(loaded.mission, site))
            found += tuple(above_own_speed_warnings(loaded.mission, site.robot))
    return by_position((*loaded.diagnostics, *loaded.diagnostics_with_positions(found)))


def _too_many_poses(poses: int) -> Diagnostic:
    return Diagnostic(
        code="analysis.too-many-places",
        severity=Severity.WARNING,
        message=Message(
            "the mission goes to {poses} different poses: its times, its energy and "
            "its paths are not checked, as that is done for at most {max_poses} poses",
            poses=poses,
            max_poses=MAX_POSES,
        ),
        hint=Message("divide it into several missions"),
        subject="tasks",
    )


def error_diagnostics(error: ArgoError) -> tuple[Diagnostic, ...]:
    """Convert an error, raised when a mission was read, to diagnostics."""
    if isinstance(error, DiagnosticError):
        return error.diagnostics
    # The file is named with each diagnostic, so the message does not have to name it.
    file = error if isinstance(error, FileError) else None
    return (
        Diagnostic(
            code="script.unreadable",
            severity=Severity.ERROR,
            message=Message("the file {message}", message=file.message) if file else str(error),
            hint=file.hint if file else None,
            remedies=error.remedies,
        ),
    )


def format_diagnostics(
    diagnostics: tuple[Diagnostic, ...],
    source_name: str,
    format: Format,
    left: "Sequence[DraftLine] | None" = None,
    say: Callable[[str], str] = str,
) -> str:
    """Return the diagnostics as text for people, or as JSON or SARIF.

    JSON has the lines of an incomplete draft that are `left` to decide on as well. `say` puts the
    messages of the text for people into their language.
    """
    match format:
        case Format.JSON:
            return to_json(diagnostics, source_name, left)
        case Format.SARIF:
            return to_sarif(diagnostics, source_name)
        case Format.TEXT:
            text = to_text(diagnostics, source_name, say)
            # The text of several diagnostics ends with their number.
            if len(diagnostics) > 1:
                return text
            return f"{text}\n{source_name}: {say(severity_counts_text(diagnostics))}".lstrip()
