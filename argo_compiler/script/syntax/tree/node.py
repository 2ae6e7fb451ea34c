"""What all parts of the tree have."""

from dataclasses import dataclass

from argo_compiler.diagnostics import Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """A part of the tree; `span` is where its text begins and how far it goes."""

    span: Span
