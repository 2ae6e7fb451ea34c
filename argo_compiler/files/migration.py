"""Older mission files: what each version of the format lacked, step by step to the present one."""

from collections.abc import Callable
from typing import Any

VERSION = 3
"""of the mission format that is written"""


def migrate(data: dict[str, Any]) -> dict[str, Any]:
    """The mission's data in the present version. Data of unknown versions stay as they are."""
    version = data.get("version", VERSION)
    while not isinstance(version, bool) and version in _STEPS:
        data = _STEPS[version](data)
        version = data["version"]
    return data


def _to_2(data: dict[str, Any]) -> dict[str, Any]:
    """Version 2 added reactions, failure policies, the dock and inclusive bounds; all may be left
    out, and then mean what version 1 meant."""
    return {**data, "version": 2}


def _to_3(data: dict[str, Any]) -> dict[str, Any]:
    return {**data, "version": 3}


_STEPS: dict[object, Callable[[dict[str, Any]], dict[str, Any]]] = {1: _to_2, 2: _to_3}
