"""`argo docs`: the pages of the documentation, and where messages refer to them."""

import re

from argo_env.files.resources import docs_folder
from tests.processes import ROOT
from tests.source import trees

PAGES = {path.stem: path.read_text(encoding="utf-8") for path in docs_folder().glob("*.md")}


def test_each_page_is_listed_with_its_title(argo) -> None:
    *lines, last = argo("docs", status=0).stdout.splitlines()
    listed = dict(line.split(maxsplit=1) for line in lines)
    assert listed == {name: text.splitlines()[0].removeprefix("# ") for name, text in PAGES.items()}
    assert str(docs_folder()) in last


def test_a_page_is_printed_by_its_name_or_file_name(argo) -> None:
    for name in ("routes", "routes.md"):
        assert argo("docs", name, status=0).stdout == PAGES["routes"]


def test_a_page_that_does_not_exist_is_an_error_that_names_a_similar_one(argo) -> None:
    assert "did you mean routes?" in argo("docs", "rout", status=2).stderr
    assert "`argo docs` lists them" in argo("docs", "123456789", status=2).stderr


def test_messages_and_pages_refer_to_pages_that_exist() -> None:
    texts = [(ROOT / path).read_text(encoding="utf-8") for path in trees()]
    texts += [(ROOT / "README.md").read_text(encoding="utf-8"), *PAGES.values()]
    reference = re.compile(r"`argo docs ([a-z-]+)`|page `([a-z-]+)`\s+of\s+the\s+documentation")
    found = {name for text in texts for names in reference.findall(text) for name in names} - {""}
    assert {"routes", "faults", "language"} <= found
    assert found <= PAGES.keys()
