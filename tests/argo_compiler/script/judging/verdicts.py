"""How a script fares: what the front end makes of it, against what it has to become."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from argo_compiler.analysis import analyse
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError
from argo_compiler.checks import check
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.il import Mission
from argo_compiler.script import import_script
from tests.argo_compiler.script.judging.cases import Case
from tests.argo_compiler.script.judging.driving import Drive
from tests.argo_compiler.script.judging.requirements import compare_header, compare_requirements
from tests.argo_compiler.script.judging.traces import compare


class Kind(StrEnum):
    """How a script fared."""

    RIGHT = "right"
    SILENT = "silently wrong"
    WARNED = "wrong despite a warning"
    REFUSED = "refused though it should import"
    IMPORTED = "imported though it should be refused"
    PLACE = "wrong place or words"
    CRASHED = "exception"


@dataclass(frozen=True)
class Finding:
    """What the front end has to say: an error or a warning, with its place."""

    refuses: bool
    warns: bool
    line: int | None
    text: str
    """message, hint and the source line that it points at"""

    def names(self, words: Sequence[str]) -> bool:
        """Whether all the words are in it, whatever their case and spaces."""
        return all(_plain(word) in _plain(self.text) for word in words)


@dataclass(frozen=True)
class Result:
    """How a script fared, and why."""

    name: str
    kind: Kind
    why: str = ""


def judge(case: Case, catalog: Catalog) -> Result:
    """How a script fares; whatever is raised on the way is a failure of it."""
    try:
        return _judge(case, catalog)
    except Exception as error:  # an importer must not raise anything else; a judge must go on
        return Result(case.name, Kind.CRASHED, f"{type(error).__name__}: {str(error)[:300]}")


def _judge(case: Case, catalog: Catalog) -> Result:
    e = case.expectation
    mission, findings = front_end(case.text, catalog, e.get("options", {}))
    errors = [f for f in findings if f.refuses]
    warnings = [f for f in findings if f.warns]
    refused = mission is None or bool(errors)
    if e["verdict"] == "refuse" and (refused or not (warnings and e.get("or_warn"))):
        return _judge_refusal(case, errors)
    if refused:
        return Result(case.name, Kind.REFUSED, errors[0].text if errors else "no mission")
    differences = list(compare_header(e.get("header", {}), mission, catalog))
    driven = [Drive(mission, catalog, trace).run() for trace in e["traces"]]
    found = (compare(trace, steps) for trace, steps in zip(e["traces"], driven, strict=True))
    differences += [difference for difference in found if difference]
    if driven:
        differences += compare_requirements(e.get("requirements", {}), mission, driven[0])
    if differences:
        return Result(case.name, Kind.WARNED if warnings else Kind.SILENT, "; ".join(differences))
    wanted = e.get("mentions", ())
    if e["verdict"] == "import" or any(f.line in case.lines and f.names(wanted) for f in warnings):
        return Result(case.name, Kind.RIGHT)
    return Result(case.name, Kind.PLACE, f"no warning in line {e['line']} that names {wanted}")


def _judge_refusal(case: Case, errors: Sequence[Finding]) -> Result:
    wanted = case.expectation.get("mentions", ())
    if not errors:
        return Result(case.name, Kind.IMPORTED, "no error")
    if not any(f.line in case.lines and f.names(wanted) for f in errors):
        why = f"no error in line {case.expectation['line']} that names {wanted}"
        return Result(case.name, Kind.PLACE, why)
    elsewhere = sorted({f.line for f in errors if f.line is not None} - set(case.lines))
    if elsewhere:
        return Result(case.name, Kind.PLACE, f"lines {elsewhere} are refused as well")
    return Result(case.name, Kind.RIGHT)


def front_end(
    text: str, catalog: Catalog, options: dict[str, Any]
) -> tuple[Mission | None, list[Finding]]:
    """Imports a script, checks it and analyses its paths."""
    lines = text.splitlines()
    try:
        resolved = import_script(text, catalog, source_name="script", **options)
    except DiagnosticError as error:
        return None, [_finding(d, lines) for d in error.diagnostics]
    except ArgoError as error:
        return None, [Finding(refuses=True, warns=False, line=None, text=str(error))]
    said = [*resolved.diagnostics, *check(resolved.mission, catalog)]
    if not any(d.severity is Severity.ERROR for d in said):
        said += analyse(resolved.mission, catalog).diagnostics
    return resolved.mission, [_finding(d, lines) for d in said]


def _finding(diagnostic: Diagnostic, lines: Sequence[str]) -> Finding:
    line = None if diagnostic.span is None else diagnostic.span.line
    source = lines[line - 1] if line is not None and 0 < line <= len(lines) else ""
    text = " ".join(part for part in (diagnostic.message, diagnostic.hint, source) if part)
    severity = diagnostic.severity
    return Finding(severity is Severity.ERROR, severity is Severity.WARNING, line, text)


def _plain(text: str) -> str:
    return " ".join(text.casefold().split())
