"""How large plans may be, and which texts names may be."""

import re
import unicodedata
from collections.abc import Iterator

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Mission
from argo_planner.service.core.change import MissionChange
from argo_planner.service.core.refusals import PlanTooLarge

MOST_TASKS = 10_000
"""of a plan"""
MOST_GROUPS = 2_000
LONGEST_NAME = 200
"""characters of a name"""
LONGEST_TEXT = 20_000
"""characters of each text in the header"""

_BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""letters and signs that nothing is drawn of"""
_UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""control characters, those that turn the direction of what follows, and halves of characters"""


def _seen(character: str) -> bool:
    return unicodedata.category(character)[0] in "LNPSM" and character not in _BLANK


def require_name(name: str, what: str) -> None:
    """Raises Invalid for what can't be shown to people as a name; any other text can be one."""
    if not any(map(_seen, name)):
        raise Invalid(f"{what} needs a name that can be seen: give it one")
    if len(name) > LONGEST_NAME:
        raise Invalid(
            f"{what} has a name of {len(name)} characters: give it one of at most {LONGEST_NAME}"
        )
    if found := _UNSEEN.search(name):
        raise Invalid(
            f"the name of {what} has a character that can't be seen (U+{ord(found[0]):04X}): "
            "leave it out"
        )


def require_fitting(mission: Mission, change: MissionChange) -> None:
    """Raises PlanTooLarge or Invalid if a change makes a mission of a size, or of names, that the
    service does not take."""
    for count, most, what in (
        (len(mission.tasks), MOST_TASKS, "tasks"),
        (len(mission.groups), MOST_GROUPS, "groups"),
    ):
        if count > most:
            raise PlanTooLarge(
                f"the plan would have {count} {what}, and may have {most}: divide it into several"
            )
    for what, name in _names(change):
        require_name(name, what)
    for field, value in (change.header.given_fields() if change.header else {}).items():
        if isinstance(value, str) and len(value) > LONGEST_TEXT:
            raise PlanTooLarge(
                f"`{field}` has {len(value)} characters, and may have {LONGEST_TEXT}: shorten it"
            )


def _names(change: MissionChange) -> Iterator[tuple[str, str]]:
    if change.tasks:
        yield from (("a task", task.name) for task in change.tasks.put)
    if change.groups:
        yield from (("a group", group.name) for group in change.groups.put)
