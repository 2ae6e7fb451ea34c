"""The saved tables of the parser are those of the grammar, and parse as new ones do."""

import re
from functools import partial
from pathlib import Path

import pytest
from lark import Lark

from argo_compiler.script.sentences.grammar import tables
from argo_compiler.script.sentences.grammar.parser import Grammar, StumbleError
from argo_compiler.script.sentences.words import loading
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexer import words

DOCS = Path(__file__).parents[3] / "docs" / "script.md"


def test_saved_tables_are_up_to_date(monkeypatch: pytest.MonkeyPatch) -> None:
    def not_current() -> None:
        pytest.fail("the tables are not up to date: run `make generated`")

    monkeypatch.setattr(tables, "make_parser", not_current)
    monkeypatch.setattr(loading, "make_lexicons", not_current)
    monkeypatch.setattr(loading, "make_texts", not_current)
    loading.load_texts.cache_clear()
    loading.load_texts()
    tables.load_parser()
    loading.load_lexicons()


def test_saved_lexicons_are_as_new_ones() -> None:
    for saved, new in zip(loading.load_lexicons(), loading.make_lexicons(), strict=True):
        assert vars(saved) == vars(new)


@pytest.mark.long
def test_saved_tables_parse_as_new_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    new = Grammar(tables.make_parser())

    def not_current() -> Lark:
        pytest.fail("the tables are not up to date: run `make generated`")

    monkeypatch.setattr(tables, "make_parser", not_current)
    saved = Grammar(tables.load_parser())
    for types in sentences():
        for length in range(len(types) + 1):
            assert outcome(saved, types[:length]) == outcome(new, types[:length])
        if isinstance(outcome(saved, types), tuple):
            half = types[: len(types) // 2]
            assert saved.accepted(half) == new.accepted(half)


def test_one_word_of_lookahead_decides(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """But for `floor 1 and 2`, where what follows `and` is taken for another floor."""
    monkeypatch.setattr(tables, "Lark", partial(Lark, debug=True))
    caplog.set_level("DEBUG", logger="lark")
    tables.make_parser()
    conflicts = [found.message for found in caplog.records if "conflict" in found.message]
    assert conflicts
    assert all("AND_NUMBER" in conflict for conflict in conflicts)
    places = [found.message for found in caplog.records if found.message.startswith(" * ")]
    assert all(place.startswith(" * <floors : FLOOR NUMBER") for place in places)


def sentences() -> list[tuple[str, ...]]:
    """The types of the words in the lines of the language's reference."""
    text = DOCS.read_text(encoding="utf-8")
    lines = [
        line for box in re.findall(r"```protocol\n(.*?)```", text, re.S) for line in box.split("\n")
    ]
    lexicon = Language.of("", ()).lexicon
    return list(dict.fromkeys(tuple(w.type for w in words(line, lexicon)) for line in lines))


def outcome(grammar: Grammar, types: tuple[str, ...]) -> object:
    try:
        return grammar.tree(types)
    except StumbleError as stumble:
        return stumble.at


def test_tables_of_another_lark_are_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    monkeypatch.setattr(tables.lark, "__version__", "another")
    monkeypatch.setattr(tables, "make_parser", lambda: made.append(True))
    tables.load_parser()
    assert made == [True]


@pytest.mark.long
def test_tables_are_written_once(tmp_path: Path) -> None:
    tables.save_tables(tmp_path)
    path = tmp_path / "sentence.tables"
    written = path.stat().st_mtime_ns, path.read_bytes()
    tables.save_tables(tmp_path)
    assert (path.stat().st_mtime_ns, path.read_bytes()) == written
