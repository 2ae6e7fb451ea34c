"""Memoization of functions of one frozen object."""

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import ref

Key = TypeVar("Key")
Value = TypeVar("Value")
_CACHE_SIZE = 4


def memoized(function: Callable[[Key], Value]) -> Callable[[Key], Value]:
    """Return the function with a cache of its last results, by the identity of its argument.

    An edit, the check of its result and those who report it ask the same of one mission. The cache
    does not keep the objects alive.
    """
    cache: deque[tuple[ref[Key], Value]] = deque(maxlen=_CACHE_SIZE)

    @wraps(function)
    def wrapper(key: Key) -> Value:
        for reference, value in tuple(cache):
            if reference() is key:
                return value
        value = function(key)
        cache.append((ref(key), value))
        return value

    return wrapper
