"""Response: leave, as the rules of a company demand, under one name.

In a mission file, `{"event": "gas_leak", "response": "evacuate"}` stands for all of these fields.
Fields that the mission gives besides replace them.
"""

from collections.abc import Mapping

from argo_compiler.il import EventKind


def evacuate(event: EventKind) -> Mapping[str, object]:
    """Return the fields of the reaction: return to the dock, and stay until the danger is over."""
    return {
        "response": "return",
        "until": "all_clear",
        "hold_limit": 1800.0,
        "on_limit": "wait",
        "afterwards": "wait",
        "priority": 95 if event is EventKind.GAS_LEAK else 90,
    }
