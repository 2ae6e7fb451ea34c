"""Names of tasks and groups: the script's own ones, and numbered ones for the others."""

from collections import Counter
from collections.abc import Sequence

from argo_compiler.script.resolve.points import Item, Range
from argo_compiler.script.resolve.program import own_names
from argo_compiler.script.syntax.text.source import Diagnostics


def name_tasks(items: Sequence[Item], diagnostics: Diagnostics) -> list[str]:
    """A name for each task. Waypoints are numbered through; of others the second is
    `MEASURE 4 (2)`."""
    own: set[str] = set()
    for item in items:
        name = item.do.name
        if name is None:
            continue
        if name in own:
            message = f"more than one task is named `{name}`"
            hint = "give each task a name of its own"
            diagnostics.error("repeated-name", message, item.do.source, hint)
        own.add(name)
    return own_names([item.do for item in items])


def name_groups(ranges: Sequence[Range]) -> dict[int, str]:
    """The name of each round, by the round's identity: `Alpha/Beta` lies in `Alpha`."""
    own = {r.round.name for r in ranges if r.round.name is not None}
    used: Counter[str] = Counter()
    bases: dict[int, str] = {}
    for r in sorted(ranges, key=lambda r: r.round.order):
        base = r.round.name
        while base is None:
            used[r.round.base] += 1
            count = used[r.round.base]
            found = r.round.base if count == 1 else f"{r.round.base} ({count})"
            base = None if found in own else found
        bases[id(r.round)] = base
    names: dict[int, str] = {}
    around: list[Range] = []
    for r in ranges:
        while around and around[-1].last < r.first:
            around.pop()
        base = bases[id(r.round)]
        parent = names[id(around[-1].round)] if around else None
        inside = parent is None or base.startswith(f"{parent}/")
        names[id(r.round)] = base if inside else f"{parent}/{base}"
        around.append(r)
    return names
