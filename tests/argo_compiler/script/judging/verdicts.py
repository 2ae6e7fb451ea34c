"""Verdicts on scripts: what the front end makes of each, and what a careful reader takes it for.

That lies beside it: NAME.txt has the script, NAME.json what it has to become.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from argo_compiler.analysis import analyse
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError
from argo_compiler.checks import check
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.il import Mission
from tests.argo_compiler.script.judging.driving import Drive
from tests.argo_compiler.script.judging.requirements import compare_header, compare_requirements
from tests.argo_compiler.script.judging.traces import compare
from tests.whole_scripts import import_whole

KEYS = {
    "persona", "features", "verdict", "line", "mentions", "or_warn", "header", "traces",
    "requirements", "options", "note",
}  # fmt: skip
HEADER_KEYS = {"max_duration_s", "start_area", "end_area", "order", "mode", "start_place"}
TRACE_KEYS = {
    "values", "events", "fails", "action_s", "expect", "expect_any", "expect_set", "times",
    "tolerance_s", "waits", "note",
}  # fmt: skip
REQUIREMENT_KEYS = {"optional", "priority", "window", "battery_below", "speed", "before"}


@dataclass(frozen=True)
class Case:
    """A script and what is expected of it."""

    name: str
    text: str
    expectation: dict[str, Any]

    @property
    def lines(self) -> tuple[int, ...]:
        """The lines at which an error or a warning may stand."""
        line = self.expectation.get("line")
        return () if line is None else tuple(line) if isinstance(line, list) else (line,)


def load(folder: Path) -> list[Case]:
    """All cases of a folder, by name. Raises ValueError where an expectation is malformed."""
    cases = []
    for path in sorted(folder.glob("*.txt")):
        expectation = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        case = Case(path.stem, path.read_bytes().decode("utf-8"), expectation)
        _require_form(case)
        cases.append(case)
    return cases


def _require_form(case: Case) -> None:
    e = case.expectation
    traces = e.get("traces", ())
    unknown = set(e) - KEYS
    unknown |= set(e.get("header", {})) - HEADER_KEYS
    unknown |= set(e.get("requirements", {})) - REQUIREMENT_KEYS
    unknown |= set().union(*traces) - TRACE_KEYS
    if unknown:
        raise ValueError(f"{case.name}: unknown keys {sorted(unknown)}")
    if any(sum(k in t for k in ("expect", "expect_any", "expect_set")) != 1 for t in traces):
        raise ValueError(f"{case.name}: a trace has one of expect, expect_any, expect_set")
    if e["verdict"] not in ("import", "warn", "refuse"):
        raise ValueError(f"{case.name}: verdict {e['verdict']}")
    if e["verdict"] != "import" and not case.lines:
        raise ValueError(f"{case.name}: a line is missing")
    if e["verdict"] != "refuse" and not traces:
        raise ValueError(f"{case.name}: traces are missing")


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
        resolved = import_whole(text, catalog, source_name="script", **options)
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
