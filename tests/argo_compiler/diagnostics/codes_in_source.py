"""Which codes the source can give to a finding, found by reading it.

A function that makes a `Diagnostic` with a code from one of its parameters passes codes on, and so
does one that calls such a function with a parameter of its own. What they are called with, in the
same part of a package, are the codes.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

from tests.source import trees

SHARED = frozenset(["diagnostic_of", "parse_yaml", "refusal"])
"""functions that pass codes on for other folders as well"""


class Source(NamedTuple):
    """A way to a code: a function, and the place of the code among its arguments."""

    folder: str
    function: str
    parameter: str
    position: int
    prefix: str


Function = ast.FunctionDef | ast.AsyncFunctionDef


class Call(NamedTuple):
    """A call of a function or method, with the folder and the function that it stands in."""

    folder: str
    inside: Function | None
    node: ast.Call


def codes_in_source() -> set[str]:
    calls = all_calls()
    codes: set[str] = set()
    ahead = [Source("", "Diagnostic", "code", -1, "")]
    known = set(ahead)
    while ahead:
        source = ahead.pop()
        for call in calls[source.function]:
            if source.folder and call.folder != source.folder and source.function not in SHARED:
                continue
            for code, variable, prefix in arguments(call.node, source):
                if variable is None:
                    codes.add(source.prefix + code)
                elif call.inside and variable in (names := parameters(call.inside)):
                    passing = Source(
                        call.folder,
                        call.inside.name,
                        variable,
                        names.index(variable),
                        source.prefix + prefix,
                    )
                    if passing not in known:
                        known.add(passing)
                        ahead.append(passing)
    return codes


def all_calls() -> dict[str, list[Call]]:
    """All calls in the packages, by the name of what is called."""
    found: dict[str, list[Call]] = defaultdict(list)

    def search(node: ast.AST, folder: str, function: Function | None) -> None:
        match node:
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
                found[name].append(Call(folder, function, node))
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                function = node
        for child in ast.iter_child_nodes(node):
            search(child, folder, function)

    for path, tree in trees().items():
        search(tree, "/".join(path.parent.parts[:2]), None)
    return found


def parameters(function: Function) -> list[str]:
    names = [a.arg for a in (*function.args.args, *function.args.kwonlyargs)]
    return names[1:] if names[:1] in (["self"], ["cls"]) else names


def arguments(call: ast.Call, source: Source) -> Iterator[tuple[str, str | None, str]]:
    """What stands for the code: a text, or the name of a variable with a text before it."""
    given = [k.value for k in call.keywords if k.arg == source.parameter]
    if not given and 0 <= source.position < len(call.args):
        given = [call.args[source.position]]
    ahead: list[ast.expr] = given
    while ahead:
        match ahead.pop():
            case ast.Constant(value=str(code)):
                yield code, None, ""
            case ast.IfExp(body=body, orelse=other):
                ahead += [body, other]
            case ast.Name(id=name):
                yield "", name, ""
            case ast.JoinedStr(
                values=[
                    ast.Constant(value=str(prefix)),
                    ast.FormattedValue(value=ast.Name(id=name)),
                ]
            ):
                yield "", name, prefix
