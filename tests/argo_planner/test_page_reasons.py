"""The page's German texts for messages about lines: each is for a message that there is."""

import ast
import re
from pathlib import Path

import argo_compiler.script

COMPILER = Path(argo_compiler.script.__file__).parent
REASONS = Path(__file__).parents[2] / "argo_planner" / "page" / "src" / "texts" / "reasons.ts"
PART = "<>"
"""stands for a part of a message that is computed"""


def wording(node: ast.AST) -> str | None:
    """Return the text of a constant or of a formatted one."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(wording(value) or PART for value in node.values)
    return None


def wordings_of_the_compiler() -> set[str]:
    files = sorted(COMPILER.rglob("*.py"))
    nodes = (node for file in files for node in ast.walk(ast.parse(file.read_text("utf-8"))))
    words = (COMPILER / "sentences" / "words" / "english.toml").read_text("utf-8")
    return {text for node in nodes if (text := wording(node))} | set(
        re.findall("'([^'\n]*)'", words)
    )


def pattern_of(key: str) -> re.Pattern[str]:
    """Return the pattern of the wordings that a key of the page stands for."""
    parts = {"{}": "(?:`[^`]*`|<>)", "<>": ".+"}
    return re.compile("".join(parts.get(p) or re.escape(p) for p in re.split(r"({}|<>)", key)))


def test_the_page_translates_messages_that_there_are() -> None:
    """A message that is worded anew needs a new German text."""
    source = REASONS.read_text("utf-8").partition("= {")[2].partition("\n};")[0]
    keys = re.findall(r'^  (?:"([^"]+)"|(\w+)):', source, re.MULTILINE)
    assert len(keys) > 100
    texts = wordings_of_the_compiler()
    joined = "\n".join(texts)
    stale = []
    for key in (quoted or word for quoted, word in keys):
        behind_words = key.removeprefix("{} ")  # a message may begin with the words it is about
        pattern = pattern_of(behind_words)
        whole = any(pattern.fullmatch(text) for text in texts)
        if not whole and not re.search(f"^(?:<>|`.*`) {pattern.pattern}$", joined, re.MULTILINE):
            stale.append(key)
    assert stale == []
