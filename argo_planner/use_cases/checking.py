"""All that is wrong or odd about a mission, without running it."""

from enum import StrEnum

from argo_compiler.analysis import Travel, analyse
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.stages import stage
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    Severity,
    by_position,
    has_errors,
    summary,
    to_json,
    to_sarif,
    to_text,
)
from argo_compiler.files.loading import FileError
from argo_env.planning.opening import OpenedSite
from argo_env.planning.site_warnings import too_fast, unseen_from_poses
from argo_planner.use_cases.importing import SourceKind, Upload, kind_of, load, refuse_areas

MOST_PLACES = 1_000
"""as far as ways to different places are planned for a check: each takes some milliseconds"""


class Format(StrEnum):
    """How diagnostics are written."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"


def check_source(
    upload: Upload,
    catalog: Catalog,
    start_area: int | None = None,
    end_area: int | None = None,
    travel: Travel | None = None,
    site: OpenedSite | None = None,
) -> tuple[Diagnostic, ...]:
    """The diagnostics of every stage that the mission gets through, by place.

    Without `travel`, nothing is said about times, and without a `site` nothing about what is seen
    from where. Raises Invalid where areas are chosen for what
    has them already.
    """
    if kind_of(upload) is not SourceKind.SCRIPT:
        refuse_areas(upload.name, start_area, end_area)
    try:
        loaded = load(upload, catalog, start_area, end_area)
    except ArgoError as error:
        return diagnostics_of(error)
    found = check(loaded.mission, catalog)
    if not has_errors(found):
        places = len({task.pose for task in loaded.mission.tasks if task.pose is not None})
        if travel is not None and places > MOST_PLACES:
            travel = None
            found += (_too_many_places(places),)
        with stage("analysing the mission's paths"):
            found += analyse(loaded.mission, catalog, travel).diagnostics
        if site is not None:
            found += tuple(unseen_from_poses(loaded.mission, site))
            found += tuple(too_fast(loaded.mission, site.robot))
    return by_position((*loaded.diagnostics, *loaded.placed(found)))


def _too_many_places(places: int) -> Diagnostic:
    return Diagnostic(
        code="analysis.too-many-places",
        severity=Severity.WARNING,
        message=f"the mission goes to {places} different places: nothing is said about its times, "
        f"its energy and whether the robot gets there, as that is looked at for up to "
        f"{MOST_PLACES} places",
        hint="divide it into several missions",
        subject="tasks",
    )


def diagnostics_of(error: ArgoError) -> tuple[Diagnostic, ...]:
    """What is wrong with a mission that could not be read, as diagnostics."""
    if isinstance(error, DiagnosticError):
        return error.diagnostics
    # Where the file is named beside it, the message need not name it again.
    file = error if isinstance(error, FileError) else None
    return (
        Diagnostic(
            code="script.unreadable",
            severity=Severity.ERROR,
            message=file.message if file else str(error),
            hint=file.hint if file else None,
        ),
    )


def write_diagnostics(diagnostics: tuple[Diagnostic, ...], source_name: str, format: Format) -> str:
    """The diagnostics as text for people, or as JSON or SARIF."""
    match format:
        case Format.JSON:
            return to_json(diagnostics, source_name)
        case Format.SARIF:
            return to_sarif(diagnostics, source_name)
        case Format.TEXT:
            text = to_text(diagnostics, source_name)
            # Of several diagnostics it says by itself how many there are.
            if len(diagnostics) > 1:
                return text
            return f"{text}\n{source_name}: {summary(diagnostics)}".lstrip()
