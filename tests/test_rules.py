"""Each rule of docs/language.md has a test that names it."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def carried(path):
    """Yield the ids in the markers `pytest.mark.rule(...)` of a test file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "pytest.mark.rule":
            yield from (ast.literal_eval(argument) for argument in node.args)


def test_every_rule_has_a_test_and_every_marker_a_rule():
    page = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
    rules = re.findall(r"^- \*\*([A-Z]\d+)\*\*", page, re.MULTILINE)
    assert rules
    assert len(rules) == len(set(rules))
    found = {id for path in (ROOT / "tests").rglob("test_*.py") for id in carried(path)}
    assert found == set(rules)
