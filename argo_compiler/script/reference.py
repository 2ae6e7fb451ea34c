"""What can be said in a script, read off the grammar and the lexicons, for `docs/script.md`."""

import re
from collections import defaultdict
from collections.abc import Sequence
from importlib.resources import files

from argo_compiler.script.syntax.words.lexicon import Lexicon

BEGIN = "<!-- what can be said: made by `python -m argo_compiler.script docs/script.md` -->"
END = "<!-- end of what can be said -->"

_ALIAS = re.compile(r"\s+->\s+\w+$", re.MULTILINE)
_WITHOUT_MEANING = ("FILLER", "IDLE")
_IN_FIGURES = ("NUMBER_WORD",)
"""terminals with a phrase for every number"""


def as_markdown(lexicons: Sequence[Lexicon]) -> str:
    """The grammar of a sentence, and the words of each language for its terminals."""
    return f"```text\n{grammar_text()}\n```\n\n{words_table(lexicons)}"


def grammar_text() -> str:
    """The rules of a sentence, as the parser has them, without what only the parser needs."""
    text = files("argo_compiler.script.syntax.grammar").joinpath("sentence.lark").read_text("utf-8")
    rules = text[text.index("\n\n") + 2 :]
    return _ALIAS.sub("", rules).replace("// ---- ", "# ").strip()


def words_table(lexicons: Sequence[Lexicon]) -> str:
    """A row for each terminal, with the phrases that stand for it in each language."""
    phrases = [_by_terminal(lexicon) for lexicon in lexicons]
    terminals = list(dict.fromkeys(name for found in phrases for name in found))
    rows = [
        f"| | {' | '.join(lexicon.name for lexicon in lexicons)} |",
        f"|---|{'---|' * len(lexicons)}",
    ]
    for terminal in terminals:
        cells = [", ".join(found.get(terminal, ())).replace("|", "\\|") for found in phrases]
        rows.append(f"| `{terminal}` | {' | '.join(cells)} |")
    return "\n".join(rows)


def _by_terminal(lexicon: Lexicon) -> dict[str, list[str]]:
    found: dict[str, list[str]] = defaultdict(list)
    for (terminal, _), said in lexicon.phrases.items():
        if terminal in _IN_FIGURES:
            continue
        name = "no effect" if terminal in _WITHOUT_MEANING else terminal
        found[name] += said
    return found
