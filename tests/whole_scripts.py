"""Import of scripts that the grammar takes as they are, without drafts."""

from typing import Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import Resolved, parse, resolve_script


def import_whole(
    text: str, catalog: Catalog, *, source_name: str = "script", **areas: Any
) -> Resolved:
    """Return the mission of a script; raise DiagnosticError if any line is not understood."""
    places = [place.name for place in catalog.places]
    names = [checkpoint.name for checkpoint in catalog.checkpoints]
    return resolve_script(parse(text, places, source_name, names), catalog, **areas)
