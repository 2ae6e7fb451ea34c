"""The words by which the noise of text recognition is healed.

They are the words of the grammars, the names of the catalogue, and the words that the sheets of
the competition are commonly made of.
"""

import re

from argo_compiler.catalog import Catalog

_WORD = re.compile(r"[^\W_](?:[\w'-]*\w)?")

# Only words with which a sheet's free cells are commonly filled: each one more makes it likelier
# that a cut can be read in two ways.
_SHEET_WORDS = """
    a after all an and anomalies anomaly any appendix area areas as at autonomously be before
    begins by catalogue checkpoint checkpoints chosen competition connected control default
    described docked docking during each ends every for found from has have in inspect is it its
    levels listed measured must normal on or outside parked position positions precise preparation
    readings recorded report reported reporting reports robot rules shall should site soon
    specified staff standing starting starts states station team that the their then this to until
    values visit when where which will with within
"""
SHEET_WORDS = frozenset(_SHEET_WORDS.split())

# The words that only lines of a sheet open with, and those that only commands do.
SHEET_MARKS = frozenset(
    [
        "mission's",
        "main",
        "maximum",
        "max",
        "anomaly",
        "specification",
        "real-time",
        "real",
        "after-mission",
        "after",
        "initial",
        "end",
        "checkpoint",
    ]
)
PROTOCOL_MARKS = frozenset(
    [
        "protocol",
        "set",
        "start",
        "let",
        "patrol",
        "check",
        "measure",
        "read",
        "inspect",
        "control",
        "verify",
        "examine",
        "add",
        "insert",
        "delete",
        "remove",
        "move",
        "replace",
        "exchange",
        "go",
        "drive",
        "return",
        "head",
        "repeat",
        "if",
        "when",
        "whenever",
        "hint",
        "note",
        "done",
    ]
)


def catalog_words(catalog: Catalog) -> frozenset[str]:
    """The words of the catalogue's names, in lower case; numbers are not words."""
    names = [
        catalog.site,
        *(c.name for c in catalog.checkpoints),
        *(p.name for p in catalog.places),
    ]
    words = {word for name in names for word in _WORD.findall(name.lower())}
    return frozenset(word for word in words if not word.isdecimal())
