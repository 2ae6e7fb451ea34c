"""The tables of the parsers, saved beside the grammars: to make them takes a second or two.

`make generated` writes them. Tables of another grammar, or of another version of Lark, are not
used: then the parser makes its own, and only the start takes longer.
"""

import io
import pickle
import zlib
from collections.abc import Iterator, Sequence
from hashlib import sha256
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from lark import Lark, Token
from lark.lark import PostLex

from argo_compiler.garbage_collector import collector_held

_KEY = 32
"""bytes at the beginning of the tables, by which it is told what they are of"""

_Row = dict[int, tuple[int, Any]]
"""of the tables: what the parser does at each terminal"""
_PackedRow = list[tuple[tuple[int, Any], tuple[int, ...]]]
"""the terminals at which it does the same; mostly there are a hundred of them and one action"""


class WholeWords(PostLex):
    """Lets WORD match everywhere, so that no keyword is found at the start of a longer word."""

    always_accept = ("WORD",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        return stream


def make_parser(name: str, starts: Sequence[str]) -> Lark:
    """The parser of the grammar `<name>.lark`, by the rules `starts`, its tables made anew."""
    return Lark.open_from_package(
        __package__,
        f"{name}.lark",
        parser="lalr",
        start=list(starts),
        propagate_positions=True,
        maybe_placeholders=False,
        postlex=WholeWords(),
    )


@collector_held()
def load_parser(name: str, starts: Sequence[str]) -> Lark:
    """As `make_parser`, with the saved tables if they are of this grammar and this Lark."""
    saved = files(__package__).joinpath(f"{name}.tables")
    data = saved.read_bytes() if saved.is_file() else b""
    if data[:_KEY] != _key(name, starts):
        return make_parser(name, starts)
    tables = pickle.loads(zlib.decompress(data[_KEY:]))
    rows = tables["data"]["parser"]["parser"]
    rows["states"] = {state: _unpacked(row) for state, row in rows["states"].items()}
    return Lark.load(tables)


def save_tables(name: str, starts: Sequence[str], folder: Path) -> None:
    """Writes the tables that `load_parser` reads, unless they are there."""
    path, key = folder / f"{name}.tables", _key(name, starts)
    if path.exists() and path.read_bytes()[:_KEY] == key:
        return
    buffer = io.BytesIO()
    make_parser(name, starts).save(buffer)
    tables = pickle.loads(buffer.getvalue())
    rows = tables["data"]["parser"]["parser"]
    known: dict[tuple[int, ...], tuple[int, ...]] = {}
    rows["states"] = {state: _packed(row, known) for state, row in rows["states"].items()}
    packed = zlib.compress(pickle.dumps(tables), 9)
    path.write_bytes(key + packed)


def _packed(row: _Row, known: dict[tuple[int, ...], tuple[int, ...]]) -> _PackedRow:
    """A row by its actions; lists of terminals that are alike become one."""
    terminals: dict[str, list[int]] = {}
    for terminal, action in row.items():
        terminals.setdefault(repr(action), []).append(terminal)
    keys = [tuple(found) for found in terminals.values()]
    return [(row[key[0]], known.setdefault(key, key)) for key in keys]


def _unpacked(row: _PackedRow) -> _Row:
    return {terminal: action for action, terminals in row for terminal in terminals}


def _key(name: str, starts: Sequence[str]) -> bytes:
    found = sha256(f"{version('lark')} {__name__} {starts}".encode())
    for part in ("common.lark", f"{name}.lark", "tables.py"):
        found.update(files(__package__).joinpath(part).read_bytes())
    return found.digest()
