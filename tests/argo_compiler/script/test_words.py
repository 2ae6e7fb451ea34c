"""The words of the languages: what their files must have, and what is said of a wrong one."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script.reference import BEGIN, END, as_markdown
from argo_compiler.script.sentences.words import loading
from tests.whole_scripts import import_whole

FOLDER = Path(loading.__file__).parent


@pytest.fixture
def changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str, str], None]]:
    """Makes `other.toml` of the English file, with other words at a place."""

    def change(old: str, new: str) -> None:
        text = (FOLDER / "english.toml").read_text(encoding="utf-8")
        assert old in text
        (tmp_path / "english.toml").write_text(text, encoding="utf-8")
        (tmp_path / "other.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
        monkeypatch.setattr(loading, "files", lambda _: tmp_path)

    loading.prose.cache_clear()
    loading.table_of.cache_clear()
    yield change
    loading.prose.cache_clear()
    loading.table_of.cache_clear()


def read(language: str) -> None:
    loading.compare("english", language)
    loading.lexicon(language)
    loading.prose(language)
    loading.prose(language, besides="english")


def test_all_languages_have_words_for_the_same() -> None:
    loading.compare("english", "german")
    german, english = loading.prose("german", besides="english"), loading.prose("english")
    assert german.meanings.keys() > english.meanings.keys()


@pytest.mark.parametrize("language", ["english", "german"])
def test_every_terminal_is_used(language: str) -> None:
    files = [*FOLDER.parent.rglob("*.lark"), *FOLDER.parent.rglob("*.py")]
    used = " ".join(path.read_text(encoding="utf-8") for path in files if path.stem != "loading")
    terminals = {terminal for terminal, _ in loading.lexicon(language).phrases}
    assert not {name for name in terminals if not re.search(rf"\b{name}\b", used)}


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ("KEEP_ORDRE = 'keep'", "no words for `KEEP_ORDER`"),
        ("KEEP_ORDER = 'keep'\nFLY = 'fly'", "english.toml: there are no words for `FLY`"),
        ("KEEP_ORDER.now = 'keep'", "`KEEP_ORDER.now` is nothing that can be meant"),
        ("EVENT.flood = 'flood'\nKEEP_ORDER = 'keep'", "`EVENT.flood` is nothing"),
        ("EVENT = 'flood'\nKEEP_ORDER = 'keep'", "`EVENT` is nothing that can be meant"),
        ("KEEP_ORDER = 'twice'", "`twice` is .*KEEP_ORDER.* and .*TIMES"),
        ("KEEP_ORDER = 'keep | '", "a phrase is empty in the words for `KEEP_ORDER`"),
        ("KEEP_ORDER = 'always [do'", "a bracket is open in the words for `KEEP_ORDER`"),
        ("KEEP_ORDER = 'Keep'", "capital letters in the words for `KEEP_ORDER`"),
        ("KEEP_ORDER = 'strong: keep'", "no pattern `strong`"),
        ("KEEP_ORDER = keep", r"other.toml: .*line \d+"),
    ],
)
def test_a_wrong_file_is_told(changed: Callable[[str, str], None], new: str, said: str) -> None:
    changed("KEEP_ORDER = 'keep | always do'", new)
    with pytest.raises(ValueError, match=said):
        read("other")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("yes = ", "yeah = ", "`prose` lacks yes"),
        ("WAIT = 'wait 90 s'\n", "", "`samples.WAIT` is in one language only"),
    ],
)
def test_a_field_that_is_missing_is_told(
    changed: Callable[[str, str], None], old: str, new: str, said: str
) -> None:
    changed(old, new)
    with pytest.raises(ValueError, match=said):
        read("other")


def test_a_line_that_ends_with_a_stroke_goes_on_in_the_next(
    changed: Callable[[str, str], None],
) -> None:
    changed("KEEP_ORDER = 'keep | always do'", "KEEP_ORDER = '''\nkeep\n[see/\n  feel] it\n'''")
    phrases = loading.lexicon("other").phrases["KEEP_ORDER", None]
    assert phrases == ["keep", "see it", "feel it"]


def test_a_place_may_be_named_as_a_phrase_is(catalog: Catalog) -> None:
    place = catalog.places[0].model_copy(update={"name": "Control room"})
    named = catalog.model_copy(update={"places": (*catalog.places, place)})
    text = "Start in starting area 1. Go to the control room."
    assert place.pose in [task.pose for task in import_whole(text, named).mission.tasks]


def test_the_page_on_scripts_has_all_that_can_be_said() -> None:
    page = Path(__file__).parents[3] / "docs" / "script.md"
    said = page.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0]
    assert said.strip() == as_markdown(loading.LANGUAGES), (
        "run python -m argo_compiler.script docs/script.md"
    )
