"""The codes in the source, in the registry and in the documentation are the same."""

from pathlib import Path

from argo_compiler.diagnostics import CODES
from argo_compiler.diagnostics.codes import BEGIN, END, as_markdown
from tests.argo_compiler.diagnostics.codes_in_source import codes_in_source

ROOT = Path(__file__).parents[3]


def test_every_code_in_the_source_is_explained_and_no_other():
    assert codes_in_source() == set(CODES)


def test_the_page_shows_the_registry():
    page = (ROOT / "docs" / "diagnostics.md").read_text(encoding="utf-8")
    shown = page.partition(BEGIN)[2].partition(END)[0]
    assert shown.strip() == as_markdown(), "out of date: run `make generated`"


def test_explanations_are_sentences_that_a_table_can_hold():
    for name, code in CODES.items():
        for text in (code.meaning, code.remedy):
            assert text[0].isupper() or text[0] == "`", name
            assert text.endswith("."), name
            assert "|" not in text, name
            assert "\n" not in text, name
