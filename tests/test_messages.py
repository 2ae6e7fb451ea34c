"""The catalogue of messages in German has exactly the templates that are in the code."""

import ast
import json
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from pydantic import BaseModel

import argo_compiler.il as il
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.translation import german_catalogue, in_german
from argo_compiler.diagnostics import Severity
from argo_compiler.hfsm.kinds import Outcome
from argo_compiler.il import EventKind
from argo_compiler.il.events import event_text
from tests.message_templates import (
    Template,
    fields_of,
    formats_of,
    has_words,
    is_composed,
    name_of,
    templates,
)

ROOT = Path(__file__).parents[1]
PLAIN_ENGLISH = ROOT / "argo_planner/page/src/texts/plain-english.json"
TRANSLATED = (
    "argo_compiler/analysis",
    "argo_compiler/base",
    "argo_compiler/checks",
    "argo_compiler/diagnostics/diagnostic.py",
    "argo_compiler/diagnostics/text.py",
    "argo_compiler/editing",
    "argo_compiler/files",
    "argo_compiler/hfsm",
    "argo_compiler/il",
    "argo_compiler/isar",
    "argo_compiler/reorder",
    "argo_compiler/ros",
    "argo_compiler/route",
    "argo_env/drives",
    "argo_env/evaluation/evaluation.py",
    "argo_env/evaluation/file.py",
    "argo_env/evaluation/folder.py",
    "argo_env/evaluation/parquet_files.py",
    "argo_env/evaluation/plan.py",
    "argo_env/evaluation/requirement.py",
    "argo_env/evaluation/runner.py",
    "argo_env/evaluation/store.py",
    "argo_env/faults",
    "argo_env/files",
    "argo_env/navigation",
    "argo_env/planning/opening.py",
    "argo_env/planning/travel.py",
    "argo_env/planning/site_warnings.py",
    "argo_env/remote",
    "argo_env/run",
    "argo_env/sensing",
    "argo_env/site/family.py",
    "argo_env/site/site.py",
    "argo_planner/assistant",
    "argo_planner/service",
    "argo_planner/use_cases",
)
"""folders whose messages are all in the catalogue"""
EXTENSIONS = frozenset(
    ["route solver", "format", "response", "fault", "policy", "drive", "sensor", "report"]
)
"""what extension points call their objects"""
FILES = frozenset(["script", "bag", "site", "evaluation", "mission"])
"""kinds of files"""


def _files() -> Iterator[Path]:
    for folder in TRANSLATED:
        path = ROOT / folder
        yield from sorted(path.rglob("*.py")) if path.is_dir() else [path]


@cache
def _found() -> dict[str, list[Template]]:
    found: dict[str, list[Template]] = defaultdict(list)
    for path in _files():
        for template in templates(path):
            found[template.text].append(template)
    return found


@cache
def _identifiers() -> frozenset[str]:
    """Return the identifiers that messages may name: members of enumerations, and fields."""
    parts = [Outcome, Severity, *(part for part in vars(il).values() if isinstance(part, type))]
    values = {str(v) for part in parts if hasattr(part, "__members__") for v in part}  # type: ignore[attr-defined]
    models = (part for part in parts if issubclass(part, BaseModel))
    fields = {name for model in models for name in model.model_fields}
    return frozenset(values | fields | set(map(event_text, EventKind)) | EXTENSIONS | FILES)


def test_each_template_is_in_the_catalogue() -> None:
    catalogue = german_catalogue()
    missing = [
        f"{found[0].place}: {text}"
        for text, found in _found().items()
        if text not in catalogue and (has_words(text) or not found[0].fields)
    ]
    assert not missing
    assert set(EventKind) <= catalogue.keys()


def test_the_catalogue_has_no_other_templates() -> None:
    known = _found().keys() | _identifiers()
    assert not sorted(german_catalogue().keys() - known)
    plain = json.loads(PLAIN_ENGLISH.read_text(encoding="utf-8"))
    assert not sorted(plain.keys() - known)


def test_the_code_gives_each_template_its_parameters() -> None:
    wrong = [
        f"{template.place}: {text}"
        for text, found in _found().items()
        for template in found
        if template.fields and template.fields != fields_of(text)
    ]
    assert not wrong


@pytest.mark.parametrize("catalogue", ["german", "plain English"])
def test_translations_have_the_same_parameters(catalogue: str) -> None:
    texts = (
        german_catalogue()
        if catalogue == "german"
        else json.loads(PLAIN_ENGLISH.read_text(encoding="utf-8"))
    )
    wrong = [english for english, text in texts.items() if not _has_same_fields(english, text)]
    assert not wrong


def _has_same_fields(english: str, other: str) -> bool:
    found = _found().get(english)
    if found is None or not any(template.fields for template in found):
        return other.count("{") == english.count("{")
    return formats_of(english) == formats_of(other)


def test_all_are_rendered() -> None:
    for text, found in _found().items():
        if not any(template.fields for template in found):
            assert in_german(text)
            continue
        formats = formats_of(text)
        values = {name: _value(spec) for name, spec in formats.items()}
        german = in_german(Message(text, **values))
        assert not fields_in_text(german), text


def fields_in_text(text: str) -> list[str]:
    return re.findall(r"\{[a-z_0-9]+[:}]", text)


def _value(spec: str) -> object:
    if spec in ("and", "or", ";", ">", " "):
        return Listing(["A", Message("remove it")])
    if spec:
        return 65 if spec[-1] in "dX" else 1.5
    return "A"


def test_no_template_is_made_at_run_time() -> None:
    wrong = []
    for path in _files():
        if path.name in ("message.py", "wording.py"):
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and name_of(node.func) == "Message":
                text = node.args[0] if node.args else None
                if not (isinstance(text, ast.Constant) and isinstance(text.value, str)):
                    wrong.append(f"{path}:{node.lineno}")
            if is_composed(node):
                wrong.append(f"{path}:{node.lineno}")
    assert not wrong
