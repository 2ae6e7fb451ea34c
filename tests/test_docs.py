"""The Python in README and docs runs as it stands there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = {
    path.relative_to(ROOT).as_posix(): re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
    if "```python" in (text := path.read_text(encoding="utf-8"))
}


@pytest.mark.parametrize("page", PAGES)
def test_snippets_run(page, monkeypatch):
    """Those of a page one after the other, from the project's folder."""
    monkeypatch.chdir(ROOT)
    names = {"__name__": "snippet"}
    for number, snippet in enumerate(PAGES[page], start=1):
        exec(compile(snippet, f"{page}, snippet {number}", "exec"), names)
