"""The answer of an assistant: JSON, perhaps with prose around it, that nothing vouches for."""

import json
from collections.abc import Iterator
from typing import Any, NoReturn

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from argo_compiler.base.errors import Invalid

MAX_ANSWER_BYTES = 1_000_000
"""of an answer; a larger one is refused"""
_MOST_ENTRIES = 2_000
_LONGEST = 500
"""characters of words and of a sentence"""
_MOST_BEGINNINGS = 200
"""braces at which an object may begin in prose"""


class AnswerEntry(BaseModel):
    """A sentence, and the words of a line of the script that it stands for."""

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    line: int = Field(ge=1)
    words: str = Field(min_length=1, max_length=_LONGEST)
    sentence: str = Field(min_length=1, max_length=_LONGEST)


class _Answer(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    lines: list[AnswerEntry] = Field(max_length=_MOST_ENTRIES)


def read_answer(content: bytes) -> tuple[AnswerEntry, ...]:
    """Return the entries of an answer, those that can't be printed left out.

    Raises:
        Invalid: The answer is too large, not UTF-8, or has no JSON object of the right form.
    """
    if len(content) > MAX_ANSWER_BYTES:
        raise Invalid(f"the answer is larger than {MAX_ANSWER_BYTES:,} bytes")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise Invalid(f"the answer is not UTF-8 (byte {error.start + 1})") from None
    problem = "it has no JSON object"
    for found in _objects(text):
        try:
            answer = _Answer.model_validate(found)
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            place = ".".join(map(str, first["loc"]))
            problem = f"{place}: {first['msg'].lower()}"
        else:
            return tuple(entry for entry in map(_with_single_blanks, answer.lines) if entry)
    raise Invalid(f"the answer is not of the form that was asked for: {problem}")


def _objects(text: str) -> Iterator[dict[str, Any]]:
    """Yield the JSON objects of a text, the text as a whole first."""
    decoder = json.JSONDecoder(parse_constant=_refuse)
    at = text.find("{")
    for _ in range(_MOST_BEGINNINGS):
        if at < 0:
            return
        end = at + 1
        try:
            found, end = decoder.raw_decode(text, at)
        except (ValueError, RecursionError):
            pass
        else:
            yield found
        at = text.find("{", end)


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number of JSON")


def _with_single_blanks(entry: AnswerEntry) -> AnswerEntry | None:
    words, sentence = (" ".join(text.split()) for text in (entry.words, entry.sentence))
    if not (words and sentence and words.isprintable() and sentence.isprintable()):
        return None
    return AnswerEntry(line=entry.line, words=words, sentence=sentence)
