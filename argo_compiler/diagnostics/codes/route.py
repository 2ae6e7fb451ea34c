"""The codes of diagnostics about the requirements of an order."""

from argo_compiler.diagnostics.codes.code import error

ROUTE = {
    "route.duplicate-key": error(
        "A key stands twice in one mapping of a file of requirements.",
        "Remove one of the two.",
    ),
    "route.not-yaml": error(
        "A file of requirements is no YAML.",
        "Correct it at the mark.",
    ),
    "route.wrong-field": error(
        "A field of a file of requirements is missing, unknown or has an impossible value.",
        "See `docs/routes.md` for what there is.",
    ),
}
