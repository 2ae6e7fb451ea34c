"""Writes the tables of the grammars anew: `python -m argo_compiler.script`."""

from importlib.resources import files
from pathlib import Path

from argo_compiler.script.syntax.protocol import PROTOCOL_STARTS
from argo_compiler.script.syntax.sheet import SHEET_STARTS
from argo_compiler.script.syntax.tables import save_tables

if __name__ == "__main__":
    folder = Path(str(files("argo_compiler.script.syntax")))
    save_tables("protocol", PROTOCOL_STARTS, folder)
    save_tables("sheet", SHEET_STARTS, folder)
