"""Kinds of events that a mission can react to, and the priorities of reactions to them."""

from enum import StrEnum

from argo_compiler.base.message import Message, identifier


class EventKind(StrEnum):
    """Kind of event that may occur, other than the end of an action.

    These are the competition's events (thesis 1.2), and events that report that one of them is
    over.
    """

    GAS_LEAK = "gas_leak"
    HOT_SPOT = "hot_spot"
    ABNORMAL_SOUND = "abnormal_sound"
    """of a pump"""
    PLATFORM_ALARM = "platform_alarm"
    """the general platform alarm, GPA"""
    POSITIVE_OBSTACLE = "positive_obstacle"
    """an object blocks the path"""
    NEGATIVE_OBSTACLE = "negative_obstacle"
    """a part of the ground is missing on the path"""
    LOW_BATTERY = "low_battery"
    CONNECTION_LOST = "connection_lost"
    EMERGENCY_STOP = "emergency_stop"
    DYSFUNCTION = "dysfunction"
    """of the robot itself"""
    ABNORMAL_READING = "abnormal_reading"
    """a measured value outside the checkpoint's nominal range"""
    TIME_UP = "time_up"
    """the mission's maximum duration is over; the executor raises it by itself"""
    ALL_CLEAR = "all_clear"
    """a danger is over"""
    BATTERY_CHARGED = "battery_charged"
    CONNECTION_RESTORED = "connection_restored"


def event_text(event: EventKind) -> Message:
    """Return an event in words, such as `gas leak`."""
    return identifier(event.replace("_", " "))


DEFAULT_PRIORITIES = {
    EventKind.EMERGENCY_STOP: 100,
    EventKind.GAS_LEAK: 95,
    EventKind.PLATFORM_ALARM: 90,
    EventKind.HOT_SPOT: 80,
    EventKind.DYSFUNCTION: 70,
    EventKind.LOW_BATTERY: 60,
    EventKind.TIME_UP: 50,
    EventKind.CONNECTION_LOST: 40,
    EventKind.NEGATIVE_OBSTACLE: 30,
    EventKind.POSITIVE_OBSTACLE: 25,
    EventKind.ABNORMAL_SOUND: 20,
    EventKind.ABNORMAL_READING: 10,
    EventKind.ALL_CLEAR: 3,
    EventKind.BATTERY_CHARGED: 2,
    EventKind.CONNECTION_RESTORED: 1,
}
"""priority of a reaction that has none of its own, by how bad its event is: dangers to people
first, then to the robot, then to the mission"""
