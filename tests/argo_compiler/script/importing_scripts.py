"""All scripts of the suite that import: people's, those of the gallery, and generated ones."""

import os
import random
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script import LineDecision, LineState, import_script
from argo_env.planning.opening import open_site
from tests.argo_compiler.script.conftest import CATALOG
from tests.argo_compiler.script.sentences import Writer, script
from tests.argo_compiler.script.test_gallery import ROWS, START
from tests.campaigns.fuzz.laws import FRAME
from tests.campaigns.fuzz.sentences import english_generator, text_of

OURS = Path(__file__).parent / "people"
_GIVEN = ("ARGO_CORPUS", "ARGO_ORIGINALS", "ARGO_MISREAD", "ARGO_DRAFTS")
_MOST_TURNS = 6


@dataclass(frozen=True)
class ImportingScript:
    """A script, and what a person has decided on for it."""

    name: str
    text: str
    catalog: Catalog
    decisions: tuple[LineDecision, ...] = ()
    start_area: int | None = None
    within: tuple[int, int] | None = None
    """the part that is of interest; None: all of it"""


@cache
def _site() -> Catalog:
    return open_site("umad").catalog


@dataclass(frozen=True)
class WrittenScript:
    """A script that may import, as it is or after decisions."""

    name: str
    text: str
    decide: bool = False
    """whether a person is played who confirms what is proposed and sets aside what is open"""

    def imported(self) -> ImportingScript | None:
        """Return the script with the decisions that complete it; None if it is refused."""
        for area in (None, 1):
            decisions: tuple[LineDecision, ...] = ()
            for _ in range(_MOST_TURNS):
                try:
                    draft = import_script(self.text, _site(), start_area=area, decisions=decisions)
                except DiagnosticError:
                    return None
                if draft.mission is not None:
                    return ImportingScript(self.name, self.text, _site(), decisions, area)
                if not draft.left or not self.decide:
                    break
                opened = [line.label for line in draft.left if line.state is LineState.OPEN]
                decisions = draft.set_aside(opened) if opened else draft.confirm()
        return None


def written_scripts() -> list[WrittenScript]:
    """Return the rows of the gallery, the scripts of people, and those of the folders that the
    environment names."""
    found = []
    for row in ROWS:
        start = f"1. {START}" if row.said[0].startswith("2.") else START
        text = "\n".join([start, *row.said, *row.behind])
        found.append(WrittenScript(f"gallery: {row.said[0]}", text))
    folders = [OURS, *(Path(os.environ[name]) for name in _GIVEN if name in os.environ)]
    for folder in folders:
        for path in sorted(folder.glob("*.txt")):
            text = path.read_bytes().decode("utf-8")
            decide = folder is not OURS
            found.append(WrittenScript(f"{folder.name}/{path.stem}", text, decide))
    return found


def generated_scripts(seeds: range) -> Iterator[ImportingScript]:
    """Yield sentences made from the grammar in a frame of others, and for each fifth seed a
    protocol of many sentences, as far as they import."""
    for seed in seeds:
        if seed % 5 == 0:
            text, within = script(*Writer(seed).protocol()), None
        else:
            sentence = text_of(english_generator(random.Random(seed)).sentence())
            start = FRAME.index("{}")
            text, within = FRAME.format(sentence), (start, start + len(sentence))
        try:
            draft = import_script(text, CATALOG)
        except DiagnosticError:
            continue
        if draft.mission is not None:
            yield ImportingScript(f"generated {seed}", text, CATALOG, within=within)
