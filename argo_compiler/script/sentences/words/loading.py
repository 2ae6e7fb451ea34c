"""Reads the words of a language from its file, such as `english.toml`, or what was saved of it."""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.resources import files
from inspect import signature
from pathlib import Path
from typing import Any, TypeVar

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.listing import listed
from argo_compiler.base.saved_tables import are_saved, find_tables, key_of, write_tables
from argo_compiler.il import EventKind, Mode, Order
from argo_compiler.script.sentences.tree.nouns import Kind
from argo_compiler.script.sentences.words.lexicon import Entry, Lexicon, expand
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import Prose, either

_Made = TypeVar("_Made")
LANGUAGES = ("english", "german")
_SAVED = "lexicons.tables"
"""beside the files: to make the lexicons takes a tenth of a second"""
_SAVED_TEXTS = "texts.tables"
"""beside the files: tables of them that are read at each start"""
_MADE_BY = ("lexicon.py", "loading.py", "numbers.py")
Table = Mapping[str, Any]
"""of a file"""
_COUNTS = {"one": False, "several": True, "any": None}
"""how many a noun stands for; `any` of nouns that look the same"""
_SECONDS = {
    **{"day": 86400.0, "hour": 3600.0, "minute": 60.0, "second": 1.0},
    **{"three_quarter_hour": 2700.0, "half_hour": 1800.0, "quarter_hour": 900.0},
}
_METRES_PER_SECOND = {"m/s": 1.0, "cm/s": 0.01, "km/h": 1 / 3.6}
_MEANINGS: dict[str, Callable[..., Any]] = {
    "KIND": lambda kind, count: (Kind(kind.replace("_", " ")), _COUNTS[count]),
    "FLOOR": _COUNTS.__getitem__,
    "EVENT": lambda name: None if name == "obstacle" else EventKind(name),
    "MODE": Mode,
    "IF": {"if": None, "whenever": "whenever"}.__getitem__,
    "THEM": {"all": None, "either": "either"}.__getitem__,
    "RETRY": {"failed": None, "again": "again"}.__getitem__,
    "UNIT_S": _SECONDS.__getitem__,
    "RATE": _METRES_PER_SECOND.__getitem__,
    **dict.fromkeys(["ORDINAL", "RANKED"], int),
    **dict.fromkeys(["TIMES", "MORE"], lambda n: Figure(float(n))),
    "NUMBER_WORD": float,
    **dict.fromkeys(
        ["FLOOR_NAME", "OF", "WAIT", "REPEAT", "IS", "VALUE", "SHOWN", "STATE", "UNIT", "NEITHER"],
        str,
    ),
    **dict.fromkeys(["OR_MORE", "OR_LESS", "JOINT"], str),
}
"""what the key behind a terminal stands for; other terminals have none"""
_FIELD_VALUES: dict[str, Callable[[str], Any]] = {"mode": Mode, "order": Order}
_SAID_BY_ARGO = frozenset(["say", "samples"])
_NO_WORDS = frozenset(["language", "layout", "patterns", "numbers", "prose"])
_GOES_ON = re.compile(r"/\s*\n\s*")
_MADE = re.compile(r"\s*(\w+)(?: (\w+))?: (.+)")


def lexicon(language: str) -> Lexicon:
    """The lexicon of a language, without the places of a site."""
    table = table_of(language)
    found = _made(Lexicon, table["language"], f"{language}.toml: `language`")
    patterns = table.get("patterns", {})
    for entry, text in _entries(language):
        if wrong := _wrong(text):
            raise ValueError(f"{language}.toml: {wrong} in the words for `{entry[0]}`")
        found.add(entry, _phrases(text, patterns))
    return found


def make_lexicons() -> tuple[Lexicon, ...]:
    """Return the lexicons of all languages, made anew of their files."""
    compare(*LANGUAGES)
    return tuple(map(lexicon, LANGUAGES))


@collector_held()
def load_lexicons() -> tuple[Lexicon, ...]:
    """Return what `make_lexicons` does, from what was saved if that is of these files. Nobody else
    has the same ones, so that the places of a site can be added."""
    saved: tuple[Lexicon, ...] | None = find_tables(__package__, _SAVED, _key())
    return make_lexicons() if saved is None else saved


def save_lexicons(folder: Path) -> None:
    """Write what `load_lexicons` reads, unless it is there."""
    key = _key()
    for name, make in ((_SAVED, make_lexicons), (_SAVED_TEXTS, make_texts)):
        if not are_saved(folder / name, key):
            write_tables(folder / name, key, make())


@cache
def load_texts() -> dict[str, Table]:
    """Return what `make_texts` does, from what was saved if that is of these files."""
    saved: dict[str, Table] | None = find_tables(__package__, _SAVED_TEXTS, _key())
    return make_texts() if saved is None else saved


def make_texts() -> dict[str, Table]:
    """Return of each language the tables of its file that stand for no words of sentences."""
    tables = {language: table_of(language) for language in LANGUAGES}
    return {
        language: {name: table[name] for name in ("layout", "prose")}
        for language, table in tables.items()
    }


def _key() -> bytes:
    languages = [f"{language}.toml" for language in LANGUAGES]
    return key_of(__package__, [*languages, *_MADE_BY])


@cache
def prose(language: str, besides: str | None = None) -> Prose:
    """What stands around sentences in a language; labels of `besides` are mixed with its own."""
    texts = load_texts()
    said = (texts.get(language) or table_of(language))["prose"]
    if besides is not None:
        said = _mixed(said, (texts.get(besides) or table_of(besides))["prose"], language)
    values = dict(_field_values(said["values"]))
    return _made(Prose, {**said, "values": values}, f"{language}.toml: `prose`")


@cache
def everywhere(name: str) -> str:
    """A pattern of the words that `layout` has for `name` in any language."""
    said = (texts["layout"][name] for texts in load_texts().values())
    return either("|".join(words for words in said if words))


@cache
def pattern(text: str) -> re.Pattern[str]:
    """Return the pattern, in any case, in whose text `<name>` is what `everywhere` has for it."""
    whole = re.sub(r"<(\w+)>", lambda name: f"(?:{everywhere(name[1])})", text)
    return re.compile(whole, re.IGNORECASE)


def shown_words(language: str) -> dict[str, dict[str, str]]:
    """The phrases as the file has them, by group and by what they stand for; of a pattern its
    first form."""
    table = table_of(language)
    patterns = table.get("patterns", {})
    return {
        name: {
            " ".join([f"`{keys[0]}`", *(key.replace("_", " ") for key in keys[1:])]): _shown(
                text, patterns
            )
            for keys, text in _flat(group)
        }
        for name, group in table.items()
        if name not in _NO_WORDS
    }


def _shown(text: str, patterns: Table) -> str:
    shown: list[str] = []
    for phrase in map(str.strip, text.split("|")):
        made = _MADE.fullmatch(phrase) if ":" in phrase else None
        if made is None:
            shown.append(phrase)
        else:
            first = patterns[made[1]].split("|")[0].strip().replace("~", made[2] or "")
            shown += [first.replace("*", word) for word in made[3].split()]
    return ", ".join(shown)


def compare(one: str, two: str) -> None:
    """Raises if one of two languages has no words for what the other one has words for."""
    first, second = (
        {entry for entry, _ in _entries(language, own=False)} for language in (one, two)
    )
    for language, missing in ((two, first - second), (one, second - first)):
        if missing:
            terminal, value = min(missing, key=str)
            said = terminal if value is None else f"{terminal} ({value})"
            raise ValueError(f"{language}.toml: there are no words for `{said}`")


@cache
def table_of(language: str) -> dict[str, Any]:
    """All that the file of a language has; its phrases are separated by bars only."""
    import tomllib  # imported late: what is saved needs none

    name = f"{language}.toml"
    text = files(__package__).joinpath(name).read_text(encoding="utf-8")
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{name}: {error}") from error
    return {key: _in_bars(value) for key, value in table.items()}


def _in_bars(value: Any) -> Any:
    """A table whose phrases are separated by bars only."""
    if isinstance(value, dict):
        return {key: _in_bars(inner) for key, inner in value.items()}
    if not isinstance(value, str) or "\n" not in value:
        return value
    return "|".join(line.strip(" |") for line in _GOES_ON.sub("/", value).strip().split("\n"))


def _entries(language: str, own: bool = True) -> Iterator[tuple[Entry, str]]:
    """All entries with their phrases, or only those that other languages have as well."""
    table = table_of(language)
    numbers = _made(_numbers, table["numbers"], f"{language}.toml: `numbers`")
    for name, group in table.items():
        if name in _NO_WORDS or (name == "own" and not own):
            continue
        for keys, text in _flat(group):
            entry = _entry(keys, language)
            numbers.pop(entry, None)
            yield entry, text
    yield from numbers.items()


def _flat(table: Table) -> Iterator[tuple[tuple[str, ...], str]]:
    """The phrases of a table, with the keys that lead to them."""
    for key, value in table.items():
        if isinstance(value, str):
            yield (key,), value
        else:
            yield from (((key, *keys), text) for keys, text in _flat(value))


def _entry(keys: tuple[str, ...], language: str) -> Entry:
    terminal, *said = keys
    meaning = _MEANINGS.get(terminal)
    try:
        if meaning is None and not said:
            return terminal, None
        if meaning is not None and said:
            return terminal, meaning(*said)
    except (KeyError, TypeError, ValueError):
        pass
    raise ValueError(f"{language}.toml: `{'.'.join(keys)}` is nothing that can be meant")


def _made(make: Callable[..., _Made], table: Table, name: str) -> _Made:
    """What is made of a table that has all that it needs, and nothing else."""
    needed = signature(make).parameters.keys()
    if missing := needed - table.keys():
        raise ValueError(f"{name} lacks {listed(sorted(missing))}")
    if odd := table.keys() - needed:
        raise ValueError(f"{name} must not have {listed(sorted(odd))}")
    return make(**table)


def _wrong(text: str) -> str:
    """What is wrong with the phrases of an entry; nothing if they are right."""
    if text.count("[") != text.count("]") or text.count("{") != text.count("}"):
        return "a bracket is open"
    if not all(phrase.strip() for phrase in text.split("|")):
        return "a phrase is empty"
    return "" if text == text.lower() else "there are capital letters"


def _phrases(text: str, patterns: Table) -> Iterator[str]:
    """The phrases of an entry; `weak: prüf` is made from the pattern `weak`."""
    for phrase in text.split("|"):
        made = _MADE.fullmatch(phrase) if ":" in phrase else None
        if made is None:
            yield from expand(phrase)
            continue
        if made[1] not in patterns:
            raise ValueError(f"there is no pattern `{made[1]}` for `{phrase.strip()}`")
        pattern = patterns[made[1]].replace("~", made[2] or "")
        for word in made[3].split():
            yield from expand(pattern.replace("*", word))


def _numbers(units: str, teens: str, tens: str, half: str, joined: str) -> dict[Entry, str]:
    """The numbers of one word up to 99, and those of 1 to 19 with a half."""
    ones, ten = expand(units), list(enumerate(expand(tens), start=2))
    low = list(enumerate(ones + expand(teens), start=1))
    said = {float(n): word for n, word in low}
    said |= {n + 0.5: half.replace("{number}", word) for n, word in low}
    said |= {10.0 * n: word for n, word in ten}
    for n, word in ten:
        for k, unit in enumerate(ones, start=1):
            said[10.0 * n + k] = joined.replace("{ten}", word).replace("{unit}", unit)
    return {("NUMBER_WORD", n): word for n, word in said.items()}


def _field_values(table: Table) -> Iterator[tuple[Entry, str]]:
    for keys, text in _flat(table):
        name, meaning = keys if len(keys) > 1 else (keys[0], None)
        yield (name, None if meaning is None else _FIELD_VALUES[name](meaning)), text


def _mixed(own: Table, other: Table, language: str) -> dict[str, Any]:
    """What is said in two languages; what Argo says itself, in its own only."""
    found = dict(other)
    for name, value in own.items():
        there = other.get(name)
        if isinstance(value, str) and there is not None:
            found[name] = f"{value}|{there}"
        elif name in _SAID_BY_ARGO or there is None:
            found[name] = value
        else:
            found[name] = _mixed(value, there, language)
        if isinstance(there, dict) and (odd := there.keys() ^ value.keys()):
            raise ValueError(f"{language}.toml: `{name}.{min(odd)}` is in one language only")
    return found
