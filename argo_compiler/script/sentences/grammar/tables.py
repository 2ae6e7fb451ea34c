"""The parser's tables, saved beside the grammar: to make them takes a second or two.

Tables of another grammar, or of another version of Lark, are not used: then the parser makes its
own.
"""

import io
import pickle
import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import lark
from lark import Lark
from lark.grammar import Rule
from lark.parsers.lalr_analysis import Reduce, Shift

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.saved_tables import (
    are_saved,
    find_tables,
    key_of,
    write_tables,
)

STARTS = ["sentence", "location", "nouns"]
_NAME = "sentence"

_Row = dict[int, tuple[int, Any]]
"""of the tables: what the parser does at each terminal"""
_PackedRow = list[tuple[tuple[int, Any], tuple[int, ...]]]
"""the terminals at which it does the same; mostly there are a hundred of them and one action"""


def make_parser() -> Lark:
    """The parser of sentences, its tables made anew. Its terminals are types of words, made by the
    lexicons and not by Lark."""
    text = files(__package__).joinpath(f"{_NAME}.lark").read_text(encoding="utf-8")
    return Lark(
        f"{text}\n%declare {' '.join(terminals(text))}",
        parser="lalr",
        lexer="basic",
        start=STARTS,
        propagate_positions=True,
        maybe_placeholders=False,
    )


@collector_held()
def load_parser() -> Lark:
    """As `make_parser`, with the saved tables if they are of this grammar and this Lark."""
    tables = find_tables(__package__, f"{_NAME}.tables", _key())
    if tables is None:
        return make_parser()
    rows = tables["data"]["parser"]["parser"]
    packed, rows["states"] = rows["states"], {}
    parser = Lark.load(tables)
    numbers = [said["@"] for said in tables["data"]["rules"]]
    rules = dict(zip(numbers, parser.rules, strict=True))
    parser.parser.parser._parse_table.states = _Rows(packed, rows["tokens"], rules)
    return parser


class _Rows(dict[int, dict[str, tuple[Any, Any]]]):
    """The rows of the tables as Lark's parser looks at them. A script comes to few of them, so each
    is unpacked when the parser first comes to it."""

    def __init__(
        self, packed: dict[int, _PackedRow], terminals: dict[int, str], rules: dict[int, Rule]
    ) -> None:
        super().__init__()
        self._packed = packed
        self._terminals = terminals
        self._rules = rules

    def __missing__(self, state: int) -> dict[str, tuple[Any, Any]]:
        row: dict[str, tuple[Any, Any]] = {}
        for (reduces, said), terminals in self._packed[state]:
            action = (Reduce, self._rules[said["@"]]) if reduces else (Shift, said)
            row.update(dict.fromkeys([self._terminals[number] for number in terminals], action))
        self[state] = row
        return row


def save_tables(folder: Path) -> None:
    """Writes the tables that `load_parser` reads, unless they are there."""
    path, key = folder / f"{_NAME}.tables", _key()
    if are_saved(path, key):
        return
    buffer = io.BytesIO()
    make_parser().save(buffer)
    tables = pickle.loads(buffer.getvalue())
    rows = tables["data"]["parser"]["parser"]
    known: dict[tuple[int, ...], tuple[int, ...]] = {}
    rows["states"] = {state: _packed(row, known) for state, row in rows["states"].items()}
    write_tables(path, key, tables)


def terminals(text: str) -> list[str]:
    """The names in capitals of a grammar's text."""
    return sorted(set(re.findall(r"\b[A-Z][A-Z_]+\b|\b[XYZ]\b", re.sub(r"//.*", "", text))))


def _packed(row: _Row, known: dict[tuple[int, ...], tuple[int, ...]]) -> _PackedRow:
    """A row by its actions; lists of terminals that are alike become one."""
    found: dict[str, list[int]] = {}
    for terminal, action in row.items():
        found.setdefault(repr(action), []).append(terminal)
    keys = [tuple(terminals) for terminals in found.values()]
    return [(row[key[0]], known.setdefault(key, key)) for key in keys]


def _key() -> bytes:
    names = (f"{_NAME}.lark", "tables.py")
    return key_of(__package__, names, lark.__version__, *STARTS)
