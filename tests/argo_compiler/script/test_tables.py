"""The saved tables of the parsers are those of the grammars, and parse as new ones do."""

from pathlib import Path

import pytest
from lark import Lark, UnexpectedInput

from argo_compiler.script.syntax import tables
from argo_compiler.script.syntax.protocol import FORMS as PROTOCOL_FORMS
from argo_compiler.script.syntax.protocol import PROTOCOL_STARTS
from argo_compiler.script.syntax.sheet import FORMS as SHEET_FORMS
from argo_compiler.script.syntax.sheet import SHEET_STARTS

GRAMMARS = [("protocol", PROTOCOL_STARTS, PROTOCOL_FORMS), ("sheet", SHEET_STARTS, SHEET_FORMS)]


@pytest.mark.parametrize(("name", "starts", "forms"), GRAMMARS)
def test_saved_tables_parse_as_new_ones(
    name: str, starts: tuple[str, ...], forms: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    new = tables.make_parser(name, starts)

    def not_current(*_: object) -> Lark:
        pytest.fail(f"the tables of {name} are not up to date: run `make generated`")

    monkeypatch.setattr(tables, "make_parser", not_current)
    saved = tables.load_parser(name, starts)
    assert {t.name for t in saved.terminals} == {t.name for t in new.terminals}
    for form in forms:
        words = form.lower().split(" ")
        for length in range(len(words) + 1):
            outcomes = []
            for parser in (saved, new):
                state = parser.parse_interactive(" ".join(words[:length]), starts[0])
                try:
                    state.exhaust_lexer()
                except UnexpectedInput as stumble:
                    outcomes.append((type(stumble), state.accepts()))
                else:
                    outcomes.append((None, state.accepts()))
            assert outcomes[0] == outcomes[1]
        trees = []
        for parser in (saved, new):
            try:
                trees.append(parser.parse(form.lower(), starts[0]))
            except UnexpectedInput as stumble:
                trees.append(type(stumble))
        assert trees[0] == trees[1]


def test_tables_of_another_lark_are_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    monkeypatch.setattr(tables, "version", lambda package: f"another {package}")
    monkeypatch.setattr(tables, "make_parser", lambda *grammar: made.append(grammar))
    tables.load_parser("sheet", SHEET_STARTS)
    assert made == [("sheet", SHEET_STARTS)]


def test_tables_are_written_once(tmp_path: Path) -> None:
    tables.save_tables("sheet", SHEET_STARTS, tmp_path)
    path = tmp_path / "sheet.tables"
    written = path.stat().st_mtime_ns, path.read_bytes()
    tables.save_tables("sheet", SHEET_STARTS, tmp_path)
    assert (path.stat().st_mtime_ns, path.read_bytes()) == written
