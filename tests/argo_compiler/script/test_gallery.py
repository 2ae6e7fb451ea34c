"""The gallery of phrasings in the page on scripts: each becomes what stands beside it."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.script.write.reading import read_back
from argo_env.navigation import Navigator
from argo_env.planning.catalog import make_catalog
from argo_env.robot.spec import load_robot
from argo_env.site import load_site
from tests.whole_scripts import import_whole

PAGE = Path(__file__).parents[3] / "docs" / "script.md"
START = "Start in starting area 1."
ASKED = "error: "
_ROW = re.compile(r"^\|(.*?)(?<!\\)\|(.*)\|$")
_CODE = re.compile(r"`` (.*?) ``|`(.*?)`")
_NUMBER = re.compile(r"^\d+\. ")


@dataclass(frozen=True)
class Row:
    """A row of the gallery."""

    said: tuple[str, ...]
    behind: tuple[str, ...]
    """what stands behind the phrase"""
    becomes: tuple[str, ...]


def _cells(line: str) -> list[str]:
    found = _ROW.match(line)
    assert found is not None, line
    return [cell.strip().replace("\\|", "|") for cell in found.groups()]


def _codes(cell: str) -> list[str]:
    return [one or two for one, two in _CODE.findall(cell)]


def rows(page: str) -> Iterator[Row]:
    """All rows; a table's first heading may name a line that stands behind each phrase."""
    gallery = page.partition("\n## A gallery of phrasings\n")[2].partition("\n## ")[0]
    for table in re.findall(r"^\| script.*\n\|---\|---\|\n((?:\|.*\n)+)", gallery, re.MULTILINE):
        heading = gallery[: gallery.index(table)].splitlines()[-2]
        behind = tuple(_codes(_cells(heading)[0]))
        for line in table.splitlines():
            said, becomes = _cells(line)
            yield Row(tuple(_codes(said)), behind, tuple(becomes.split("<br>")))


@cache
def site() -> Catalog:
    return make_catalog(Navigator(load_site("umad"), load_robot()))


def reading(*lines: str) -> list[str]:
    """What a script becomes: the lines of `argo explain`, each with its marks behind it."""
    start = f"1. {START}" if lines[0].startswith("2.") else START
    result = import_whole("\n".join([start, *lines]), site())
    found = read_back(result.mission, site(), result.diagnostics)
    said: list[str] = []
    for entry in found.entries:
        number = "" if entry.step is None else f"{entry.step}. "
        said.append(number + ". ".join(s.rstrip(".") for s in entry.sentences))
        said += [f"assumed: {one}" for one in entry.assumed]
    said += [f"assumed: {one}" for one in found.assumed]
    said += [f"no effect: {d.message}" for d in found.no_effect]
    said += [f"warning: {d.message}" for d in found.warnings]
    return said


@cache
def _frame(behind: tuple[str, ...]) -> tuple[str, ...]:
    """What the script becomes without the phrase."""
    return tuple(reading(*behind) if behind else reading("Check #1.")[:-1])


def beside(said: tuple[str, ...], behind: tuple[str, ...]) -> list[str]:
    """What a phrase becomes, without what stands around it; or what is asked."""
    try:
        found = reading(*said, *behind)
    except DiagnosticError as error:
        errors = [d for d in error.diagnostics if d.severity is Severity.ERROR]
        return [ASKED + error.message for error in errors]
    framed = Counter(_NUMBER.sub("", line) for line in _frame(behind))
    kept: list[str] = []
    for line in found:
        plain = _NUMBER.sub("", line)
        if framed[plain]:
            framed[plain] -= 1
        else:
            kept.append(line)
    return kept


def _said(line: str) -> str:
    """A line of the page as plain text."""
    plain = re.sub(r"^\*(.*?)\*", r"\1", line)
    return _CODE.sub(lambda found: found[1] or found[2], plain)


ROWS = list(rows(PAGE.read_text(encoding="utf-8")))


@pytest.mark.parametrize("row", ROWS, ids=[" / ".join(row.said) for row in ROWS])
def test_what_a_phrase_becomes(row: Row) -> None:
    found = [_said(line) for line in beside(row.said, row.behind)]
    expected = [_said(line) for line in row.becomes]
    for i, line in enumerate(expected):
        if line.endswith(" ...") and i < len(found):
            expected[i] = found[i] if found[i].startswith(line[:-4]) else line
        elif not _NUMBER.match(line) and i < len(found):
            found[i] = _NUMBER.sub("", found[i])
    assert found == expected


def test_there_is_a_gallery() -> None:
    assert len(ROWS) > 100


def test_the_example_is_said_back_as_the_page_has_it() -> None:
    page = PAGE.read_text(encoding="utf-8")
    (script,) = re.findall(r"```script\n(.*?)```", page, re.DOTALL)
    said = re.findall(r"```explained\n(.*?)```", page, re.DOTALL)
    result = import_whole(script, site())
    assert [read_back(result.mission, site(), result.diagnostics).text] == said
