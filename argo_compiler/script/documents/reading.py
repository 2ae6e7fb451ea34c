"""Reads files of scripts: plain text, and documents of other programs."""

import io
import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from unicodedata import normalize

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.base.limited_process import LimitExceeded, call_limited, limits_for_size
from argo_compiler.base.records import dataclass
from argo_compiler.files.loading import decode_text, read_bytes, require_size
from argo_compiler.script.documents.document import Document
from argo_compiler.script.documents.separated import SUFFIXES as SEPARATED
from argo_compiler.script.documents.separated import read_separated

MAX_BYTES = 32_000_000
"""of a script's file; a mission of a hundred thousand steps fits"""
_PDF = b"%PDF-"
_ZIP = b"PK\x03\x04"
_MOST_UNPACKED = 300_000_000
"""bytes of the parts of a document together"""


@dataclass(frozen=True)
class _Format:
    """A format of documents."""

    name: str
    """with its article"""
    modules: tuple[str, ...]
    """that read it"""
    part: str = ""
    """the part by which a ZIP archive is recognised as such a document"""


_FORMATS = {
    "workbook": _Format("an Excel spreadsheet", ("openpyxl",), "xl/workbook.xml"),
    "word": _Format("a Word document", ("docx",), "word/document.xml"),
    "pages": _Format("a document (PDF)", ("pdfplumber",)),
}
_MODULES = tuple(module for one in _FORMATS.values() for module in one.modules)


def read_script(path: str | Path) -> str:
    """The text of the script at `path`, UTF-8 or UTF-16.

    Raises ArgoError if there is no such file, or if it can't be a script: a directory, empty,
    binary, in another encoding, or larger than `MAX_BYTES`.
    """
    return decode_script(read_bytes(Path(path), "script", MAX_BYTES), str(path))


def decode_script(data: bytes, source_name: str) -> str:
    """The text in `data`; raises ArgoError as `read_script` does."""
    require_size(data, source_name, "script", MAX_BYTES)
    if not data.strip():
        raise Invalid(f"{source_name} is empty; a script is a mission sheet or a protocol")
    return decode_text(data, source_name, "script")


def read_document(path: str | Path) -> str | Document:
    """Return the script in a file: its text, or the document in a spreadsheet, text document, PDF
    or file of separated values.

    Raises:
        ArgoError: There is no such file, it can't be a script, is damaged or encrypted, is a
            picture without text, or the extra `documents` is not installed.
    """
    return decode_document(read_bytes(Path(path), "script", MAX_BYTES), str(path))


def decode_document(data: bytes, source_name: str) -> str | Document:
    """Return the script in the content of a file, as `read_document` does.

    Files of separated values are recognised by the ending of their name, others by their content.
    """
    require_size(data, source_name, "script", MAX_BYTES)
    found = document_format(data)
    if found is None:
        text = decode_script(data, source_name)
        suffix = Path(source_name).suffix.lower()
        document = read_separated(text, source_name) if suffix in SEPARATED else None
        return text if document is None else _with_content(document, source_name, "")
    format_ = _FORMATS[found]
    _require_installed(format_, source_name)
    limits = limits_for_size(len(data), held=len(data))
    try:
        document = call_limited(limits, _MODULES, read_here, data, source_name)
    except LimitExceeded as error:
        raise Invalid(
            f"{source_name} {error}: is it the right file? A document with a mission takes far less"
        ) from None
    return _with_content(document, source_name, format_.name)


def document_format(data: bytes) -> str | None:
    """Return the format of a document that is no text, or None if it is something else."""
    if data[:1024].lstrip().startswith(_PDF):
        return "pages"
    if not data.startswith(_ZIP):
        return None
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = {*archive.namelist()}
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError):
        return None
    return next((name for name, one in _FORMATS.items() if one.part and one.part in parts), None)


def read_here(data: bytes, source_name: str) -> Document:
    """Return the document in the content of a file, in this process and without limits."""
    found = document_format(data)
    assert found is not None
    read = _reader(found)
    try:
        _require_small_parts(data, source_name)
        return read(data, source_name)
    except (ArgoError, MemoryError):
        raise
    except Exception:  # for broken files the libraries raise errors of any type
        raise Invalid(
            f"{source_name} is {_FORMATS[found].name} that is damaged: open it in its program, and "
            "save it again"
        ) from None


def _reader(format_: str) -> Callable[[bytes, str], Document]:
    # Each reader is imported when it is used, as its library may not be installed.
    if format_ == "workbook":
        from argo_compiler.script.documents.workbook import read_workbook

        return read_workbook
    if format_ == "word":
        from argo_compiler.script.documents.word import read_word

        return read_word
    from argo_compiler.script.documents.pages import read_pages

    return read_pages


def _require_small_parts(data: bytes, source_name: str) -> None:
    """Raise Invalid if a ZIP archive unpacks to far more than a document has."""
    if not data.startswith(_ZIP):
        return
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        size = sum(part.file_size for part in archive.infolist())
    if size > _MOST_UNPACKED:
        raise Invalid(
            f"{source_name} unpacks to more than {_MOST_UNPACKED // 1_000_000} MB: is it the right "
            "file?"
        )


def _require_installed(format_: _Format, source_name: str) -> None:
    missing = [module for module in format_.modules if find_spec(module) is None]
    if missing:
        raise Unavailable(
            f"{source_name} is {format_.name}, which Argo reads with the extra `documents`: "
            f"{install_line('documents')}"
        )


def _with_content(document: Document, source_name: str, kind: str) -> Document:
    """Return a document with composed letters, unless nothing stands in it."""
    lines = (
        line if line.table is not None else replace(line, text=normalize("NFC", line.text))
        for line in document.lines
    )
    document = replace(document, lines=tuple(lines))
    if any(re.search(r"\w", line.text) for line in document.lines if not line.aside):
        return document
    if not kind:
        raise Invalid(f"{source_name} has no cells with text; a script has steps in them")
    raise Invalid(
        f"{source_name} is {kind} without text, at most with pictures: write its steps as a script"
    )
