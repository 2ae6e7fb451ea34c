"""Reverting the changes of a revision, unless the same parts of the mission were changed later."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from argo_compiler.il import Group, Mission, Reaction, Task
from argo_planner.service.core.change import (
    HEADER,
    LISTS,
    insert_after_predecessors,
    item_name,
    new_and_moved_names,
)

Named = Task | Group | Reaction
Subject = tuple[str, str]
"""a kind of thing (`header`, `tasks`, `groups`, `reactions`) and its name"""


@dataclass(frozen=True)
class RevertResult:
    """Mission in which a change is reverted, or the header fields and items that prevent this."""

    mission: Mission
    """unchanged if `changed_since` is not empty"""
    changed_since: tuple[Subject, ...] = ()
    """header fields and items that were changed again, so that the change can't be reverted"""


def revert(now: Mission, before: Mission, after: Mission) -> RevertResult:
    """Return the mission `now` without the change that earlier led from `before` to `after`.

    Each changed field of the header, of a task, of a group or of a reaction gets its value from
    `before`, and each moved item is moved back. If the value or position of one of them in `now`
    differs from that in `after`, nothing is reverted: the result has the mission `now`, and names
    these parts.
    """
    update: dict[str, Any] = {}
    since: list[Subject] = []
    for field in HEADER:
        was, became = getattr(before, field), getattr(after, field)
        if was != became:
            if getattr(now, field) != became:
                since.append(("header", field))
            update[field] = was
    for kind in LISTS:
        merged = _ListMerge(getattr(now, kind), getattr(before, kind), getattr(after, kind))
        if merged.differs:
            update[kind] = merged.items()
            since += [(kind, name) for name in merged.changed_since()]
    if since:
        return RevertResult(now, tuple(since))
    return RevertResult(now.model_copy(update=update))


class _ListMerge:
    """Three states of one list of a mission: now, before the change, and after it."""

    def __init__(
        self, now: Sequence[Named], before: Sequence[Named], after: Sequence[Named]
    ) -> None:
        self.differs = before is not after and before != after
        if not self.differs:
            return
        self._now, self._before, self._after = _by_name(now), _by_name(before), _by_name(after)
        self._moved = {name for name, _ in new_and_moved_names([*self._before], [*self._after])}
        self._moved |= self._before.keys() - self._after.keys()

    def changed_since(self) -> list[str]:
        """Return the names of changed items that differ now from their state after the change."""
        names = []
        for name in {**self._before, **self._after}:
            was, became, is_now = (m.get(name) for m in (self._before, self._after, self._now))
            if was is became or was == became:
                unchanged = is_now is not None or name not in self._moved
            elif was is None or became is None or is_now is None:
                unchanged = is_now is became or is_now == became
            else:
                unchanged = all(
                    getattr(is_now, f) == getattr(became, f) for f in _changed_fields(was, became)
                )
            if not unchanged or (
                became is not None and name in self._moved and self._has_moved(name)
            ):
                names.append(name)
        return names

    def items(self) -> tuple[Named, ...]:
        """Return the list with the change reverted."""
        items = {n: i for n, i in self._now.items() if n not in self._after or n in self._before}
        for name, was in self._before.items():
            became, is_now = self._after.get(name), self._now.get(name)
            if became is None or is_now is None:
                items[name] = was
            elif was is not became and was != became:
                old = {field: getattr(was, field) for field in _changed_fields(was, became)}
                items[name] = is_now.model_copy(update=old)
        unmoved = [n for n in self._now if n in items and n not in self._moved]
        ordered = {*unmoved}
        placed: list[tuple[str, str | None]] = []
        last: str | None = None
        for name in self._before:
            if name in self._moved:
                placed.append((name, last))
                ordered.add(name)
            if name in ordered:
                last = name
        return tuple(items[name] for name in insert_after_predecessors(unmoved, placed))

    def _has_moved(self, name: str) -> bool:
        """Return True if the item has another predecessor now than after the change.

        Items that are not in both lists do not count as predecessors.
        """
        after, now = [*self._after], [*self._now]
        return _last_known(after[: after.index(name)], self._now) != _last_known(
            now[: now.index(name)], self._after
        )


def _by_name(items: Sequence[Named]) -> dict[str, Named]:
    return {item_name(item): item for item in items}


def _changed_fields(was: Named, became: Named) -> list[str]:
    return [f for f in type(was).model_fields if getattr(was, f) != getattr(became, f)]


def _last_known(names: Sequence[str], known: Mapping[str, Named]) -> str | None:
    return next((name for name in reversed(names) if name in known), None)
