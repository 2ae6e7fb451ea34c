"""Functions that remember what they found of the objects that they were asked about last."""

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import ref

Asked = TypeVar("Asked")
Found = TypeVar("Found")
_LAST = 4


def remembering(function: Callable[[Asked], Found]) -> Callable[[Asked], Found]:
    """The function, which does its work once for the same frozen object: an edit, the check of its
    result and whoever tells of it ask the same of one mission. Objects are not kept alive."""
    known: deque[tuple[ref[Asked], Found]] = deque(maxlen=_LAST)

    @wraps(function)
    def remembered(asked: Asked) -> Found:
        for object, found in tuple(known):
            if object() is asked:
                return found
        found = function(asked)
        known.append((ref(asked), found))
        return found

    return remembered
