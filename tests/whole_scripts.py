"""Import of scripts that have to be understood whole."""

from dataclasses import dataclass
from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.il import Mission
from argo_compiler.script import import_script


@dataclass(frozen=True)
class Whole:
    """A mission and the diagnostics of its script."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...]


def import_whole(text: str, catalog: Catalog, **options: Any) -> Whole:
    """Return the mission of a script; raise DiagnosticError if anything of it is left to decide."""
    draft = import_script(text, catalog, **options)
    if draft.mission is None:
        raise DiagnosticError(draft.source_name, draft.diagnostics)
    return Whole(draft.mission, draft.diagnostics)
