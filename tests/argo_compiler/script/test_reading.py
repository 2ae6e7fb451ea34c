"""What can't be a script is refused, with a message that says why."""

from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import parse, read_script
from argo_compiler.script.documents.reading import MAX_BYTES
from argo_compiler.script.parsing.parser import MAX_LINES
from tests.argo_compiler.script.conftest import refusals


def test_a_byte_order_mark_is_taken_off(tmp_path: Path) -> None:
    path = tmp_path / "script.txt"
    path.write_bytes("\ufeffMission’s".encode())
    assert read_script(path) == "Mission’s"
    assert read_script(str(path)) == "Mission’s"


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("mark", ["\ufeff", ""])
def test_utf_16_is_recognised(encoding: str, mark: str, tmp_path: Path) -> None:
    """Windows Notepad calls it Unicode."""
    text = "Mission’s designation:\r\n1. Prüfe 5 €\r\n"
    path = tmp_path / "script.txt"
    path.write_bytes((mark + text).encode(encoding))
    assert read_script(path) == text


def test_utf_32_with_its_mark_is_recognised(tmp_path: Path) -> None:
    path = tmp_path / "script.txt"
    path.write_bytes("Mission’s".encode("utf-32"))
    assert read_script(path) == "Mission’s"


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ("\ufeffa\nb".encode("utf-16-le")[:-1], r"is damaged UTF-16-LE \(byte 7, line 2\); save"),
        ("\ufeffa\0b".encode("utf-16-be"), "binary"),
        ("Mission".encode("utf-16-le")[:-1], "binary"),
        (bytes(range(64)), "binary"),
        (b"", "is empty"),
        (b" \n\t", "is empty"),
        (b"Mission\0", "binary"),
        ("a\nMission’s".encode("cp1252"), r"not UTF-8 \(byte 10, line 2\)"),
        (b"a" * (MAX_BYTES + 1), f"larger than {MAX_BYTES} bytes"),
    ],
)
def test_bad_files(data: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "script.txt"
    path.write_bytes(data)
    with pytest.raises(ArgoError, match=message):
        read_script(path)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(ArgoError, match="does not exist"):
        read_script(tmp_path / "none.txt")
    with pytest.raises(ArgoError, match="is a directory"):
        read_script(tmp_path)
    with pytest.raises(ArgoError, match="can't be read"):
        read_script("a\0b")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "script.empty"),
        ("\ufeff \n\t\r\n", "script.empty"),
        ("\n" * 20_000, "script.empty"),
        ("Mission Protocol\n" * (MAX_LINES + 1), "script.too-long"),
    ],
)
def test_what_is_no_script(text: str, code: str) -> None:
    with pytest.raises(DiagnosticError) as caught:
        parse(text)
    (error,) = caught.value.diagnostics
    assert error.code == code


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("hello world", "script.nothing-to-do"),
        ("\n\nDear robot", "script.nothing-to-do"),
        ("x" * 100_000, "script.long-line"),
    ],
)
def test_what_asks_for_nothing(text: str, code: str, catalog: Catalog) -> None:
    assert [error.code for error in refusals(text, catalog)] == [code]


def test_too_many_errors_end_the_reading(catalog: Catalog) -> None:
    errors = refusals("Mission Protocol\n" + "1. gibberish\n" * 15_000, catalog)
    assert len(errors) == 1002
    assert errors[-1].code == "script.too-many-errors"
