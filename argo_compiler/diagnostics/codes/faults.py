"""Codes of diagnostics about files of faults."""

from argo_compiler.diagnostics.codes.code import error

FAULTS = {
    "faults.duplicate-key": error(
        "A mapping in the file of faults has the same key twice.", "Remove one of the two."
    ),
    "faults.not-yaml": error("The file of faults is not YAML.", "Correct the file at the mark."),
    "faults.wrong-field": error(
        "A fault is of an unknown kind, or a field of it is unknown, missing, or has an invalid "
        "value.",
        "Correct the field; the page `faults` of the documentation lists kinds and fields.",
    ),
}
