"""Syntax trees of the project's modules, for tests that read its source."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("argo_compiler", "argo_env", "argo_planner", "baselines")
# Written into exported behaviours, and imported by FlexBE only.
_EXPORTED = ROOT / "argo_compiler" / "export" / "flexbe_states"


@cache
def trees() -> dict[Path, ast.Module]:
    """Return the syntax tree of each module by its path in the repository."""
    return {
        path.relative_to(ROOT): ast.parse(path.read_text(encoding="utf-8"))
        for package in PACKAGES
        for path in sorted((ROOT / package).rglob("*.py"))
        if _EXPORTED not in path.parents
    }
