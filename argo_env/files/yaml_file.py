"""Parser of YAML files into pydantic models, with diagnostics that locate each error."""

from collections.abc import Hashable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

import yaml
from pydantic import ValidationError

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span, with_excerpts
from argo_compiler.files.fields import unknown_field_hint
from argo_compiler.files.json_places import JsonPath, format_path
from argo_env.files.yaml_messages import error_message, strip_discriminators

MAX_FINDINGS = 20

ModelT = TypeVar("ModelT", bound=Model)


class _Flaw(NamedTuple):
    """Error in a YAML file: its message, remedy and location."""

    message: str
    hint: str | None
    subject: str | None
    span: Span | None


class NotYamlError(Exception):
    """Raised when the text is not YAML; holds the error."""

    def __init__(self, flaw: _Flaw) -> None:
        super().__init__(flaw.message)
        self.flaw = flaw


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
        tree, repeated, data = _compose(text)
    except NotYamlError as error:
        raise _error(source_name, text, [_diagnostic(not_yaml, error.flaw)]) from None
    diagnostics = [_diagnostic(duplicate_key, flaw) for flaw in repeated]
    try:
        parsed = model.model_validate(data)
    except ValidationError as error:
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
    tree, _, _ = _compose(text)
    flaws = [
        _Flaw(message, None, format_path(path), _span_at(tree, path))
        for path, message in messages.items()
    ]
    return _error(source_name, text, [_diagnostic(code, flaw) for flaw in flaws])


def _compose(text: str) -> tuple[yaml.Node | None, list[_Flaw], Any]:
    """Parse a YAML text, and return its tree of nodes, its duplicate keys, and its data.

    The nodes have the spans in the text. Tree and data are None for a text without content. Raises
    NotYamlError if the text is not YAML.
    """
    try:
        loader = yaml.SafeLoader(text)
        try:
            tree = loader.get_single_node()
            # Before the data is constructed, which merges mappings in the tree.
            repeated = [*_duplicate_keys(tree)]
            return tree, repeated, None if tree is None else loader.construct_document(tree)
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        span = Span(line=mark.line + 1, column=mark.column + 1) if mark else None
        message, hint = f"the file is not YAML: {error.problem}", "correct it there"
        raise NotYamlError(_Flaw(message, hint, None, span)) from None
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        # ValueError: impossible dates, numbers too long.
        why = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise NotYamlError(
            _Flaw(f"the file is not YAML: {why}", "check the file", None, None)
        ) from None


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
    tree: yaml.Node | None,
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
            message, hint = f"{things} have no such field", unknown_field_hint(model, fault["loc"])
            if len(path) > 1:
                hint = no_field.get(str(path[-1]), hint)
        elif fault["type"] == "duplicate":
            hint = "give each a name or number of its own"
        elif fault["type"] in {"union_tag_invalid", "union_tag_not_found"}:
            context = fault.get("ctx", {})
            message = f"no kind `{context['tag']}`" if "tag" in context else "it has no `kind`"
            hint = f"there are: {context['expected_tags']}" if "tag" in context else "give its kind"
        subject = format_path(path)
        whole = "the file" if fault["type"] == "model_type" else f"the {things.removesuffix('s')}"
        yield _Flaw(f"{subject or whole}: {message}", hint, subject or None,
                    _span_at(tree, path, key=unknown))  # fmt: skip


def _list_hint(model: type[Model], path: JsonPath) -> str | None:
    """Return a hint with the field that the file must begin with, or None if none applies.

    It applies if the model has only one field, a list, and the error is at the top of the file or
    at the list as a whole. `path` is the place of the error in the data.
    """
    names = list(model.model_fields)
    if len(names) == 1 and path in {(), (names[0],)}:
        return f"begin with `{names[0]}:` and a list below it"
    return None


def _span_at(tree: yaml.Node | None, path: JsonPath, key: bool = False) -> Span | None:
    """Return the span of the value at a path, or of its key, or of the longest existing prefix."""
    if key and isinstance(mapping := _node(tree, path[:-1]), yaml.MappingNode):
        named = next((k for k, _ in mapping.value if k.value == path[-1]), None)
        if named is not None:
            return _span(named)
    node = _node(tree, path)
    return _span(node) if node else None


def _node(tree: yaml.Node | None, path: JsonPath) -> yaml.Node | None:
    node = tree
    for step in path:
        child: yaml.Node | None = None
        if isinstance(node, yaml.MappingNode):
            child = next((v for k, v in reversed(node.value) if k.value == step), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(step, int):
            child = node.value[step] if step < len(node.value) else None
        if child is None:
            break
        node = child
    return node


def _span(node: yaml.Node) -> Span:
    start, end = node.start_mark, node.end_mark
    length = end.column - start.column if end.line == start.line else 1
    return Span(line=start.line + 1, column=start.column + 1, length=max(1, length))


def _duplicate_keys(tree: yaml.Node | None) -> Iterator[_Flaw]:
    """Yield an error for each key that a mapping has twice; YAML parsers silently drop one."""
    pending: list[Any] = [tree]
    seen: set[int] = set()  # aliases lead to the same node again
    while pending:
        node = pending.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            pending += node.value
        elif isinstance(node, yaml.MappingNode):
            spans: dict[Hashable, Span] = {}
            for key, value in node.value:
                pending.append(value)
                if isinstance(key, yaml.ScalarNode) and key.value != "<<":
                    span = _span(key)
                    first = spans.setdefault(key.value, span)
                    if first is not span:
                        message = f"`{key.value}` is given twice; it was first given at line "
                        yield _Flaw(f"{message}{first.line}", "remove one of the two", None, span)
