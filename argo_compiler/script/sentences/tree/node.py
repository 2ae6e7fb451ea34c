"""What all parts of the tree have."""

from dataclasses import dataclass, fields
from typing import ClassVar, TypeVar, dataclass_transform

from argo_compiler.diagnostics import Span

_Node = TypeVar("_Node", bound="Node")


@dataclass_transform(frozen_default=True, kw_only_default=True)
def node(part: type[_Node]) -> type[_Node]:
    """Make a class of the tree: a dataclass with slots, made by keywords, and frozen for mypy.

    How nodes compare, hash and print is their base's: Python compiles it for each dataclass anew
    when its module is imported, and so it does what would refuse a change. That would be 4 % of the
    time of `argo check`.
    """
    made = dataclass(slots=True, kw_only=True, eq=False, repr=False)(part)
    made.field_names = tuple(field.name for field in fields(made))
    return made


@node
class Node:
    """A part of the tree; `span` is where its text begins and how far it goes."""

    field_names: ClassVar[tuple[str, ...]]
    """of the class, its bases' included"""
    span: Span

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Node) or other.__class__ is not self.__class__:
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def __repr__(self) -> str:
        named = zip(self.field_names, self._values(), strict=True)
        return f"{self.__class__.__qualname__}({', '.join(f'{n}={v!r}' for n, v in named)})"

    def _values(self) -> tuple[object, ...]:
        return tuple([getattr(self, name) for name in self.field_names])
