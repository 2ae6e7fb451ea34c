"""Diagnostics as SARIF 2.1.0 (OASIS), which editors and code hosts show next to the source."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from argo_compiler.base.version import __version__
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.diagnostic import Diagnostic

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def to_sarif(diagnostics: Sequence[Diagnostic], source_name: str) -> str:
    """Return a SARIF log with the diagnostics about one file, as JSON text."""
    codes = sorted({diagnostic.code for diagnostic in diagnostics})
    log = {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "argo",
                        "version": __version__,
                        "semanticVersion": __version__,
                        "rules": [_rule(code) for code in codes],
                    }
                },
                "columnKind": "unicodeCodePoints",
                "results": list(_results(diagnostics, codes, _uri(source_name))),
            }
        ],
    }
    return json.dumps(log, indent=2, ensure_ascii=False)


def _rule(code: str) -> dict[str, Any]:
    rule = CODES.get(code)
    if rule is None:
        return {"id": code}
    return {
        "id": code,
        "name": "".join(part.capitalize() for part in code.replace(".", "-").split("-")),
        "shortDescription": {"text": rule.meaning},
        "fullDescription": {"text": rule.meaning},
        "help": {"text": rule.remedy, "markdown": rule.remedy},
        "defaultConfiguration": {"level": rule.severity.value},
    }


def _results(
    diagnostics: Sequence[Diagnostic], codes: Sequence[str], uri: str
) -> Iterator[dict[str, Any]]:
    index = {code: i for i, code in enumerate(codes)}
    occurrences: Counter[str] = Counter()
    for diagnostic in diagnostics:
        fingerprint = _fingerprint(diagnostic)
        occurrences[fingerprint] += 1
        yield {
            "ruleId": diagnostic.code,
            "ruleIndex": index[diagnostic.code],
            "level": diagnostic.severity.value,
            "message": {"text": _message(diagnostic)},
            "locations": [_location(diagnostic, uri)],
            "partialFingerprints": {
                "primaryLocationLineHash": f"{fingerprint}:{occurrences[fingerprint]}"
            },
        }


def _message(diagnostic: Diagnostic) -> str:
    return f"{diagnostic.message} ({diagnostic.hint})" if diagnostic.hint else diagnostic.message


def _location(diagnostic: Diagnostic, uri: str) -> dict[str, Any]:
    span = diagnostic.span
    region: dict[str, Any] = {"startLine": 1}  # code hosts require a region even if it is unknown
    if span and diagnostic.place is None:
        region = {
            "startLine": span.line,
            "startColumn": span.column,
            "endLine": span.line,
            "endColumn": span.column + max(1, span.length),
        }
        if diagnostic.excerpt is not None:
            region["snippet"] = {"text": diagnostic.excerpt}
    location: dict[str, Any] = {
        "physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}
    }
    if name := diagnostic.place or diagnostic.subject:
        location["logicalLocations"] = [{"fullyQualifiedName": name}]
    return location


def _fingerprint(diagnostic: Diagnostic) -> str:
    """Return a hash by which a code host recognises the diagnostic after other lines changed.

    It depends on the code and the source line, or on the message if there is no excerpt.
    """
    line = " ".join((diagnostic.excerpt or diagnostic.message).split())
    return hashlib.sha256(f"{diagnostic.code}\n{line}".encode("utf-8", "replace")).hexdigest()[:16]


def _uri(source_name: str) -> str:
    path = Path(source_name)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())
