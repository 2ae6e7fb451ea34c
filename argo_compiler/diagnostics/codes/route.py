"""Codes of diagnostics about the requirements of an order."""

from argo_compiler.diagnostics.codes.code import error

ROUTE = {
    "route.duplicate-key": error(
        "A mapping in a file of requirements has the same key twice.",
        "Remove one of the two.",
    ),
    "route.not-yaml": error(
        "A file of requirements is not YAML.",
        "Correct it at the mark.",
    ),
    "route.wrong-field": error(
        "A field of a file of requirements is missing, unknown or has an invalid value.",
        "Correct the field; the page `routes` of the documentation lists them.",
    ),
}
