"""The words of the code: how docstrings begin."""

import ast
import re
import tomllib

from tests.processes import ROOT

FOLDERS = ("argo_compiler", "argo_env", "argo_planner", "baselines", "benchmarks", "tests", ".ci")
RIDDLE = re.compile(r'"""(?:What|How|Where|Whether|Which|Of|One|None|That)\b')
"""a docstring whose first word leaves open what a function does"""
RUFF = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["ruff"]["lint"]
UNFINISHED = tuple(
    pattern.removesuffix("**")
    for pattern, rules in RUFF["per-file-ignores"].items()
    if "D4" in rules
)
"""folders whose docstrings are still to be put into plain words"""


def suspects():
    """Yield the files of finished folders with a text that begins with such a word."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if "node_modules" in name or name.startswith(UNFINISHED):
                continue
            text = path.read_text(encoding="utf-8")
            if RIDDLE.search(text):
                yield name, ast.parse(text)


def test_no_docstring_begins_with_a_riddle():
    riddles = [
        f"{name}:{node.lineno}: {node.name}: {docstring.splitlines()[0]}"
        for name, tree in suspects()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (docstring := ast.get_docstring(node))
        and RIDDLE.match(f'"""{docstring}')
    ]
    assert not riddles, "\n".join(["say what the function does:", *riddles])
