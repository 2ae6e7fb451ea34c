"""The parser's tables, saved beside the grammar: to make them takes a second or two.

`make generated` writes them. Tables of another grammar, or of another version of Lark, are not
used: then the parser makes its own, and only the start takes longer.
"""

import io
import pickle
import re
import zlib
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from lark import Lark

from argo_compiler.base.garbage_collector import collector_held

STARTS = ["sentence", "location"]
_NAME = "sentence"
_KEY = 32
"""bytes at the beginning of the tables, by which it is told what they are of"""

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
    saved = files(__package__).joinpath(f"{_NAME}.tables")
    data = saved.read_bytes() if saved.is_file() else b""
    if data[:_KEY] != _key():
        return make_parser()
    tables = pickle.loads(zlib.decompress(data[_KEY:]))
    rows = tables["data"]["parser"]["parser"]
    rows["states"] = {state: _unpacked(row) for state, row in rows["states"].items()}
    return Lark.load(tables)


def save_tables(folder: Path) -> None:
    """Writes the tables that `load_parser` reads, unless they are there."""
    path, key = folder / f"{_NAME}.tables", _key()
    if path.exists() and path.read_bytes()[:_KEY] == key:
        return
    buffer = io.BytesIO()
    make_parser().save(buffer)
    tables = pickle.loads(buffer.getvalue())
    rows = tables["data"]["parser"]["parser"]
    known: dict[tuple[int, ...], tuple[int, ...]] = {}
    rows["states"] = {state: _packed(row, known) for state, row in rows["states"].items()}
    packed = zlib.compress(pickle.dumps(tables), 9)
    path.write_bytes(key + packed)


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


def _unpacked(row: _PackedRow) -> _Row:
    return {terminal: action for action, terminals in row for terminal in terminals}


def _key() -> bytes:
    found = sha256(f"{version('lark')} {__name__} {STARTS}".encode())
    for part in (f"{_NAME}.lark", "tables.py"):
        found.update(files(__package__).joinpath(part).read_bytes())
    return found.digest()
