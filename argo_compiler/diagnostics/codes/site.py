"""Codes of diagnostics about descriptions of sites, and about missions that a site rules out."""

from argo_compiler.diagnostics.codes.code import error, warning

SITE = {
    "site.duplicate-key": error(
        "A mapping in the site's file has the same key twice.", "Remove one of the two."
    ),
    "site.faster-than-robot": warning(
        "A task requires a higher speed than the robot is known to drive.",
        "Set at most the robot's own speed.",
    ),
    "site.not-seen-from-pose": warning(
        "A task measures from a pose from which its checkpoint can't be seen on the planned site.",
        "Give another pose, or none, so that the robot chooses one.",
    ),
    "site.not-yaml": error("The site's file is not YAML.", "Correct the file at the mark."),
    "site.wrong-field": error(
        "A field of the site is unknown, missing, has an invalid value, or has a name or number "
        "that is already used.",
        "Correct the field; the sites in the Argo package are examples.",
    ),
}
