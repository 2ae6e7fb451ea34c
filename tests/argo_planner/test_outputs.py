"""No command writes over what it reads, or two results to one place."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from argo_compiler.errors import Conflict
from argo_planner.cli import app


@pytest.mark.parametrize(
    ("command", "says"),
    [
        ("import s.txt -o s.txt", "is the input"),
        ("check m.json -o m.json", "is the input"),
        ("check m.json --site site.yaml -o site.yaml", "is the input"),
        ("compile m.json -o new.json --mermaid m.json", "is the input"),
        ("compile m.json -o new.json --mermaid ./new.json", "twice"),
        ("format m.json -o m.json", "is the input"),
        ("export m.json --to dot -o m.json", "is the input"),
        ("route m.json --requirements r.yaml -o r.yaml", "is the input"),
        ("run m.json --record m.json", "m.json"),
        ("run m.json --faults f.yaml --journal f.yaml", "is there already"),
        ("run m.json --journal new.mcap --record new.mcap", "twice"),
        ("resume j.mcap --record j.mcap", "is the input"),
        ("replay r.gif --render r.gif", "is the input"),
        ("sites site.yaml -o site.yaml", "is the input"),
    ],
)
def test_inputs_are_kept(monkeypatch, tmp_path: Path, command: str, says: str):
    monkeypatch.chdir(tmp_path)
    for name in ("s.txt", "m.json", "site.yaml", "r.yaml", "f.yaml", "j.mcap", "r.gif"):
        Path(name).write_text("mine", encoding="utf-8")
    result = CliRunner().invoke(app, command.split())
    assert isinstance(result.exception, Conflict)
    assert says in str(result.exception)
    assert {path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == {"mine"}
