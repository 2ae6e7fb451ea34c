"""Names that are nearly right."""

from collections.abc import Collection

_ALIKE = 60  # of 100; `MESURE 4` and `MEASURE 4` have 94, `retry` and `retries` 67
_MOST = 20_000  # names that are compared; a plan with more has to do without


def nearest_name(name: str, known: Collection[str]) -> str | None:
    """The known name that is most like `name`; None if none is like it."""
    if len(known) > _MOST:
        return None
    from rapidfuzz import fuzz, process  # for files with faults only

    found = process.extractOne(name, list(known), scorer=fuzz.ratio, score_cutoff=_ALIKE)
    return found[0] if found else None
