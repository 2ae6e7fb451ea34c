"""Codes of diagnostics about missions of isar."""

from argo_compiler.diagnostics.codes.code import error, warning

ISAR = {
    "isar.dropped": warning(
        "A part of the isar mission has no counterpart and is left out.",
        "Check whether the mission is complete without it.",
    ),
    "isar.home": error(
        "A task of the isar mission returns home, but has no usable pose of the home.",
        "Give the task the pose of the home in the site's frame, or remove the task.",
    ),
    "isar.inspection": error(
        "A task of the isar mission has no inspection.", "State what is to be inspected."
    ),
    "isar.inspection-type": error(
        "The isar mission asks for an inspection other than an image.",
        "Argo reads checkpoints in images: use one of those types.",
    ),
    "isar.pose-moved": warning(
        "A checkpoint can't be read from the isar mission's pose on the planned site, so the "
        "nearest pose that sees it takes its place.",
        "Check that the robot may stand there.",
    ),
    "isar.tag": error(
        "An inspection has no tag, so its checkpoint is unknown.",
        "Give it the checkpoint's tag.",
    ),
    "isar.wrong-field": error(
        "A field of the isar mission is missing or has a value of the wrong kind.",
        "Correct the isar mission.",
    ),
}
