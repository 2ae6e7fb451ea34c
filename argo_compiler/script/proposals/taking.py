"""Check that a choice in a person's own words is understood once it is taken."""

import re
from functools import lru_cache

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.script.parsing.parser import parse
from argo_compiler.script.proposals.frames import Sentences
from argo_compiler.script.proposals.known import Known
from argo_compiler.script.proposals.mentions import checkpoint_words
from argo_compiler.script.resolve.importing import resolve_script

_OPEN = (
    "script.ambiguous",
    "script.not-understood",
    "script.unfinished",
    "script.question",
    "script.endless-repeat",
    "script.condition",
    "script.unit",
)
"""how codes of errors begin because of which a sentence stays open, whatever stands around it"""


_PLAIN = re.compile(
    r"(?:Check|Do not check|Delete) (?:checkpoint \d+(?:, | and |\.$| in any order\.$))+"
    r"|(?:Start in|Return to the docking station in|End of the mission:) starting area \d\."
    r"|Return to the docking station\.|(?:Wait for|Maximum duration:) \d+ minutes?\."
)
"""sentences that always have one meaning"""


def is_understood(sentences: Sentences, known: Known) -> bool:
    """Return True if sentences have one meaning behind the checkpoints that were read before."""
    if all(map(_PLAIN.fullmatch, sentences)):
        return True
    memory = known.memory
    before = [c for c in memory.so_far.values() if c not in memory.last]
    context = [f"Check {checkpoint_words(some)}." for some in (before, memory.last) if some]
    text = "\n".join([*(context or ["Wait for 1 minute."]), " ".join(sentences)])
    area = known.start_area or next((area.number for area in known.catalog.areas), None)
    return _has_one_meaning(text, known.catalog, area)


@lru_cache(maxsize=1024)  # a script is read anew after each decision
def _has_one_meaning(text: str, catalog: Catalog, area: int | None) -> bool:
    """Return True if nothing in a script would be asked about."""
    places = [place.name for place in catalog.places]
    try:
        script = parse(text, places, names=[c.name for c in catalog.checkpoints])
        found = resolve_script(script, catalog, area).diagnostics
    except DiagnosticError as error:
        found = error.diagnostics
    return not any(d.severity is Severity.ERROR and d.code.startswith(_OPEN) for d in found)
