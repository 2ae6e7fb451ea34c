"""Texts, numbers, poses, places and lines in the canonical script."""

import re
from collections.abc import Iterable
from math import degrees, radians

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexer import words
from argo_compiler.script.sentences.words.numbers import read_figure

WIDTH = 100
"""characters in a line, where the text can be broken"""
_PIECE = 70
"""characters in a piece of quoted text"""
INDENT = "   "
_MARKS = '*`"\\'
"""printable ASCII that needs an escape"""
_WORDS = re.compile(r"[a-z]+(?: [a-z]+)*")


class UnwritableError(Exception):
    """Something that no script can say; the message says what."""


def quote(text: str) -> str:
    """The text in quotation marks; a long one in several pieces, a line break between them.

    What is neither a letter nor plain ASCII is escaped: text recognition, word processors and
    terminals alter it.
    """
    pieces: list[str] = []
    piece = ""
    for character in text:
        if len(piece) >= _PIECE:
            pieces.append(piece)
            piece = ""
        piece += _escaped(character)
    pieces.append(piece)
    return "\n".join(f'"{piece}"' for piece in pieces)


def _escaped(character: str) -> str:
    if character.isascii():
        plain = character.isprintable() and character not in _MARKS
    else:
        # Of letters, the ligatures and those that change their length in lower case.
        ligature = "\ufb00" <= character <= "\ufb4f"
        plain = character.isalpha() and len(character.lower()) == 1 and not ligature
    if plain:
        return character
    if character in '"\\':
        return "\\" + character
    units = character.encode("utf-16-be")
    return "".join(f"\\u{units[i : i + 2].hex()}" for i in range(0, len(units), 2))


def number(value: float) -> str:
    """The number as it is read back: without a point where it is whole, and with a nought behind
    three decimals, which could be thousands."""
    if value == int(value) and abs(value) < 1e15:
        return str(int(value))
    said = repr(float(value))
    figure = read_figure(said.lstrip("-"))
    return f"{said}0" if figure is not None and figure.other is not None else said


def duration(seconds: float) -> str:
    """A time span as it is read back: `10 minutes`, `90.5 s`."""
    minutes = seconds / 60
    if minutes >= 1 and minutes == int(minutes) and int(minutes) * 60.0 == seconds < 1e9:
        return "1 minute" if minutes == 1 else f"{int(minutes)} minutes"
    return f"{number(seconds)} s"


def point(pose: Pose) -> str:
    """The pose in coordinates: `(1, 2, 0) heading 90 degrees`."""
    at = f"({number(pose.x)}, {number(pose.y)}, {number(pose.z)})"
    if pose.yaw == 0:
        return at
    whole = round(degrees(pose.yaw)) if abs(pose.yaw) < 7 else 0
    if radians(whole) == pose.yaw:
        return f"{at} heading {whole} degrees"
    return f"{at} heading {number(pose.yaw)} rad"


def times(count: int) -> str:
    """How often: `once`, `twice`, `3 times`."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def listed(items: Iterable[str]) -> str:
    """The items with commas, behind each of which the line may be broken."""
    return ",\n".join(items)


def capital(sentence: str) -> str:
    """The sentence with a capital at its beginning."""
    return sentence[0].upper() + sentence[1:]


def paragraph(opening: str, sentences: Iterable[str], indent: str = INDENT) -> list[str]:
    """The lines of sentences: one if that is short, else one or more for each of them.

    A sentence goes on in the next line behind a comma, and between pieces of quoted text.
    """
    said = [f"{sentence}." for sentence in sentences]
    line = opening + " ".join(said).replace("\n", " ")
    if len(line) <= WIDTH:
        return [line]
    lines: list[str] = []
    for i, sentence in enumerate(said):
        lines += wrapped(sentence if i else opening + sentence, indent if i else "")
    return lines


def wrapped(text: str, indent: str = "") -> list[str]:
    """The text in lines of at most `WIDTH` characters, where its line breaks allow that."""
    lines: list[str] = []
    current = indent
    for chunk in text.split("\n"):
        if current.strip() and len(current) + 1 + len(chunk) > WIDTH:
            lines.append(current)
            current = indent + INDENT + chunk
        else:
            current += (" " if current.strip() else "") + chunk
    return [*lines, current]


class Places:
    """The site's places by their poses, as a script names them."""

    def __init__(self, catalog: Catalog) -> None:
        language = Language.of("", [place.name for place in catalog.places])
        self._areas = {area.dock: area.number for area in reversed(catalog.areas)}
        self._docks = {area.number: area.dock for area in reversed(catalog.areas)}
        self._names = {
            place.pose: f"the {place.name}"
            for place in reversed(catalog.places)
            if _WORDS.fullmatch(place.name) and _is_place(place.name, language)
        }

    def dock(self, area: int) -> Pose | None:
        """The docking station in the starting area of this number."""
        return self._docks.get(area)

    def name(self, pose: Pose) -> str | None:
        """What the site calls the place with this pose."""
        return self._names.get(pose)

    def location(self, pose: Pose) -> str:
        """The pose as a place or area of the site if it is one, else in coordinates."""
        if pose in self._names:
            return self._names[pose]
        return f"starting area {self._areas[pose]}" if pose in self._areas else point(pose)


def _is_place(name: str, language: Language) -> bool:
    """Whether the words stand for that place, and for nothing else, behind `go to`."""
    found = words(f"go to the {name}", language.lexicon)
    return [word.type for word in found] == ["GO", "PLACE"] and found[1].value == name
