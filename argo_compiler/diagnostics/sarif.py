"""Findings as SARIF 2.1.0 (OASIS), which editors and code hosts show beside the source."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from argo_compiler import __version__
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.finding import Diagnostic

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def to_sarif(findings: Sequence[Diagnostic], source_name: str) -> str:
    """A SARIF log of one run with the findings about one file, as a JSON text."""
    codes = sorted({finding.code for finding in findings})
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
                "results": list(_results(findings, codes, _uri(source_name))),
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
    findings: Sequence[Diagnostic], codes: Sequence[str], uri: str
) -> Iterator[dict[str, Any]]:
    index = {code: i for i, code in enumerate(codes)}
    seen: Counter[str] = Counter()
    for finding in findings:
        fingerprint = _fingerprint(finding)
        seen[fingerprint] += 1
        yield {
            "ruleId": finding.code,
            "ruleIndex": index[finding.code],
            "level": finding.severity.value,
            "message": {"text": _message(finding)},
            "locations": [_location(finding, uri)],
            "partialFingerprints": {
                "primaryLocationLineHash": f"{fingerprint}:{seen[fingerprint]}"
            },
        }


def _message(finding: Diagnostic) -> str:
    return f"{finding.message} ({finding.hint})" if finding.hint else finding.message


def _location(finding: Diagnostic, uri: str) -> dict[str, Any]:
    span = finding.span
    region: dict[str, Any] = {"startLine": 1}  # code hosts ask for a region, known or not
    if span:
        region = {
            "startLine": span.line,
            "startColumn": span.column,
            "endLine": span.line,
            "endColumn": span.column + max(1, span.length),
        }
        if finding.excerpt is not None:
            region["snippet"] = {"text": finding.excerpt}
    location: dict[str, Any] = {
        "physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}
    }
    if finding.subject:
        location["logicalLocations"] = [{"fullyQualifiedName": finding.subject}]
    return location


def _fingerprint(finding: Diagnostic) -> str:
    """What stays the same when lines before the finding come and go."""
    line = " ".join((finding.excerpt or finding.message).split())
    return hashlib.sha256(f"{finding.code}\n{line}".encode("utf-8", "replace")).hexdigest()[:16]


def _uri(source_name: str) -> str:
    path = Path(source_name)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())
