"""Writes the tables of the grammars anew: `python -m argo_compiler.script`."""

from pathlib import Path

from argo_compiler.script.protocol import PROTOCOL_STARTS
from argo_compiler.script.sheet import SHEET_STARTS
from argo_compiler.script.tables import save_tables

if __name__ == "__main__":
    save_tables("protocol", PROTOCOL_STARTS, Path(__file__).parent)
    save_tables("sheet", SHEET_STARTS, Path(__file__).parent)
