"""The only reader and writer of YAML, by the core schema of YAML 1.2.

In it, `010` is ten, and `1:30`, `yes` and a date are texts. PyYAML alone follows YAML 1.1, in which
these are 8, 90, true and a date.
"""

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import yaml
from yaml.constructor import ConstructorError

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message

Node = yaml.Node
MappingNode = yaml.MappingNode
SequenceNode = yaml.SequenceNode

_TAG = "tag:yaml.org,2002:"
_PLAIN_SCALARS = (
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("bool", r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    ("int", r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", list("-+0123456789")),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"
        r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
    ("merge", "<<", ["<"]),  # no part of the core schema, but common
)
"""tags of the plain scalars that are not text, with their patterns and possible first characters"""
_BASES = {"0o": 8, "0x": 16}
_MOST_MERGED = 100_000
"""fields that all merges of a text repeat at most; a short text can repeat any number"""


class NotYamlError(Exception):
    """Raised when a text is not YAML.

    Attributes:
        line: Line of the error, from 1; None if it is unknown.
        column: Column of the error, from 1; None if it is unknown.
    """

    def __init__(self, message: str, line: int | None = None, column: int | None = None) -> None:
        super().__init__(message)
        self.line = line
        self.column = column


class RepeatedKey(NamedTuple):
    """Key that a mapping has twice."""

    key: str
    node: Node
    """second occurrence of the key"""
    first_line: int
    """line of its first occurrence, from 1"""

    @property
    def message(self) -> str:
        return Message(
            "`{key}` is given twice; it was first given at line {first_line}",
            key=self.key,
            first_line=self.first_line,
        )


class YamlText(NamedTuple):
    """Content of a YAML text."""

    tree: Node | None
    """nodes with their positions; None: the text has no content"""
    repeated_keys: tuple[RepeatedKey, ...]
    data: Any


class _Loader(yaml.SafeLoader):
    """Reader without the plain scalars of YAML 1.1, and with a limit of merged fields."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._merged = 0

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Replace the merges (`<<`) of a mapping by the fields of what they name."""
        for key, value in node.value:
            if key.tag == f"{_TAG}merge":
                # First what is named, whose number of fields is known then.
                for other in value.value if isinstance(value, SequenceNode) else [value]:
                    if isinstance(other, MappingNode):
                        self.flatten_mapping(other)
                        self._merged += len(other.value)
                    if self._merged > _MOST_MERGED:
                        message = Message(
                            "its merges (`<<`) repeat more than {most_merged} fields",
                            most_merged=_MOST_MERGED,
                        )
                        raise ConstructorError(None, None, message, key.start_mark)
        super().flatten_mapping(node)


_Loader.yaml_implicit_resolvers = {}


class _Dumper(yaml.SafeDumper):
    """Writer that quotes each text that YAML 1.1 or 1.2 would read as something else."""


for _name, _pattern, _first in _PLAIN_SCALARS:
    for _class in (_Loader, _Dumper):
        _class.add_implicit_resolver(_TAG + _name, re.compile(rf"(?:{_pattern})\Z"), _first)


def _to_int(text: str) -> int:
    base = _BASES.get(text[:2])
    return int(text) if base is None else int(text[2:], base)


def _construct_int(_: yaml.SafeLoader, node: yaml.ScalarNode) -> int:
    return _to_int(node.value)


def _construct_float(_: yaml.SafeLoader, node: yaml.ScalarNode) -> float:
    return float(re.sub(r"\.(?=[a-z])", "", node.value.lower()))  # `-.inf`, `.nan`


_Loader.add_constructor(f"{_TAG}int", _construct_int)
_Loader.add_constructor(f"{_TAG}float", _construct_float)


def compose_yaml(text: str) -> YamlText:
    """Return the content of a YAML text with the positions. Raises NotYamlError."""
    try:
        loader = _Loader(text)
        try:
            tree = loader.get_single_node()
            # Before the data is constructed, which merges mappings in the tree.
            repeated = tuple(_repeated_keys(tree))
            return YamlText(
                tree, repeated, None if tree is None else loader.construct_document(tree)
            )
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = (mark.line + 1, mark.column + 1) if mark else (None, None)
        raise NotYamlError(
            Message("the file is not YAML: {problem}", problem=error.problem), *place
        ) from None
    except yaml.YAMLError as error:
        raise NotYamlError(Message("the file is not YAML: {error}", error=error)) from None
    except RecursionError:
        raise NotYamlError("the file is not YAML: it is nested too deeply") from None
    except ValueError:
        why = "it has a value that can't be read, such as a number with thousands of digits"
        raise NotYamlError(Message("the file is not YAML: {why}", why=why)) from None


def load_yaml(text: str, source_name: str) -> Any:
    """Return the data in a YAML text; messages call it `source_name`.

    Raises Invalid, with the line, if the text is not YAML or has a key twice.
    """
    try:
        content = compose_yaml(text)
    except NotYamlError as error:
        place = source_name if error.line is None else f"{source_name}:{error.line}:{error.column}"
        raise Invalid(Message("{place}: {error}", place=place, error=error)) from None
    for repeated in content.repeated_keys:
        mark = repeated.node.start_mark
        raise Invalid(
            Message(
                "{source_name}:{line}:{column}: {message}",
                source_name=source_name,
                line=mark.line + 1,
                column=mark.column + 1,
                message=repeated.message,
            )
        )
    return content.data


def dump_yaml(data: Any, *, flow: bool | None = None, width: float = 100) -> str:
    """Return data as YAML in its order; `flow`: in one line, or None for innermost parts only."""
    text: str = yaml.dump(
        data,
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=flow,
        width=width,
    )
    return text


def _repeated_keys(tree: Node | None) -> Iterator[RepeatedKey]:
    """Yield each key that a mapping has twice; YAML parsers silently drop one."""
    pending: list[Any] = [tree]
    seen: set[int] = set()  # aliases lead to the same node again
    while pending:
        node = pending.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, SequenceNode):
            pending += node.value
        elif isinstance(node, MappingNode):
            lines: dict[str, int] = {}
            for key, value in node.value:
                pending.append(value)
                if isinstance(key, yaml.ScalarNode) and key.value != "<<":
                    name = _key_text(key)
                    if name in lines:
                        yield RepeatedKey(key.value, key, lines[name])
                    lines.setdefault(name, key.start_mark.line + 1)


def _key_text(key: yaml.ScalarNode) -> str:
    """Return the same text for the keys that readers confuse: `10`, `010` and `"10"`."""
    return str(_to_int(key.value)) if key.tag == f"{_TAG}int" else key.value
