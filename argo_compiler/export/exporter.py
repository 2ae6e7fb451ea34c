"""What an exporter is, and how it refuses what its target can't say."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Span, diagnostic_of
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Mission, Reaction, Response

Exported = str | bytes | Mapping[str, bytes]
"""The text or the bytes of one file, or the files of a folder by their path in it."""


@dataclass(frozen=True, slots=True)
class Exporter:
    """A format that a machine can be written in."""

    description: str
    """a few words for people"""
    suffixes: tuple[str, ...]
    """what the file's name ends with, the usual one first; none where a folder is written"""
    export: Callable[[Mission, Hfsm], Exported]
    """raises DiagnosticError with a diagnostic for each thing that the format can't say"""


def refusal(
    code: str, message: str, hint: str | None = None, span: Span | None = None
) -> Diagnostic:
    """Says that the target can't say something of the mission; `code` without `export.`."""
    return diagnostic_of(f"export.{code}", message, hint, span=span)


def level_refusals(reactions: Iterable[Reaction]) -> Iterator[Diagnostic]:
    """Refuses reactions that only report a level of the battery: nothing else tells the robot which
    level that is."""
    for reaction in reactions:
        if reaction.response is Response.REPORT and reaction.battery_below is not None:
            yield refusal(
                "reaction",
                f"the reaction to '{reaction.event}' reports a level of the battery, which can't "
                "be said here",
                "leave the reaction out, and let the robot report its battery",
                reaction.source,
            )


def refuse(diagnostics: Iterable[Diagnostic]) -> None:
    """Raises DiagnosticError if there are diagnostics."""
    found = tuple(diagnostics)
    if found:
        raise DiagnosticError("mission", found)
