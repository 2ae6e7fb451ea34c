"""Parser of YAML files into pydantic models, with diagnostics that locate each error."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

from pydantic import ValidationError

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span, with_excerpts
from argo_compiler.files.fields import unknown_field_hint
from argo_compiler.files.foreign import find_foreign_yaml
from argo_compiler.files.json_places import JsonPath, format_path
from argo_compiler.files.yaml_text import (
    MappingNode,
    Node,
    NotYamlError,
    SequenceNode,
    compose_yaml,
)
from argo_env.files.yaml_messages import error_message, strip_discriminators

MAX_FINDINGS = 20

ModelT = TypeVar("ModelT", bound=Model)


class _Flaw(NamedTuple):
    """Error in a YAML file: its message, remedy and location."""

    message: str
    hint: str | None
    subject: str | None
    span: Span | None


def parse_yaml(
    text: str,
    source_name: str,
    model: type[ModelT],
    things: str,
    not_yaml: str,
    duplicate_key: str,
    wrong_field: str,
    no_field: Mapping[str, str] | None = None,
) -> ModelT:
    """Return the model that the text of a YAML file describes.

    Args:
        text: content of the file.
        source_name: name of the file in messages.
        model: class of the result.
        things: plural noun for what such files describe, as in `sites`.
        not_yaml: code of the diagnostic for a text that is not YAML.
        duplicate_key: code of the diagnostic for a key that occurs twice in one mapping.
        wrong_field: code of the diagnostics for values that the model rejects.
        no_field: hints for fields below the top of the file that only some kinds of items have, by
            the field's name; such a hint replaces the usual one if the field is unknown there.

    Raises:
        DiagnosticError: the text describes no such model; the error has all duplicate keys
            and the first 20 wrong fields.
    """
    try:
        tree, repeated, data = compose_yaml(text)
    except NotYamlError as error:
        raise _error(source_name, text, [_diagnostic(not_yaml, _syntax_flaw(error))]) from None
    diagnostics = [
        _diagnostic(
            duplicate_key,
            _Flaw(one.message, Message("remove one of the two"), None, _span(one.node)),
        )
        for one in repeated
    ]
    try:
        parsed = model.model_validate(data)
    except ValidationError as error:
        if foreign := find_foreign_yaml(data):
            message = Message(
                "the file has no {things}, but {kind}: choose another file",
                things=things,
                kind=foreign.kind,
            )
            flaw = _Flaw(message, None, None, None)
            raise _error(source_name, text, [_diagnostic(wrong_field, flaw)]) from None
        for flaw in _wrong_fields(error, model, things, no_field or {}, tree, data):
            diagnostics.append(_diagnostic(wrong_field, flaw))
    if diagnostics:
        raise _error(source_name, text, diagnostics)
    return parsed


def error_at_paths(
    text: str, source_name: str, code: str, messages: Mapping[JsonPath, str]
) -> DiagnosticError:
    """Return an error with these messages, each located at its path in a YAML file's text.

    It is for errors that are found after the whole file has been parsed.

    Args:
        text: content of the file.
        source_name: name of the file in messages.
        code: code of all diagnostics.
        messages: messages by the path of the value that they are about.
    """
    tree = compose_yaml(text).tree
    flaws = [
        _Flaw(message, None, format_path(path), _span_at(tree, path))
        for path, message in messages.items()
    ]
    return _error(source_name, text, [_diagnostic(code, flaw) for flaw in flaws])


def _syntax_flaw(error: NotYamlError) -> _Flaw:
    if error.line is None or error.column is None:
        return _Flaw(str(error), Message("check the file"), None, None)
    return _Flaw(
        str(error), Message("correct it there"), None, Span(line=error.line, column=error.column)
    )


def _error(source_name: str, text: str, diagnostics: list[Diagnostic]) -> DiagnosticError:
    return DiagnosticError(source_name, with_excerpts(diagnostics, text.splitlines()))


def _diagnostic(code: str, flaw: _Flaw) -> Diagnostic:
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=flaw.message,
        hint=flaw.hint,
        subject=flaw.subject,
        span=flaw.span,
    )


def _wrong_fields(
    error: ValidationError,
    model: type[Model],
    things: str,
    no_field: Mapping[str, str],
    tree: Node | None,
    data: Any,
) -> Iterator[_Flaw]:
    faults = error.errors(include_url=False)[:MAX_FINDINGS]
    faulty = {fault["loc"][:end] for fault in faults for end in range(len(fault["loc"]))}
    for fault in faults:
        if fault["type"] == "too_short" and fault["loc"] in faulty:
            continue  # it is too short only because its items are wrong
        path = fault.get("ctx", {}).get("path") or strip_discriminators(fault["loc"], data)
        message, hint = error_message(fault, path), _list_hint(model, fault["loc"])
        unknown = fault["type"] == "extra_forbidden"
        if unknown:
            message, hint = (
                Message("{things} have no such field", things=things),
                unknown_field_hint(model, fault["loc"]),
            )
            if len(path) > 1:
                hint = no_field.get(str(path[-1]), hint)
        elif fault["type"] == "duplicate":
            hint = Message("give each a name or number of its own")
        elif fault["type"] in {"union_tag_invalid", "union_tag_not_found"}:
            context = fault.get("ctx", {})
            message = (
                Message("no kind `{context}`", context=context["tag"])
                if "tag" in context
                else Message("it has no `kind`")
            )
            hint = (
                Message("there are: {context}", context=context["expected_tags"])
                if "tag" in context
                else Message("give its kind")
            )
        subject = format_path(path)
        whole = (
            Message("the file")
            if fault["type"] == "model_type"
            else Message("the {removesuffix}", removesuffix=things.removesuffix("s"))
        )
        yield _Flaw(f"{subject or whole}: {message}", hint, subject or None,
                    _span_at(tree, path, key=unknown))  # fmt: skip


def _list_hint(model: type[Model], path: JsonPath) -> str | None:
    """Return a hint with the field that the file must begin with, or None if none applies.

    It applies if the model has only one field, a list, and the error is at the top of the file or
    at the list as a whole. `path` is the place of the error in the data.
    """
    names = list(model.model_fields)
    if len(names) == 1 and path in {(), (names[0],)}:
        return Message("begin with `{name}:` and a list below it", name=names[0])
    return None


def _span_at(tree: Node | None, path: JsonPath, key: bool = False) -> Span | None:
    """Return the span of the value at a path, or of its key, or of the longest existing prefix."""
    if key and isinstance(mapping := _node(tree, path[:-1]), MappingNode):
        named = next((k for k, _ in mapping.value if k.value == path[-1]), None)
        if named is not None:
            return _span(named)
    node = _node(tree, path)
    return _span(node) if node else None


def _node(tree: Node | None, path: JsonPath) -> Node | None:
    node = tree
    for step in path:
        child: Node | None = None
        if isinstance(node, MappingNode):
            child = next((v for k, v in reversed(node.value) if k.value == step), None)
        elif isinstance(node, SequenceNode) and isinstance(step, int):
            child = node.value[step] if step < len(node.value) else None
        if child is None:
            break
        node = child
    return node


def _span(node: Node) -> Span:
    start, end = node.start_mark, node.end_mark
    length = end.column - start.column if end.line == start.line else 1
    return Span(line=start.line + 1, column=start.column + 1, length=max(1, length))
