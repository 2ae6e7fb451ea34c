"""The form that TSPLIB and OPLib share: keywords with values, and sections of numbers.

Of the readers that are kept up, vrplib 2.2 takes each line of a matrix for a row of it, where these
files break rows at will, leaves Euclidean distances unrounded, and knows no pseudo-Euclidean ones
and no lines in its messages; tsplib95 has had no release since 2020. So this one is our own. The
form is that of G. Reinelt, "TSPLIB 95", Heidelberg 1995, section 1.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from argo_compiler.base.errors import ArgoError
from benchmarks.instances.text import LARGEST, Numbers, Source

_KEYWORD = re.compile(r"\s*([A-Za-z][A-Za-z_0-9]*)\s*(?::\s*(.*?)\s*)?", re.ASCII)


@dataclass(frozen=True)
class Keywords:
    """What a file says. Lines count from 0."""

    source: Source
    values: Mapping[str, tuple[int, str]]
    """by keyword: the line, the value"""
    sections: Mapping[str, range]
    """by keyword, without `_SECTION`: the lines with its numbers"""

    def value(self, keyword: str) -> str:
        """What is given for it. Raises ArgoError if nothing is."""
        return self._given(keyword)[1]

    def number(self, keyword: str) -> int:
        """The whole number that is given for it. Raises ArgoError if none is."""
        line, text = self._given(keyword)
        try:
            number = int(text)
            if abs(number) > LARGEST:
                raise ValueError
        except ValueError:
            said = f"{keyword} `{text[:40]}` is no whole number of up to {LARGEST}"
            raise self.source.wrong(line, said, "correct it there") from None
        return number

    def section(self, keyword: str) -> Numbers:
        """The numbers of a section. Raises ArgoError if there is no such section."""
        lines = self.sections.get(keyword)
        if lines is None:
            raise self.source.wrong(
                None, f"it has no {keyword}_SECTION", "add it, or is the file cut off?"
            )
        return Numbers(self.source, lines)

    def wrong(self, keyword: str, what: str, way_out: str) -> ArgoError:
        """The error at the keyword's line."""
        return self.source.wrong(self.values[keyword][0], what, way_out)

    def line(self, keyword: str) -> int:
        """Where the keyword stands. Raises ArgoError if it doesn't."""
        return self._given(keyword)[0]

    def _given(self, keyword: str) -> tuple[int, str]:
        if keyword not in self.values:
            raise self.source.wrong(None, f"it has no {keyword}", f"add a line `{keyword}: ...`")
        return self.values[keyword]


def read_keywords(source: Source) -> Keywords:
    """What the file says. Raises ArgoError at a line that is neither keyword nor number, or that
    says again what was said."""
    values: dict[str, tuple[int, str]] = {}
    sections: dict[str, range] = {}
    line = 0
    while line < len(source.lines):
        text = source.lines[line].strip()
        line += 1
        if text.upper() == "EOF":
            break
        if not text:
            continue
        match = _KEYWORD.fullmatch(text)
        if match is None:
            raise source.wrong(
                line - 1,
                f"`{text[:40]}` is no keyword with its value",
                "is this a TSPLIB, OPLib or TSPTW file?",
            )
        keyword, value = match[1].upper(), match[2] or ""
        if keyword in values or keyword.removesuffix("_SECTION") in sections:
            if keyword == "COMMENT":
                continue
            raise source.wrong(line - 1, f"{keyword} stands here again", "remove one of the two")
        if keyword.endswith("_SECTION"):
            end = line
            while end < len(source.lines) and not _KEYWORD.fullmatch(source.lines[end]):
                end += 1
            sections[keyword.removesuffix("_SECTION")] = range(line, end)
            line = end
        else:
            values[keyword] = (line - 1, value)
    return Keywords(source, values, sections)
