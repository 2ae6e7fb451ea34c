"""Codes of diagnostics about missions as ROS messages."""

from argo_compiler.diagnostics.codes.code import error, warning

ROS = {
    "ros.broken-bag": error("The bag can't be read.", "Record or copy it again."),
    "ros.compressed": error(
        "The bag is compressed in a way that can't be unpacked.", "Decompress it first."
    ),
    "ros.no-mission": error("The bag has no mission.", "Record the mission's topic."),
    "ros.not-a-bag": error("The path is not a bag.", "Name a ROS 1 bag or a rosbag2 folder."),
    "ros.orientation": error(
        "A pose is rotated about another axis than z.", "Set a rotation about z only."
    ),
    "ros.other-definitions": error(
        "The bag was written with other definitions of the messages.",
        "Build Argo's package of messages and record again.",
    ),
    "ros.several-missions": error("The bag holds more than one mission.", "Keep one of them."),
    "ros.unsupported-version": error(
        "The message has a version that this Argo does not know.",
        "Use the version of Argo that wrote it.",
    ),
    "ros.velocity": warning(
        "The velocity of the drive to a task depends on the task before it.",
        "A velocity is that of the drive to a task: set it at that task.",
    ),
    "ros.wrong-field": error(
        "A field of the message has an invalid value.", "Publish a valid value."
    ),
    "ros.wrong-type": error(
        "The topic has messages of another type.", "Publish a mission's specification."
    ),
}
