"""Extras are installed from the source from which Argo was installed."""

import json
import re
from pathlib import Path

import pytest

from argo_compiler.base.extras import install_line

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("origin", "line"),
    [
        (None, "pip install 'argo-mission[film]'"),
        (
            {"url": "file:///home/me/my%20argo", "dir_info": {"editable": True}},
            "pip install -e '/home/me/my argo[film]'",
        ),
        ({"url": "file:///home/me/argo", "dir_info": {}}, "pip install '/home/me/argo[film]'"),
        (
            {"url": "file:///tmp/argo_mission-0.1.0-py3-none-any.whl", "archive_info": {}},
            "pip install 'argo-mission[film] @ file:///tmp/argo_mission-0.1.0-py3-none-any.whl'",
        ),
        (
            {"url": "ssh://git@host/argo", "vcs_info": {"vcs": "git", "commit_id": "4fe724c"}},
            "pip install 'argo-mission[film] @ git+ssh://git@host/argo@4fe724c'",
        ),
    ],
)
def test_the_line_names_where_argo_came_from(origin, line, tmp_path, monkeypatch):
    described = tmp_path / "argo_mission-0.1.0.dist-info"
    described.mkdir()
    (described / "METADATA").write_text("Name: argo-mission\nVersion: 0.1.0\n", encoding="utf-8")
    if origin is not None:
        (described / "direct_url.json").write_text(json.dumps(origin), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    assert install_line("film") == line


def test_argo_that_is_not_installed_is_a_checkout(monkeypatch):
    monkeypatch.setattr("sys.path", [])
    assert install_line("film") == f"pip install -e '{ROOT}[film]'"


def test_pages_install_no_extra_from_an_index():
    """An index may not have Argo, or may have a foreign package under its name."""
    for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md")):
        # Two pages say how to install Argo itself.
        refused = "argo-mission" + "[" * (page.name in {"installing.md", "package.md"})
        for line in re.findall(r"pip install [^`\n]*", page.read_text(encoding="utf-8")):
            assert refused not in line, f"{page.name}: {line}"
