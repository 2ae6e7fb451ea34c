"""The codes of diagnostics about descriptions of sites, and about what they do not let be done."""

from argo_compiler.diagnostics.codes.code import error, warning

SITE = {
    "site.duplicate-key": error(
        "A mapping in the site's file has the same key twice.", "Remove one of the two."
    ),
    "site.faster-than-robot": warning(
        "A task asks for a speed that the robot is not known to drive at.",
        "Ask for at most the robot's own speed.",
    ),
    "site.not-seen-from-pose": warning(
        "A task measures from a pose that does not see its checkpoint where the plan has it.",
        "Give another pose, or none: then the robot chooses one.",
    ),
    "site.not-yaml": error("The site's file is no YAML.", "Correct the file at the mark."),
    "site.wrong-field": error(
        "A field of the site is unknown, missing, has a value that makes no sense, or has a name "
        "or number that something else of the kind has as well.",
        "Correct the field; the sites that Argo ships show how they are written.",
    ),
}
