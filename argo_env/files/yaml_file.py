"""Reads a model from the text of a YAML file, with errors that say where the file is wrong."""

from collections.abc import Hashable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

import yaml
from pydantic import ValidationError

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span, with_excerpts
from argo_compiler.files.fields import field_hint
from argo_compiler.files.json_places import JsonPath, format_path
from argo_env.files.yaml_messages import message_of, path_in_data

MAX_FINDINGS = 20

ModelT = TypeVar("ModelT", bound=Model)


class _Flaw(NamedTuple):
    """What is wrong, what to do about it, and where."""

    message: str
    hint: str | None
    subject: str | None
    span: Span | None


class NotYamlError(Exception):
    """The text is no YAML; holds what is wrong."""

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
    """The model in the text of a YAML file, which messages call `source_name`. `things` names what
    it holds, such as `sites`; the next three are the codes of diagnostics. `no_field` has hints for
    fields that only some things have.

    Raises DiagnosticError, with all that was found, if it is no such thing.
    """
    try:
        tree, repeated, data = _compose(text)
    except NotYamlError as error:
        raise _error(source_name, text, [_diagnostic(not_yaml, error.flaw)]) from None
    diagnostics = [_diagnostic(duplicate_key, flaw) for flaw in repeated]
    try:
        found = model.model_validate(data)
    except ValidationError as error:
        for flaw in _wrong_fields(error, model, things, no_field or {}, tree, data):
            diagnostics.append(_diagnostic(wrong_field, flaw))
    if diagnostics:
        raise _error(source_name, text, diagnostics)
    return found


def placed(
    text: str, source_name: str, code: str, found: Mapping[JsonPath, str]
) -> DiagnosticError:
    """What was found wrong, with all of the file known, at these places of a YAML file's text."""
    tree, _, _ = _compose(text)
    flaws = [_Flaw(said, None, format_path(at), _place(tree, at)) for at, said in found.items()]
    return _error(source_name, text, [_diagnostic(code, flaw) for flaw in flaws])


def _compose(text: str) -> tuple[yaml.Node | None, list[_Flaw], Any]:
    """The tree of a YAML text, which knows the places, its duplicate keys, and the data in it."""
    try:
        loader = yaml.SafeLoader(text)
        try:
            tree = loader.get_single_node()
            # Now: constructing the data merges mappings in the tree.
            repeated = [*_duplicate_keys(tree)]
            return tree, repeated, None if tree is None else loader.construct_document(tree)
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        span = Span(line=mark.line + 1, column=mark.column + 1) if mark else None
        message, hint = f"is not YAML: {error.problem}", "correct it there"
        raise NotYamlError(_Flaw(message, hint, None, span)) from None
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        # ValueError: impossible dates, numbers too long.
        why = "is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise NotYamlError(_Flaw(f"is not YAML: {why}", "check the file", None, None)) from None


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
            continue  # of what is in it nothing was left
        path = fault.get("ctx", {}).get("path") or path_in_data(fault["loc"], data)
        message, hint = message_of(fault, path), _beginning(model, fault["loc"])
        unknown = fault["type"] == "extra_forbidden"
        if unknown:
            message, hint = f"{things} have no such field", field_hint(model, fault["loc"])
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
                    _place(tree, path, key=unknown))  # fmt: skip


def _beginning(model: type[Model], path: JsonPath) -> str | None:
    """How a file begins that holds one list and nothing else, if that is what is wrong."""
    names = list(model.model_fields)
    if len(names) == 1 and path in {(), (names[0],)}:
        return f"begin with `{names[0]}:` and a list below it"
    return None


def _place(tree: yaml.Node | None, path: JsonPath, key: bool = False) -> Span | None:
    """Where the value at a path begins, or its key, or the longest part of the path that exists."""
    if key and isinstance(mapping := _node(tree, path[:-1]), yaml.MappingNode):
        named = next((k for k, _ in mapping.value if k.value == path[-1]), None)
        if named is not None:
            return _span(named)
    node = _node(tree, path)
    return _span(node) if node else None


def _node(tree: yaml.Node | None, path: JsonPath) -> yaml.Node | None:
    node = tree
    for step in path:
        inside: yaml.Node | None = None
        if isinstance(node, yaml.MappingNode):
            inside = next((v for k, v in reversed(node.value) if k.value == step), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(step, int):
            inside = node.value[step] if step < len(node.value) else None
        if inside is None:
            break
        node = inside
    return node


def _span(node: yaml.Node) -> Span:
    start, end = node.start_mark, node.end_mark
    length = end.column - start.column if end.line == start.line else 1
    return Span(line=start.line + 1, column=start.column + 1, length=max(1, length))


def _duplicate_keys(tree: yaml.Node | None) -> Iterator[_Flaw]:
    """Keys that stand twice in one mapping, of which YAML readers silently drop one."""
    ahead: list[Any] = [tree]
    seen: set[int] = set()  # aliases lead to the same node again
    while ahead:
        node = ahead.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.SequenceNode):
            ahead += node.value
        elif isinstance(node, yaml.MappingNode):
            first: dict[Hashable, Span] = {}
            for key, value in node.value:
                ahead.append(value)
                if isinstance(key, yaml.ScalarNode) and key.value != "<<":
                    span = _span(key)
                    before = first.setdefault(key.value, span)
                    if before is not span:
                        message = f"`{key.value}` stands here again; it was given at line "
                        yield _Flaw(f"{message}{before.line}", "remove one of the two", None, span)
