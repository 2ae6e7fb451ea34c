"""Diagnostics as JSON, for other programs. `docs/diagnostics.md` documents the format."""

import json
from collections.abc import Sequence
from typing import Any

from argo_compiler.base.model import Model
from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import Diagnostic, count

VERSION = 1
"""version of this format"""


def to_json(
    diagnostics: Sequence[Diagnostic], source_name: str, left: Sequence[Model] | None = None
) -> str:
    """Return the diagnostics and their numbers by severity as JSON text.

    `left` are the lines of a draft that are left to decide on; None for what is no draft.
    """
    data = {
        "version": VERSION,
        "source": source_name,
        "errors": count(diagnostics, Severity.ERROR),
        "warnings": count(diagnostics, Severity.WARNING),
        "notes": count(diagnostics, Severity.NOTE),
        "diagnostics": [_entry(diagnostic) for diagnostic in diagnostics],
    }
    if left is not None:
        data["left"] = [line.model_dump(mode="json") for line in left]
    return json.dumps(data, indent=2, ensure_ascii=False)


def _entry(diagnostic: Diagnostic) -> dict[str, Any]:
    return diagnostic.model_dump(mode="json", include=_FIELDS)


_FIELDS = {"code", "severity", "message", "span", "excerpt", "hint", "subject"}
