"""The words of a language: which phrase is which terminal of the grammar, and what it means."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

Entry = tuple[str, Any]
"""a terminal and its value"""
Phrases = Mapping[Entry, str]
"""by entry, its phrases, separated by bars; `check{s}` is `check` and `checks`"""


@dataclass(slots=True)
class Node:
    """Where a phrase has come to, word by word."""

    entry: Entry | None = None
    next: "dict[str, Node]" = field(default_factory=dict)


class Lexicon:
    """All phrases of a language, found by their first words, the longest first."""

    def __init__(self, name: str, *parts: Phrases) -> None:
        self.name = name
        self.root = Node()
        self.words: set[str] = set()
        self.phrases: dict[Entry, list[str]] = {}
        for part in parts:
            for entry, text in part.items():
                self.add(entry, expand(text))

    def add(self, entry: Entry, phrases: Iterable[str]) -> None:
        """Adds phrases, in lower case; one that is there already must not mean anything else."""
        for phrase in phrases:
            node = self.root
            pieces = phrase.split()
            for piece in pieces:
                node = node.next.setdefault(piece, Node())
            if node.entry not in (None, entry):
                raise ValueError(f"{self.name}: `{phrase}` is {node.entry} and {entry}")
            node.entry = entry
            self.words.update(p for p in pieces if p[0].isalpha())
            self.phrases.setdefault(entry, []).append(phrase)


def expand(text: str) -> list[str]:
    """The phrases that `text` lists: `check{s}` is two, `a|b` are two."""
    found: list[str] = []
    for phrase in text.split("|"):
        forms = [""]
        rest = phrase.strip()
        while rest:
            head, opening, rest = rest.partition("{")
            inner, _, rest = rest.partition("}") if opening else ("", "", "")
            forms = [f + head for f in forms]
            if opening:
                forms += [f + inner for f in forms]
        found += [" ".join(f.split()) for f in forms]
    return found
