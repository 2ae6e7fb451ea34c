"""Parsing by shape finds what the parser finds: tree, stumble and places."""

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.catalog import Catalog
from argo_compiler.script import import_script
from argo_compiler.script.syntax.protocol import protocol_grammar
from argo_compiler.script.syntax.shapes import StumbleError, Syntax, SyntaxNode, SyntaxToken
from argo_compiler.script.syntax.sheet import sheet_grammar
from argo_compiler.script.syntax.statements import Grammar, lower

DOCS = Path(__file__).parents[3] / "docs" / "script.md"
NUMBERS = ["0", "7", "14", "2.5", "1e-3", "12:30", "00:12:30", "1st", "22nd", "3times", "1000000"]
WORDS = [
    "r25",
    "R-7",
    "x",
    "foo",
    "robot's",
    "tanks",
    "and",
    "seconds",
    "half",
    "an",
    "hour",
    "twice",
]
WORDS += [
    "minutes",
    "starting",
    "areas",
    "twenty-five",
    "foo-bar",
    "hundred",
    "five",
    "ß",
    "İx",
    "_a5",
]
SIGNS = ['"a 1"', '"', "'", "#", ".", ",", ";", ":", "(", ")", "-", "²", "٣", "§", "m/s", "%", "  "]
PIECES = st.sampled_from(NUMBERS + WORDS + SIGNS) | st.text(max_size=3)


def flat(syntax: Syntax) -> list[tuple[str, int, int, int]]:
    """The tree's rules and tokens, each with its depth and place."""
    found = []
    waiting: list[tuple[SyntaxNode | SyntaxToken, int]] = [(syntax.root, 0)]
    while waiting:
        node, depth = waiting.pop()
        kind = node.rule if isinstance(node, SyntaxNode) else node.type
        found.append((kind, depth, syntax.positions[node.start], syntax.positions[node.end]))
        waiting += [(c, depth + 1) for c in getattr(node, "children", ())]
    return found


def outcome(parse, start: str, text: str):
    try:
        return flat(parse(start, text))
    except StumbleError as stumble:
        token = stumble.token
        at = len(text) if token.type == "$END" else token.start_pos
        return token.type, str(token), at, stumble.accepted


def assert_alike(grammar: Grammar, start: str, text: str) -> None:
    text = lower(text.replace("\n", " ").replace("\r", " "))
    expected = outcome(grammar.shapes.plain_tree, start, text)
    assert outcome(grammar.shapes.tree, start, text) == expected
    assert outcome(grammar.shapes.tree, start, text) == expected


def forms(kind: str) -> list[str]:
    """The statements in the language's reference."""
    boxes = DOCS.read_text().split(f"```{kind}\n")[1:]
    return [line.strip() for box in boxes for line in box.split("```")[0].splitlines() if line]


def mutated(draw: st.DrawFn, text: str) -> str:
    words = text.split(" ")
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(words)))
        words[at : at + draw(st.integers(0, 2))] = [draw(PIECES)]
    return " ".join(words)


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_statements_of_a_protocol(data: st.DataObject) -> None:
    text = data.draw(st.composite(mutated)(data.draw(st.sampled_from(forms("protocol")))))
    assert_alike(protocol_grammar(), "line", text)


@settings(max_examples=150, deadline=None)
@given(data=st.data(), start=st.sampled_from(["row", "order", "areas"]))
def test_rows_of_a_sheet(data: st.DataObject, start: str) -> None:
    text = data.draw(st.composite(mutated)(data.draw(st.sampled_from(forms("sheet")))))
    assert_alike(sheet_grammar(), start, text)


def test_the_reference_in_any_order() -> None:
    """Statements of one shape do not change what is found out about another."""
    texts = forms("protocol") * 2
    random.Random(1).shuffle(texts)
    for text in texts:
        for number in ("3", "45.5", "1e9"):
            assert_alike(protocol_grammar(), "line", text.replace("1", number, 1))


def test_more_shapes_than_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("argo_compiler.script.syntax.shapes._MOST", 3)
    for text in forms("protocol")[:40]:
        assert_alike(protocol_grammar(), "line", text)


def test_findings_stand_where_they_are_in_each_statement_of_a_shape(catalog: Catalog) -> None:
    lines = [f"{k}. Chekc checkpoint #{k % 9 + 1} and mesure #{k % 20 + 1}" for k in range(1, 1200)]
    text = "Mission Protocol\nSet a starting point in starting area 1\n" + "\n".join(lines)
    findings = import_script(text, catalog).diagnostics
    assert len(findings) == 2 * len(lines)
    for k, line in enumerate(lines):
        first, second = (f.span for f in findings[2 * k : 2 * k + 2])
        assert first is not None
        assert second is not None
        assert (first.line, first.column, first.length) == (k + 3, line.index("Chekc") + 1, 5)
        assert (second.line, second.column, second.length) == (k + 3, line.index("mesure") + 1, 6)
