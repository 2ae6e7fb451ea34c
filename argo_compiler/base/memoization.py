"""Memoization of functions and properties of one frozen object."""

from collections import deque
from collections.abc import Callable
from functools import cached_property, wraps
from threading import RLock
from typing import Any, TypeVar
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


def thread_safe_cached_property(function: Callable[[Any], Value]) -> cached_property[Value]:
    """Return a cached property that is computed only once even if several threads need it.

    Since CPython 3.12, threads that need a `functools.cached_property` at the same time each
    compute it.
    """
    name = function.__name__
    lock = RLock()

    @wraps(function)
    def compute(instance: Any) -> Value:
        with lock:
            values = vars(instance)
            if name not in values:
                values[name] = function(instance)
            value: Value = values[name]
            return value

    return cached_property(compute)
