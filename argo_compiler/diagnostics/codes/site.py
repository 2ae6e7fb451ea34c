"""The codes of diagnostics about descriptions of sites."""

from argo_compiler.diagnostics.codes.code import error

SITE = {
    "site.duplicate-key": error(
        "A mapping in the site's file has the same key twice.", "Remove one of the two."
    ),
    "site.not-yaml": error("The site's file is no YAML.", "Correct the file at the mark."),
    "site.wrong-field": error(
        "A field of the site is unknown, missing, has a value that makes no sense, or has a name "
        "or number that something else of the kind has as well.",
        "Correct the field; the sites that Argo ships show how they are written.",
    ),
}
