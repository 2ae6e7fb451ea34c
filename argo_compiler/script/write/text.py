"""How the canonical script writes texts, numbers, poses and lines."""

from collections.abc import Iterable
from math import degrees, radians

from argo_compiler.model import Pose
from argo_compiler.number_text import number
from argo_compiler.script.syntax.protocol import MAX_STATEMENT

_WIDTH = 100
"""characters in a line, where the text can be broken"""
_PIECE = 70
"""characters in a piece of quoted text"""
_INDENT = "   "
_MARKS = '*`"\\'
"""printable ASCII that needs an escape"""


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
        plain = character.isalpha() and len(character.lower()) == 1 and not _is_ligature(character)
    if plain:
        return character
    if character in '"\\':
        return "\\" + character
    units = character.encode("utf-16-be")
    return "".join(f"\\u{units[i : i + 2].hex()}" for i in range(0, len(units), 2))


def _is_ligature(character: str) -> bool:
    return "\ufb00" <= character <= "\ufb4f"


def duration(seconds: float) -> str:
    """A time span as it is read back: `10 min`, `90.5 s`."""
    minutes = seconds / 60
    if minutes >= 1 and minutes == int(minutes) and int(minutes) * 60.0 == seconds < 1e9:
        return f"{int(minutes)} min"
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


def statement(opening: str, clauses: Iterable[str] = ()) -> list[str]:
    """The lines of a step of several clauses: one if it is short, else one or more a clause.

    They are broken where they have a line break. What is too long for a statement goes on in
    further ones. Raises UnwritableError if a single clause is too long for one.
    """
    parts = [opening, *clauses]
    line = "; ".join(parts).replace("\n", " ") + "."
    if len(line) <= _WIDTH:
        return [line]
    whole = len(line) <= MAX_STATEMENT
    lines: list[str] = []
    for i, part in enumerate(parts):
        end = ";" if whole and i + 1 < len(parts) else "."
        if whole and i > 0:
            lines += wrapped(part + end, _INDENT)
        else:
            lines += wrapped(part[0].upper() + part[1:] + end)
    return lines


def wrapped(text: str, indent: str = "") -> list[str]:
    """The text in lines of at most `_WIDTH` characters, where its line breaks allow that.

    Raises UnwritableError if it is too long for a statement.
    """
    if len(text) > MAX_STATEMENT - _WIDTH:
        said = text[:40].replace("\n", " ")
        raise UnwritableError(f"`{said}...` is longer than {MAX_STATEMENT} characters")
    lines: list[str] = []
    current = indent
    for chunk in text.split("\n"):
        if current.strip() and len(current) + 1 + len(chunk) > _WIDTH:
            lines.append(current)
            current = _INDENT + chunk
        else:
            current += (" " if current.strip() else "") + chunk
    return [*lines, current]
