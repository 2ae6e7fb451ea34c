"""What a revision changed is put back, as long as nobody has changed the same since."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from argo_compiler.il import Group, Mission, Reaction, Task
from argo_planner.service.core.change import HEADER, LISTS, name_of, placements, put_behind

Named = Task | Group | Reaction
Subject = tuple[str, str]
"""a kind of thing (header, tasks, groups, reactions) and its name"""


@dataclass(frozen=True)
class Reverted:
    """A mission in which a change is put back, or what is in the way of that."""

    mission: Mission
    """as it was, where something is in the way"""
    changed_since: tuple[Subject, ...] = ()


def revert(now: Mission, before: Mission, after: Mission) -> Reverted:
    """Puts back in the mission as it is `now` what is different `after` from `before`.

    A field of the header, of a task, of a group or of a reaction goes back to its value before if
    it still has the one after; what was moved goes back if it still stands there.
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
        merged = _Merge(getattr(now, kind), getattr(before, kind), getattr(after, kind))
        if merged.differs:
            update[kind] = merged.items()
            since += [(kind, name) for name in merged.changed_since()]
    if since:
        return Reverted(now, tuple(since))
    return Reverted(now.model_copy(update=update))


class _Merge:
    """One of a mission's lists, now, before the change and after it."""

    def __init__(
        self, now: Sequence[Named], before: Sequence[Named], after: Sequence[Named]
    ) -> None:
        self.differs = before is not after and before != after
        if not self.differs:
            return
        self._now, self._before, self._after = _by_name(now), _by_name(before), _by_name(after)
        self._moved = {name for name, _ in placements([*self._before], [*self._after])}
        self._moved |= self._before.keys() - self._after.keys()

    def changed_since(self) -> list[str]:
        """The names of what is otherwise now than the change left it."""
        found = []
        for name in {**self._before, **self._after}:
            was, became, is_now = (m.get(name) for m in (self._before, self._after, self._now))
            if was is became or was == became:
                kept = is_now is not None or name not in self._moved
            elif was is None or became is None or is_now is None:
                kept = is_now is became or is_now == became
            else:
                kept = all(getattr(is_now, f) == getattr(became, f) for f in _fields(was, became))
            if not kept or (became is not None and name in self._moved and self._has_moved(name)):
                found.append(name)
        return found

    def items(self) -> tuple[Named, ...]:
        """The list with the change put back."""
        items = {n: i for n, i in self._now.items() if n not in self._after or n in self._before}
        for name, was in self._before.items():
            became, is_now = self._after.get(name), self._now.get(name)
            if became is None or is_now is None:
                items[name] = was
            elif was is not became and was != became:
                old = {field: getattr(was, field) for field in _fields(was, became)}
                items[name] = is_now.model_copy(update=old)
        kept = [n for n in self._now if n in items and n not in self._moved]
        there = {*kept}
        placed: list[tuple[str, str | None]] = []
        last: str | None = None
        for name in self._before:
            if name in self._moved:
                placed.append((name, last))
                there.add(name)
            if name in there:
                last = name
        return tuple(items[name] for name in put_behind(kept, placed))

    def _has_moved(self, name: str) -> bool:
        """Whether something stands elsewhere now than the change left it."""
        after, now = [*self._after], [*self._now]
        return _last_of(after[: after.index(name)], self._now) != _last_of(
            now[: now.index(name)], self._after
        )


def _by_name(items: Sequence[Named]) -> dict[str, Named]:
    return {name_of(item): item for item in items}


def _fields(was: Named, became: Named) -> list[str]:
    """The fields that have other values."""
    return [f for f in type(was).model_fields if getattr(was, f) != getattr(became, f)]


def _last_of(names: Sequence[str], known: Mapping[str, Named]) -> str | None:
    return next((name for name in reversed(names) if name in known), None)
