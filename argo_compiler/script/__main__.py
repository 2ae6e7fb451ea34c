"""Writes the tables of the grammar anew: `python -m argo_compiler.script`."""

from importlib.resources import files
from pathlib import Path

from argo_compiler.script.syntax.tables import save_tables

if __name__ == "__main__":
    save_tables(Path(str(files("argo_compiler.script.syntax"))))
