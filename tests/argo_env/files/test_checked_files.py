"""Checksums of whole files: every flipped bit is found, and files without a checksum are read."""

import json
import random

import pytest
from pydantic import ValidationError

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.model import Model
from argo_env.files.checked_files import (
    check_page,
    checked_json,
    checked_page,
    read_checked,
    unchecked_json,
)


class Note(Model):
    """Model with a text, a list and a number."""

    text: str
    values: tuple[float, ...]
    revision: int = 1


NOTE = Note(text="größer als 3", values=(1.0, 2.5), revision=7)
COMPACT, INDENTED = NOTE.model_dump_json(), NOTE.model_dump_json(indent=1)


def read(content: bytes) -> Note:
    return read_checked(Note, content, "note.json", "write it again")


@pytest.mark.parametrize("text", [COMPACT, INDENTED])
def test_a_file_is_read_with_its_checksum_and_without(text):
    checked = checked_json(text)
    assert json.loads(checked) == json.loads(text) | {"checksum": checked[13:21]}
    assert read(checked.encode()) == read(text.encode()) == NOTE
    assert json.loads(unchecked_json(checked.encode(), "note.json", "")) == json.loads(text)


@pytest.mark.parametrize("text", [COMPACT, INDENTED])
def test_every_flipped_bit_is_damage(text):
    content = checked_json(text).encode()
    for bit in range(8 * len(content)):
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        with pytest.raises(Unavailable, match=r"^note\.json is damaged: .+; write it again$"):
            read(bytes(damaged))


def test_the_place_of_the_damage_is_named():
    content = checked_json(INDENTED).encode()
    for cut in (content[:-20], INDENTED.encode()[:-20]):
        with pytest.raises(Unavailable, match=r"is damaged: line \d, column \d+: \w+"):
            read(cut)
    with pytest.raises(Unavailable, match="its content does not fit its checksum"):
        read(content.replace(b"2.5", b"3.5"))
    with pytest.raises(Unavailable, match="is damaged: byte "):
        read(content.replace("ß".encode(), b"\xff"))


def test_another_kind_of_file_is_no_damage():
    for text in ('{"text":"a"}', checked_json('{"text":"a"}')):
        with pytest.raises(ValidationError):
            read(text.encode())


def test_a_flipped_bit_of_a_page_is_damage():
    content = checked_page("<p>größer</p>\n").encode()
    check_page(content, "page.html", "")
    check_page(b"<p>without a checksum</p>", "page.html", "")
    rng = random.Random(5)
    for _ in range(50):
        damaged = bytearray(content)
        damaged[rng.randrange(content.index(b"<!--"))] ^= 1 << rng.randrange(8)
        with pytest.raises(Unavailable, match=r"page\.html is damaged: .*; write it again"):
            check_page(bytes(damaged), "page.html", "write it again")
