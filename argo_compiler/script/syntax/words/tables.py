"""The lexicons, saved beside their languages' files: to make them takes a tenth of a second."""

from pathlib import Path

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.saved_tables import (
    are_saved,
    find_tables,
    key_of,
    write_tables,
)
from argo_compiler.script.syntax.words import loading
from argo_compiler.script.syntax.words.lexicon import Lexicon

_NAME = "lexicons.tables"
_MADE_BY = ("lexicon.py", "loading.py", "numbers.py", "tables.py")


def make_lexicons() -> tuple[Lexicon, ...]:
    """Return the lexicons of all languages, made anew of their files."""
    loading.compare(*loading.LANGUAGES)
    return tuple(map(loading.lexicon, loading.LANGUAGES))


@collector_held()
def load_lexicons() -> tuple[Lexicon, ...]:
    """Return what `make_lexicons` does, from what was saved if that is of these files. Nobody else
    has the same ones, so that the places of a site can be added."""
    saved: tuple[Lexicon, ...] | None = find_tables(__package__, _NAME, _key())
    return make_lexicons() if saved is None else saved


def save_lexicons(folder: Path) -> None:
    """Write what `load_lexicons` reads, unless it is there."""
    path, key = folder / _NAME, _key()
    if not are_saved(path, key):
        write_tables(path, key, make_lexicons())


def _key() -> bytes:
    languages = [f"{language}.toml" for language in loading.LANGUAGES]
    return key_of(__package__, [*languages, *_MADE_BY])
