"""Search for a known name that is similar to a misspelt one."""

from collections.abc import Collection

_ALIKE = 60  # of 100; `MESURE 4` and `MEASURE 4` have 94, `retry` and `retries` 67
_MOST = 20_000  # names that are compared; with more, no name is searched


def nearest_name(name: str, known: Collection[str]) -> str | None:
    """Return the known name that is most similar to `name`, or None if none is similar.

    Returns None as well if there are too many known names to compare.
    """
    if len(known) > _MOST:
        return None
    from rapidfuzz import fuzz, process  # imported late: only invalid files need it

    match = process.extractOne(name, list(known), scorer=fuzz.ratio, score_cutoff=_ALIKE)
    return match[0] if match else None
