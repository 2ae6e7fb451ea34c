"""Limits on the size of mission plans, and on the texts that can be names."""

import re
import unicodedata
from collections.abc import Iterator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.il import Mission
from argo_planner.service.core.change import MissionChange
from argo_planner.service.core.refusals import PlanTooLarge

MOST_TASKS = 10_000
"""tasks of one plan"""
MOST_GROUPS = 2_000
LONGEST_NAME = 200
"""characters of a name"""
LONGEST_TEXT = 20_000
"""characters of each text in the header"""

_BLANK = "\u115f\u1160\u2800\u3164\uffa0"
"""letters and signs that are drawn as blanks"""
_INVISIBLE = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""control characters, characters that change the writing direction, and surrogates"""


def _is_visible(character: str) -> bool:
    return unicodedata.category(character)[0] in "LNPSM" and character not in _BLANK


def require_displayable_name(name: str, what: str) -> None:
    """Raise Invalid if a name is invisible, has control characters, or is too long.

    All other texts are allowed. `what` is the thing that is named, for the message.
    """
    if not any(map(_is_visible, name)):
        raise Invalid(
            Message("{what} needs a name with visible characters: give it one", what=what)
        )
    if len(name) > LONGEST_NAME:
        raise Invalid(
            Message(
                "{what} has a name of {count} characters: give it one of at most {longest_name}",
                what=what,
                count=len(name),
                longest_name=LONGEST_NAME,
            )
        )
    if found := _INVISIBLE.search(name):
        raise Invalid(
            Message(
                "the name of {what} has an invisible character (U+{ord:04X}): remove it",
                what=what,
                ord=ord(found[0]),
            )
        )


def require_within_limits(changed_mission: Mission, change: MissionChange) -> None:
    """Raise an error if a mission, after the given change of it, exceeds the service's limits.

    Raises:
        PlanTooLarge: The mission has too many tasks or groups, or a changed header text is too
            long.
        Invalid: A new name of a task or a group can't be shown.
    """
    for count, most, what in (
        (len(changed_mission.tasks), MOST_TASKS, "tasks"),
        (len(changed_mission.groups), MOST_GROUPS, "groups"),
    ):
        if count > most:
            raise PlanTooLarge(
                Message(
                    "the mission would have {count} {what}, but at most {most} are allowed: "
                    "split it",
                    count=count,
                    what=what,
                    most=most,
                )
            )
    for what, name in _names(change):
        require_displayable_name(name, what)
    for field, value in (change.header.given_fields() if change.header else {}).items():
        if isinstance(value, str) and len(value) > LONGEST_TEXT:
            raise PlanTooLarge(
                Message(
                    "`{field}` has {count} characters, but at most {longest_text} are allowed: "
                    "shorten it",
                    field=field,
                    count=len(value),
                    longest_text=LONGEST_TEXT,
                )
            )


def _names(change: MissionChange) -> Iterator[tuple[str, str]]:
    if change.tasks:
        yield from ((Message("a task"), task.name) for task in change.tasks.put)
    if change.groups:
        yield from ((Message("a group"), group.name) for group in change.groups.put)
