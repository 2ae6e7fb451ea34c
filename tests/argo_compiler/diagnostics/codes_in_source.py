"""Codes that the source code can give to diagnostics, by static analysis.

A function passes codes on if it makes a `Diagnostic` with a code from one of its parameters, or
calls such a function with one of its own parameters. The arguments of their calls in the same part
of a package are the codes.
"""

import ast
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

from tests.source import trees

SHARED = frozenset(["diagnostic_of", "parse_yaml", "refusal"])
"""functions that pass codes on and are called from other folders as well"""


class CodeParameter(NamedTuple):
    """Parameter of a function that takes a code."""

    folder: str
    function: str
    parameter: str
    position: int
    prefix: str


Function = ast.FunctionDef | ast.AsyncFunctionDef


class Call(NamedTuple):
    """Call of a function or method, with the folder and the function that contain it."""

    folder: str
    caller: Function | None
    node: ast.Call


def codes_in_source() -> set[str]:
    calls = all_calls()
    codes: set[str] = set()
    pending = [CodeParameter("", "Diagnostic", "code", -1, "")]
    known = set(pending)
    while pending:
        code_parameter = pending.pop()
        for call in calls[code_parameter.function]:
            if (
                code_parameter.folder
                and call.folder != code_parameter.folder
                and code_parameter.function not in SHARED
            ):
                continue
            for code, variable, prefix in arguments(call.node, code_parameter):
                if variable is None:
                    codes.add(code_parameter.prefix + code)
                elif call.caller and variable in (names := parameters(call.caller)):
                    next_parameter = CodeParameter(
                        call.folder,
                        call.caller.name,
                        variable,
                        names.index(variable),
                        code_parameter.prefix + prefix,
                    )
                    if next_parameter not in known:
                        known.add(next_parameter)
                        pending.append(next_parameter)
    return codes


def all_calls() -> dict[str, list[Call]]:
    """Return all calls in the packages, by the name of the called function."""
    calls: dict[str, list[Call]] = defaultdict(list)

    def search(node: ast.AST, folder: str, function: Function | None) -> None:
        match node:
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
                calls[name].append(Call(folder, function, node))
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                function = node
        for child in ast.iter_child_nodes(node):
            search(child, folder, function)

    for path, tree in trees().items():
        search(tree, "/".join(path.parent.parts[:2]), None)
    return calls


def parameters(function: Function) -> list[str]:
    names = [a.arg for a in (*function.args.args, *function.args.kwonlyargs)]
    return names[1:] if names[:1] in (["self"], ["cls"]) else names


def arguments(
    call: ast.Call, code_parameter: CodeParameter
) -> Iterator[tuple[str, str | None, str]]:
    """Yield the values of the code argument: a text, or a variable's name with a prefix."""
    expressions = [k.value for k in call.keywords if k.arg == code_parameter.parameter]
    if not expressions and 0 <= code_parameter.position < len(call.args):
        expressions = [call.args[code_parameter.position]]
    pending: list[ast.expr] = expressions
    while pending:
        match pending.pop():
            case ast.Constant(value=str(code)):
                yield code, None, ""
            case ast.IfExp(body=body, orelse=other):
                pending += [body, other]
            case ast.Name(id=name):
                yield "", name, ""
            case ast.JoinedStr(
                values=[
                    ast.Constant(value=str(prefix)),
                    ast.FormattedValue(value=ast.Name(id=name)),
                ]
            ):
                yield "", name, prefix
