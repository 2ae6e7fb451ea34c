"""A script as a whole: its syntax tree, and the pieces of text that it was read from."""

from collections.abc import Mapping
from dataclasses import field
from typing import NamedTuple

from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.script.documents.source import ScriptText, Source
from argo_compiler.script.layout.forms import FormRow
from argo_compiler.script.sentences.tree.script import ScriptHeader, ScriptStep


class Piece(NamedTuple):
    """A sentence, a field, a row or a remark of a script, and whether it has an effect."""

    text: ScriptText
    """as it is read; its offsets tell which part of the source it is"""
    aside: str = ""
    """for a piece without effect: what it is taken for, such as `a greeting`"""


@dataclass(frozen=True, kw_only=True)
class Script:
    """What a script says."""

    source: Source
    header: ScriptHeader = field(default_factory=ScriptHeader)
    steps: tuple[ScriptStep, ...] = ()
    pieces: tuple[Piece, ...] = ()
    """all text of the script in the order in which it is read, but for blank lines and rules"""
    rows: Mapping[int, FormRow] = field(default_factory=dict)
    """the rows of sheets, by the offset at which their pieces begin"""
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def source_name(self) -> str:
        """The name of the script in messages."""
        return self.source.name

    @property
    def source_text(self) -> str:
        """The text of the script."""
        return self.source.text
