"""Whether the tables of a machine that was read from a file fit together."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_compiler.hfsm.model import Composite, Hfsm, StateTransition


def validate(hfsm: "Hfsm") -> None:
    """Checks what an executor and exporters rely on, in linear time.

    Raises:
        ValueError: a state is missing, doubled or out of place, or a transition can't be taken
            where it stands.
    """
    composites = _composites(hfsm)
    nesting = _Nesting(hfsm.composites)
    leaves = {leaf.id: leaf for leaf in hfsm.leaves}
    if len({*leaves, *composites}) < len(hfsm.leaves) + len(hfsm.composites):
        raise ValueError("two states have the same id")
    parents = {leaf.id: leaf.parent for leaf in hfsm.leaves} | {hfsm.final: hfsm.mission.id}
    for leaf in hfsm.leaves:
        if leaf.parent not in composites:
            raise ValueError(f"there is no composite '{leaf.parent}' around '{leaf.id}'")
    states = {*parents, *composites}
    for composite in hfsm.composites:
        for state in (composite.initial, *composite.children):
            if state not in states:
                raise ValueError(f"there is no state '{state}' in '{composite.id}'")

    def check(
        id: str, parent: str, transitions: Sequence["StateTransition"], completes: str
    ) -> None:
        for t in transitions:
            if (t.target is None) == (t.completes is None):
                raise ValueError(f"a transition of '{id}' has not one of target and completes")
            if t.completes is not None:
                if t.completes != completes:
                    raise ValueError(f"'{id}' can't complete '{t.completes}'")
            elif t.target not in parents or t.domain not in composites:
                raise ValueError(f"there is no state '{t.target}' in '{t.domain}' for '{id}'")
            elif t.domain != parent and not nesting.lies_in(parent, t.domain):
                raise ValueError(f"'{id}' can't take a transition in '{t.domain}'")
            elif t.domain != parents[t.target] and not nesting.lies_in(parents[t.target], t.domain):
                raise ValueError(f"'{t.target}' does not lie in '{t.domain}'")

    completed = {t.completes for t in hfsm.transitions()}
    for leaf in hfsm.leaves:
        check(leaf.id, leaf.parent, leaf.transitions, leaf.parent)
        if leaf.failure:
            check(leaf.id, leaf.parent, (leaf.failure,), "")
        if leaf.missed:
            check(leaf.id, leaf.parent, (leaf.missed,), "")
        last = leaf.transitions[-1] if leaf.transitions else None
        if last is None or last.kind != "default" or last.conditions:
            raise ValueError(f"the last transition of '{leaf.id}' may be impossible")
    for composite in hfsm.composites[1:]:
        check(composite.id, composite.id, composite.transitions, composite.parent or "")
        if composite.timeout:
            check(composite.id, composite.id, (composite.timeout,), composite.id)
        if composite.id not in completed:
            continue
        last = composite.transitions[-1] if composite.transitions else None
        repeat = composite.repeat
        endless = repeat and not (repeat.count or repeat.duration or repeat.until)
        if last is None or (last.kind != "default" and not endless) or last.conditions:
            raise ValueError(f"the last transition of '{composite.id}' may be impossible")


def _composites(hfsm: "Hfsm") -> set[str]:
    known: set[str] = set()
    for composite in hfsm.composites:
        if (composite.parent is None) != (not known):
            raise ValueError(f"the mission alone has no parent, unlike '{composite.id}'")
        if composite.parent is not None and composite.parent not in known:
            raise ValueError(f"composite '{composite.id}' stands before its parent")
        known.add(composite.id)
    if not hfsm.composites or hfsm.composites[0].id != "mission":
        raise ValueError("there is no composite 'mission'")
    return known


class _Nesting:
    """Which composite lies in which: an interval for each, inside of its parent's."""

    def __init__(self, composites: Sequence["Composite"]) -> None:
        children: dict[str | None, list[str]] = {c.id: [] for c in composites}
        for c in composites[1:]:
            children[c.parent].append(c.id)
        self._first: dict[str, int] = {}
        self._last: dict[str, int] = {}
        pending: list[tuple[str, bool]] = [(composites[0].id, False)]
        while pending:
            id, done = pending.pop()
            if done:
                self._last[id] = len(self._first)
                continue
            self._first[id] = len(self._first)
            pending.append((id, True))
            pending += [(child, False) for child in children[id]]

    def lies_in(self, inner: str, outer: str) -> bool:
        return self._first[outer] <= self._first[inner] < self._last[outer]
