"""The page on scripts has all that can be said, as the grammar and the lexicons have it."""

from pathlib import Path

from argo_compiler.script.reference import BEGIN, END, as_markdown
from argo_compiler.script.syntax.words.loading import LANGUAGES

PAGE = Path(__file__).parents[3] / "docs" / "script.md"


def test_the_page_is_as_new() -> None:
    said = PAGE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    assert said.strip() == as_markdown(LANGUAGES), (
        "run python -m argo_compiler.script docs/script.md"
    )
