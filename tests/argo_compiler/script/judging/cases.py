"""Scripts with what a careful reader takes them for: NAME.txt beside NAME.json."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
