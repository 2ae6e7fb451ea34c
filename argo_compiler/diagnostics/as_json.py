"""Findings as JSON, for other programs. The shape is documented in `docs/diagnostics.md`."""

import json
from collections.abc import Sequence
from typing import Any

from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.finding import Diagnostic, count

VERSION = 1
"""of this shape"""


def to_json(findings: Sequence[Diagnostic], source_name: str) -> str:
    """The findings and how many there are, as a JSON text."""
    data = {
        "version": VERSION,
        "source": source_name,
        "errors": count(findings, Severity.ERROR),
        "warnings": count(findings, Severity.WARNING),
        "diagnostics": [_entry(finding) for finding in findings],
    }
    return json.dumps(data, indent=2, ensure_ascii=False)


def _entry(finding: Diagnostic) -> dict[str, Any]:
    return finding.model_dump(mode="json", include=_FIELDS)


_FIELDS = {"code", "severity", "message", "span", "excerpt", "hint", "subject"}
