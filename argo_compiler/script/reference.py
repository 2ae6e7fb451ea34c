"""What can be said in a script, read off the grammar and the words, for `docs/script.md`."""

import re
from collections.abc import Sequence
from importlib.resources import files

from argo_compiler.script.syntax.words.loading import shown_words

BEGIN = "<!-- what can be said: made by `python -m argo_compiler.script docs/script.md` -->"
END = "<!-- end of what can be said -->"

_ALIAS = re.compile(r"\s+->\s+\w+$", re.MULTILINE)
_TITLES = {
    "verbs": "Words for orders",
    "nouns": "Words for checkpoints, places and steps",
    "conditions": "Words for conditions and events",
    "manners": "Words for how, when and how often",
    "figures": "Words for numbers, times and units",
    "joints": "Words that join",
    "nothing": "Words that add nothing",
    "own": "Words that only one language needs",
}
"""of the groups of words, by their names in a language's file"""


def as_markdown(languages: Sequence[str]) -> str:
    """How sentences are put together, and the words of each language."""
    parts = [_folded("How sentences are put together", f"```text\n{grammar_text()}\n```")]
    words = [shown_words(language) for language in languages]
    for group, title in _TITLES.items():
        rows = [
            f"| | {' | '.join(language.capitalize() for language in languages)} |",
            f"|---|{'---|' * len(languages)}",
        ]
        said = [found.get(group, {}) for found in words]
        for name in dict.fromkeys(name for found in said for name in found):
            cells = [found.get(name, "").replace("|", "\\|") for found in said]
            rows.append(f"| {name} | {' | '.join(cells)} |")
        parts.append(_folded(title, "\n".join(rows)))
    return "\n\n".join(parts)


def grammar_text() -> str:
    """The rules of a sentence, as the parser has them, without what only the parser needs."""
    text = files("argo_compiler.script.syntax.grammar").joinpath("sentence.lark").read_text("utf-8")
    rules = text[text.index("\n\n") + 2 :]
    return _ALIAS.sub("", rules).replace("// ---- ", "# ").strip()


def _folded(title: str, text: str) -> str:
    """A part of the page that opens when it is asked for."""
    return f"<details><summary>{title}</summary>\n\n{text}\n\n</details>"
