"""The codes of diagnostics about missions as ROS messages."""

from argo_compiler.diagnostics.codes.code import error, warning

ROS = {
    "ros.broken-bag": error("The bag can't be read.", "Record or copy it anew."),
    "ros.compressed": error(
        "The bag is compressed in a way that can't be unpacked.", "Decompress it first."
    ),
    "ros.no-mission": error("The bag has no mission.", "Record the mission's topic."),
    "ros.not-a-bag": error("The path is no bag.", "Name a ROS 1 bag or a rosbag2 folder."),
    "ros.orientation": error("A pose is turned about another axis than z.", "Set a turn about z."),
    "ros.other-definitions": error(
        "The bag was written with other definitions of the messages.",
        "Build Argo's package of messages and record anew.",
    ),
    "ros.several-missions": error("The bag holds more than one mission.", "Keep one of them."),
    "ros.unsupported-version": error(
        "The message has a version that this Argo does not know.", "Use the Argo that it is from."
    ),
    "ros.velocity": warning(
        "A task is driven to at different velocities, by where the robot comes from.",
        "A velocity belongs to the way to a task: set it there.",
    ),
    "ros.wrong-field": error(
        "A field of the message has a value that makes no sense.", "Publish a sound value."
    ),
    "ros.wrong-type": error(
        "The topic has messages of another type.", "Publish a mission's specification."
    ),
}
