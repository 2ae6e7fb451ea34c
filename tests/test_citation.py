"""`CITATION.cff` has what the package has."""

import tomllib

import yaml

from argo_compiler.base.version import __version__
from tests.processes import ROOT


def test_the_citation_is_of_this_version_and_licence() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == __version__
    assert citation["license"] == project["license"]
    assert {"message", "title", "authors"} <= citation.keys()
