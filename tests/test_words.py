"""The words of the code: how docstrings begin."""

import re
import tomllib

from tests.processes import ROOT

FOLDERS = ("argo_compiler", "argo_env", "argo_planner", "baselines", "benchmarks", "tests", ".ci")
RIDDLE = re.compile(
    r'^ *r?"""(?:What|How|Where|Whether|Which|Who|Why|Of|One|None|That|Those)\b.*', re.MULTILINE
)
"""a docstring whose first word leaves open what it describes"""
RUFF = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["ruff"]["lint"]
UNFINISHED = tuple(
    pattern.removesuffix("**")
    for pattern, rules in RUFF["per-file-ignores"].items()
    if "D4" in rules
)
"""folders whose docstrings are still to be put into plain words"""


def test_no_docstring_begins_with_a_riddle():
    """This includes docstrings of attributes and constants."""
    riddles = [
        f"{path.relative_to(ROOT)}: {found.group().strip()}"
        for folder in FOLDERS
        for path in sorted((ROOT / folder).rglob("*.py"))
        if "node_modules" not in path.parts
        and not path.relative_to(ROOT).as_posix().startswith(UNFINISHED)
        for found in RIDDLE.finditer(path.read_text(encoding="utf-8"))
    ]
    assert not riddles, "\n".join(["say what it is or does:", *riddles])
