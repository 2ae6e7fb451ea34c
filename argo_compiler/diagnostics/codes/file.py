"""Codes of diagnostics about mission files."""

from argo_compiler.diagnostics.codes.code import error, warning

FILE = {
    "file.beyond-limits": error(
        "The file takes more time or memory to be read than any mission, or makes the library that "
        "reads it crash.",
        "Check that it is the right file; record or export the mission again.",
    ),
    "file.directory": error("A folder is given instead of a file.", "Name the file in it."),
    "file.duplicate-key": error(
        "An object of the JSON file has the same field twice; readers would disagree on which "
        "one counts.",
        "Remove one of the two.",
    ),
    "file.meaning-changed": warning(
        "The file has an older version of the mission format, and one of its fields has another "
        "meaning now.",
        "Check the field in the message, and save the mission again.",
    ),
    "file.missing": error("There is no such file.", "Check the path."),
    "file.not-a-mission": error(
        "The file is JSON, but not an object with a mission's fields.",
        "Name a file that an import or the planner has written.",
    ),
    "file.not-json": error(
        "The file is not JSON: a comma, quote or bracket is missing, or a number or text is not "
        "allowed.",
        "Correct the file at the mark.",
    ),
    "file.not-text": error(
        "The file is not UTF-8 text.", "Save it as UTF-8, or name the right file."
    ),
    "file.too-deep": error(
        "The JSON is nested far deeper than any mission.", "Check that it is the right file."
    ),
    "file.too-large": error(
        "The file is larger than 16 MB, far above any mission.", "Check that it is the right file."
    ),
    "file.unreadable": error("The file can't be read.", "Check the path and its permissions."),
    "file.unsupported-version": error(
        "The file has a version of the mission format that this Argo does not know.",
        "Use a newer Argo, or save the mission again.",
    ),
    "file.unwritable": error("The file can't be written.", "Choose another path."),
    "file.wrong-field": error(
        "A field of the mission is unknown, missing, or has a value of the wrong kind.",
        "Correct the field; the JSON Schema of missions states its valid values.",
    ),
}
