"""Diagnostics as JSON, for other programs. The shape is documented in `docs/diagnostics.md`."""

import json
from collections.abc import Sequence
from typing import Any

from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import Diagnostic, count

VERSION = 1
"""of this shape"""


def to_json(diagnostics: Sequence[Diagnostic], source_name: str) -> str:
    """The diagnostics and how many there are, as a JSON text."""
    data = {
        "version": VERSION,
        "source": source_name,
        "errors": count(diagnostics, Severity.ERROR),
        "warnings": count(diagnostics, Severity.WARNING),
        "notes": count(diagnostics, Severity.NOTE),
        "diagnostics": [_entry(diagnostic) for diagnostic in diagnostics],
    }
    return json.dumps(data, indent=2, ensure_ascii=False)


def _entry(diagnostic: Diagnostic) -> dict[str, Any]:
    return diagnostic.model_dump(mode="json", include=_FIELDS)


_FIELDS = {"code", "severity", "message", "span", "excerpt", "hint", "subject"}
