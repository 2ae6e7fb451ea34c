"""Templates of messages, found in the source without running it."""

import ast
import string
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

SINKS = frozenset(
    [
        *("diagnostic", "diagnostic_of", "conflict", "invalid", "_conflict"),
        *("refuse", "error", "warning"),
    ]
)
"""functions whose text arguments are messages"""


@dataclass(frozen=True)
class Template:
    """Template of a message and the place where it is."""

    text: str
    fields: frozenset[str]
    """names of the parameters that are given; those of the template must be the same"""
    place: str


def name_of(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def templates(path: Path) -> Iterator[Template]:
    """Yield the templates in a file: literals given to `Message` and to the functions of SINKS."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or _is_log(node):
            continue
        if name_of(node.func) == "Message" and node.args:
            text = node.args[0]
            if not (isinstance(text, ast.Constant) and isinstance(text.value, str)):
                continue
            fields = frozenset(keyword.arg or "**" for keyword in node.keywords)
            yield Template(text.value, fields, f"{path}:{node.lineno}")
        elif name_of(node.func) in SINKS or is_error(node):
            for text in (*node.args, *(k.value for k in node.keywords if k.arg in _TEXTS)):
                for literal in _literals(text):
                    if is_message(literal):
                        yield Template(literal, frozenset(), f"{path}:{text.lineno}")


def _is_log(node: ast.Call) -> bool:
    function = node.func
    return isinstance(function, ast.Attribute) and name_of(function.value) in ("_log", "log")


_TEXTS = ("message", "hint", "detail", "reason", "problem")


def is_error(node: ast.Call) -> bool:
    """Return True if a call makes an error of Argo with a message."""
    return name_of(node.func) in ERRORS


ERRORS = frozenset(
    [
        *("Invalid", "NotFound", "Conflict", "Unavailable", "Unreachable", "ArgoError"),
        *("LimitExceeded", "RevisionMissing", "AccessDenied", "TokenMissing", "TooLarge"),
        *("StaleRevision", "CommandIdTaken", "NothingToUndo", "ChangedSince", "EditRefused"),
        *("PlanTooLarge", "IncompleteDraft", "PoorViewError"),
        *("MissingFile", "UnreadableFile"),
    ]
)
"""classes of errors whose argument is a message"""


def is_message(text: str) -> bool:
    """Return True if a literal has words for people, unlike codes, subjects and names of fields."""
    return " " in text.strip()


def _literals(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.IfExp):
        yield from _literals(node.body)
        yield from _literals(node.orelse)


def fields_of(template: str) -> frozenset[str]:
    """Return the names of the fields in a template."""
    return frozenset(name for _, name, _, _ in string.Formatter().parse(template) if name)


def has_words(template: str) -> bool:
    """Return True if a template has letters outside its fields, so that languages differ."""
    parts = (literal for literal, *_ in string.Formatter().parse(template))
    return any(char.isalpha() for part in parts for char in part)


def formats_of(template: str) -> dict[str, str]:
    """Return the formats of the fields in a template by their names."""
    parts = string.Formatter().parse(template)
    return {name: spec or "" for _, name, spec, _ in parts if name}


def is_composed(node: ast.AST) -> bool:
    """Return True if a call makes an error or a diagnostic with a text that is not a literal part.

    Such a text is an f-string with words: it has to be a `Message`.
    """
    if not isinstance(node, ast.Call) or not (name_of(node.func) in SINKS or is_error(node)):
        return False
    return any(isinstance(text, ast.JoinedStr) and _has_space(text) for text in node.args)


def _has_space(text: ast.JoinedStr) -> bool:
    parts = [part.value for part in text.values if isinstance(part, ast.Constant)]
    return any(" " in part for part in parts)
