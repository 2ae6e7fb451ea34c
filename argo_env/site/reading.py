"""Reads a site's description from its YAML file, with errors that say where it is wrong."""

from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span, with_excerpts
from argo_compiler.errors import ArgoError
from argo_compiler.fields import field_hint
from argo_compiler.json_places import JsonPath, format_path
from argo_env.site.spec import SiteSpec

MAX_FINDINGS = 20


def read_spec(path: Path) -> SiteSpec:
    """The description of a site in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it describes no site.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ArgoError(f"{path}: can't be read: {error.strerror}") from error
    except ValueError as error:  # bytes that are no text, a NUL in the path
        raise ArgoError(f"{path}: is not UTF-8 text: {error}") from error
    try:
        tree, repeated, data = _compose(text)
    except yaml.MarkedYAMLError as error:
        finding = _finding("site.not-yaml", f"is not YAML: {error.problem}", "correct it there")
        if mark := error.problem_mark:
            span = Span(line=mark.line + 1, column=mark.column + 1)
            finding = finding.model_copy(update={"span": span})
        raise _error(path, text, [finding]) from None
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        # ValueError: impossible dates, numbers too long.
        message = "is nested too deeply" if isinstance(error, RecursionError) else str(error)
        finding = _finding("site.not-yaml", f"is not YAML: {message}", "check the file")
        raise _error(path, text, [finding]) from None
    findings = repeated
    try:
        spec = SiteSpec.model_validate(data)
    except ValidationError as error:
        findings += _wrong_fields(error, tree)
    if findings:
        raise _error(path, text, findings)
    return spec


def _compose(text: str) -> tuple[yaml.Node | None, list[Diagnostic], Any]:
    """The tree of a YAML text, which knows the places, its duplicate keys, and the data in it."""
    loader = yaml.SafeLoader(text)
    try:
        tree = loader.get_single_node()
        repeated = [
            *_duplicate_keys(tree)
        ]  # now: constructing the data merges mappings in the tree
        return tree, repeated, None if tree is None else loader.construct_document(tree)
    finally:
        loader.dispose()


def _error(path: Path, text: str, findings: list[Diagnostic]) -> DiagnosticError:
    return DiagnosticError(str(path), with_excerpts(findings, text.splitlines()))


def _finding(
    code: str, message: str, hint: str | None, subject: str | None = None, span: Span | None = None
) -> Diagnostic:
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=message,
        hint=hint,
        subject=subject,
        span=span,
    )


def _wrong_fields(error: ValidationError, tree: yaml.Node | None) -> Iterator[Diagnostic]:
    faults = error.errors(include_url=False)[:MAX_FINDINGS]
    faulty = {fault["loc"][:end] for fault in faults for end in range(len(fault["loc"]))}
    for fault in faults:
        if fault["type"] == "too_short" and fault["loc"] in faulty:
            continue  # of what is in it nothing was left
        path: JsonPath = fault.get("ctx", {}).get("path") or fault["loc"]
        message, hint = fault["msg"], None
        if fault["type"] == "extra_forbidden":
            message, hint = "sites have no such field", field_hint(SiteSpec, path)
        elif fault["type"] == "duplicate":
            hint = "give each a name or number of its own"
        subject = format_path(path)
        yield _finding(
            "site.wrong-field",
            f"{subject or 'the site'}: {message}",
            hint,
            subject or None,
            _place(tree, path, key=fault["type"] == "extra_forbidden"),
        )


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


def _duplicate_keys(tree: yaml.Node | None) -> Iterator[Diagnostic]:
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
                        yield _finding(
                            "site.duplicate-key",
                            f"`{key.value}` stands here again; it was given at line {before.line}",
                            "remove one of the two",
                            span=span,
                        )
