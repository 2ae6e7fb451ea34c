"""Memoization of functions of one frozen object."""

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import ref

Key = TypeVar("Key")
Value = TypeVar("Value")
_CACHE_SIZE = 4


def cache_last_results_by_identity(function: Callable[[Key], Value]) -> Callable[[Key], Value]:
    """Return the function with a cache of its last results, by the identity of its argument.

    It serves functions that are called several times with one mission: by an edit, by the check of
    its result, and by the report on it. The cache does not keep the arguments alive.
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
