"""Check that a choice in a person's own words is understood once it is taken."""

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
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
)
"""how codes of errors begin because of which a sentence stays open, whatever stands around it"""


def is_understood(sentences: Sentences, known: Known) -> bool:
    """Return True if sentences have one meaning behind the checkpoints that were read before."""
    memory = known.memory
    before = [c for c in memory.so_far.values() if c not in memory.last]
    context = [f"Check {checkpoint_words(some)}." for some in (before, memory.last) if some]
    text = "\n".join([*(context or ["Wait for 1 minute."]), " ".join(sentences)])
    return not any(
        one.severity is Severity.ERROR and one.code.startswith(_OPEN)
        for one in _diagnostics(text, known)
    )


def _diagnostics(text: str, known: Known) -> tuple[Diagnostic, ...]:
    """Return the diagnostics of a script."""
    catalog = known.catalog
    places = [place.name for place in catalog.places]
    area = known.start_area or next((area.number for area in catalog.areas), None)
    try:
        script = parse(text, places, names=[c.name for c in catalog.checkpoints])
        return resolve_script(script, catalog, area).diagnostics
    except DiagnosticError as error:
        return error.diagnostics
