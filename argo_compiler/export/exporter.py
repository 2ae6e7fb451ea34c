"""Description of an exporter, and the errors for what its format can't express."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from argo_compiler.base.model import Model, Pose
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Span, diagnostic_of
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Mission, Reaction, Response

Exported = str | bytes | Mapping[str, bytes]
"""Text or bytes of one file, or contents of a folder's files by their paths in the folder."""


class InspectionView(Model):
    """View of a checkpoint: the robot's pose, the target point, and the checkpoint's name."""

    pose: Pose
    target: tuple[float, float, float]
    """point in m, in the site's frame"""
    name: str = ""


def no_views() -> Mapping[str, InspectionView]:
    """Return no views, for exports without a site."""
    return {}


@dataclass(frozen=True, slots=True)
class ExportInput:
    """Mission to export, with its machine and what an exporter may ask about the site."""

    mission: Mission
    machine: Hfsm
    find_views: Callable[[], Mapping[str, InspectionView]] = no_views
    """computes the view from which the robot reads each checkpoint that the mission measures, by
    the checkpoint's `object_id`; raises Unreachable if it can't read one"""


@dataclass(frozen=True, slots=True)
class Exporter:
    """A format that a machine can be written in.

    A package offers one by an entry point in the group `argo.exporters`.
    """

    description: str
    """short description for people"""
    suffixes: tuple[str, ...]
    """endings of the file's name, the usual one first; empty if the exporter writes a folder"""
    export: Callable[[ExportInput], Exported]
    """exports a mission; raises DiagnosticError with a diagnostic for each part of
    the mission that the format can't express"""


def refusal(
    code: str, message: str, hint: str | None = None, span: Span | None = None
) -> Diagnostic:
    """Return the diagnostic for a part of the mission that an export format can't express.

    `code` is given without its prefix `export.`.
    """
    return diagnostic_of(f"export.{code}", message, hint, span=span)


def battery_level_report_refusals(reactions: Iterable[Reaction]) -> Iterator[Diagnostic]:
    """Yield a refusal for each reaction that only reports a battery level.

    This is for formats that have no place for the level: the robot would not know at which charge
    of its battery to report.
    """
    for reaction in reactions:
        if reaction.response is Response.REPORT and reaction.battery_below is not None:
            yield refusal(
                "reaction",
                f"the reaction to '{reaction.event}' only reports a battery level, which this "
                "format can't express",
                "remove the reaction, and let the robot report its battery level",
                reaction.source,
            )


def raise_refusals(refusals: Iterable[Diagnostic]) -> None:
    """Raise DiagnosticError with all the refusals, unless there are none.

    A refusal is a diagnostic for a part of the mission that the format can't express.
    """
    diagnostics = tuple(refusals)
    if diagnostics:
        raise DiagnosticError("mission", diagnostics)
