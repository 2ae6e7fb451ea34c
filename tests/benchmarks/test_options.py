"""Tests of the option `--seed` of benchmarks and campaigns."""

from importlib import import_module

import pytest


@pytest.mark.parametrize(
    "name", ["benchmarks.drives", "tests.campaigns.faults", "tests.campaigns.perception"]
)
def test_a_negative_seed_is_refused_in_one_line(name, capsys):
    with pytest.raises(SystemExit, match="2"):
        import_module(name).main(["--seed", "-1"])
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1].endswith("argument --seed: it must be 0 or more, not -1")
