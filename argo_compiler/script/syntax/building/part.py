"""A rule's part of a sentence while its node is made."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from argo_compiler.diagnostics import Span
from argo_compiler.script.syntax.text.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.words.word import Word

T = TypeVar("T")


@dataclass(slots=True)
class RulePart:
    """What the parts of a rule were made to, and where the rule's words stand. Not frozen, for
    there are very many, and they are made faster so; nothing changes one."""

    children: tuple[Any, ...]
    """nodes, and the words that the grammar has by themselves"""
    text: ScriptText
    start: int
    end: int
    """indices in the text, of the first character and behind the last"""
    diagnostics: Diagnostics

    @property
    def span(self) -> Span:
        return self.text.span(self.start, self.end)

    @property
    def said(self) -> str:
        return self.text.content[self.start : self.end]

    def word(self, *types: str) -> Word | None:
        """The first word of one of the types."""
        for child in self.children:
            if type(child) is Word and child.type in types:
                return child
        return None

    def the_word(self, *types: str) -> Word:
        """The word of one of the types, which the grammar asks for."""
        found = self.word(*types)
        assert found is not None, f"the grammar lets {types} be left out"
        return found

    def has(self, *types: str) -> bool:
        return self.word(*types) is not None

    def every(self, type_: type[T]) -> tuple[T, ...]:
        return tuple([child for child in self.children if isinstance(child, type_)])

    def joined(self, type_: type[Iterable[Any]]) -> tuple[Any, ...]:
        """What is in the children of a type, which have several things each."""
        return tuple([one for child in self.every(type_) for one in child])

    def first(self, type_: type[T]) -> T | None:
        for child in self.children:
            if isinstance(child, type_):
                return child
        return None

    def the(self, type_: type[T]) -> T:
        """The one child of the type, which the grammar asks for."""
        found = self.first(type_)
        assert found is not None, f"the grammar lets {type_.__name__} be left out"
        return found

    def error(self, code: str, message: str, hint: str) -> None:
        self.diagnostics.error(code, message, self.span, hint)


Make = Callable[[RulePart], Any]
"""makes the node of a rule"""
