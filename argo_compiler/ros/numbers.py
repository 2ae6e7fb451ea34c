"""The constants of the messages for the enumerations of the language."""

from argo_compiler.il import (
    Action,
    Afterwards,
    ConditionType,
    EventKind,
    Mode,
    OnFailure,
    Order,
    Response,
    Stop,
)
from argo_compiler.ros.types import RosTypes


class Numbers:
    """A table for each enumeration, read from the definitions themselves."""

    def __init__(self, types: RosTypes) -> None:
        self.mode = types.numbers("MissionSpecification", Mode, "MODE_")
        self.order = types.numbers("MissionSpecification", Order, "ORDER_")
        self.action = types.numbers("MissionTask", Action)
        self.on_failure = types.numbers("MissionTask", OnFailure, "ON_FAILURE_")
        # Some compare a value, others look at the reading: the constants have two prefixes.
        self.condition = {
            type: types.constant("MissionCondition", type.value) for type in ConditionType
        }
        self.stop = types.numbers("MissionGroup", Stop)
        self.hard = {
            hard: types.constant("MissionWindow", name)
            for hard, name in ((True, "HARD"), (False, "SOFT"))
        }
        self.event = types.numbers("MissionReaction", EventKind)
        self.response = types.numbers("MissionReaction", Response, "RESPONSE_")
        self.afterwards = types.numbers("MissionReaction", Afterwards, "AFTERWARDS_")
