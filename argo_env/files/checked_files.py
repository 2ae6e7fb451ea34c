"""Checksums of whole files: JSON objects, which begin with theirs, and pages, which end with it.

Files without a checksum, of earlier versions or by other programs, are not checked.
"""

import json
import re
import zlib
from typing import TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.json_places import LONG_NUMBER

CHECKSUM = "checksum"
"""key of the checksum in a JSON object: the CRC-32 of all bytes after its comma"""
_START = b'{"checksum":"'
_IN_JSON = re.compile(rb'\{"checksum":"([0-9a-f]{8})",')
_IN_PAGE = re.compile(rb"<!-- checksum ([0-9a-f]{8}) -->\n\Z")

ModelT = TypeVar("ModelT", bound=Model)


def checked_json(text: str) -> str:
    """Return the text of a JSON object, which is not empty, with its checksum."""
    fields = text.removeprefix("{")
    return f'{{"{CHECKSUM}":"{zlib.crc32(fields.encode()):08x}",{fields}'


def unchecked_json(content: bytes, name: object, remedy: str) -> bytes:
    """Return the content of a JSON file with spaces in place of its checksum.

    Raises Unavailable, which ends with the `remedy`, if the content does not fit the checksum.
    """
    match = _IN_JSON.match(content)
    if match is None:
        if sum(a == b for a, b in zip(content, _START, strict=False)) > len(_START) - 4:
            raise damaged(name, _place(content) or Message("its checksum is not whole"), remedy)
        return content
    fields = content[match.end() :]
    if int(match[1], 16) != zlib.crc32(fields):
        raise damaged(
            name, _place(content) or Message("its content does not fit its checksum"), remedy
        )
    return b"{" + b" " * (match.end() - 1) + fields


def read_checked(model: type[ModelT], content: bytes, name: object, remedy: str) -> ModelT:
    """Return the model in a JSON file with or without a checksum.

    Raises Unavailable, which ends with the `remedy`, if the file is damaged; ValidationError if it
    is whole, but not of this model.
    """
    whole = unchecked_json(content, name, remedy)
    try:
        return model.model_validate_json(whole)
    except ValidationError:
        if place := _place(whole):
            raise damaged(name, place, remedy) from None
        raise


def checked_page(page: str) -> str:
    """Return a page of HTML with its checksum, in a comment at its end."""
    return f"{page}<!-- checksum {zlib.crc32(page.encode()):08x} -->\n"


def check_page(content: bytes, name: object, remedy: str) -> None:
    """Raise Unavailable, which ends with the `remedy`, if a page does not fit its checksum."""
    match = _IN_PAGE.search(content)
    if match is not None and int(match[1], 16) != zlib.crc32(content[: match.start()]):
        raise damaged(name, "its content does not fit its checksum", remedy)


def damaged(name: object, why: str, remedy: str) -> Unavailable:
    """Return the error for a damaged file: which one, what is wrong, and what one can do."""
    return Unavailable(
        Message("{name} is damaged: {why}; {remedy}", name=name, why=why, remedy=remedy)
    )


def _place(content: bytes) -> str:
    """Return where a text ceases to be JSON, and why; empty if it is JSON."""
    try:
        json.loads(content)
    except json.JSONDecodeError as error:
        return Message(
            "line {lineno}, column {colno}: {msg}",
            lineno=error.lineno,
            colno=error.colno,
            msg=error.msg,
        )
    except UnicodeDecodeError as error:
        return Message("byte {start}: {reason}", start=error.start, reason=error.reason)
    except ValueError:
        return LONG_NUMBER
    except RecursionError:
        return Message("it is nested too deeply")
    return ""
