"""What the robot did, against what is expected of it.

`M8`: checkpoint 8 is measured. `D2`, `D*`: it drives into the dock of area 2, of any area. `W`,
`W@3`, `W@front of the site`: it drives to any place, to one on floor 3, to that place. A `?`
behind it: or not. `W@2+`: one place or more on floor 2. `W@2x3`: a tour of at least three places
there, driven three times. `P120`: the plan lets it wait for 120 s. `H`: it stands still until
somebody lets it go on. `X`: the mission ends where it stands. A list: these in any order.
"""

import json
import re
from collections import Counter
from collections.abc import Sequence
from typing import Any

from tests.argo_compiler.script.judging.driving import Step


def fits(expected: Sequence[Any], steps: Sequence[Step]) -> bool:
    """Whether the steps are what is expected: tokens in order, a list being in any order."""
    if not expected:
        return not steps
    first, rest = expected[0], expected[1:]
    if isinstance(first, list):
        n = len(first)
        same = Counter(first) == Counter(step.token for step in steps[:n])
        return same and fits(rest, steps[n:])
    if first.endswith("?"):
        if fits(rest, steps):
            return True
        return bool(steps) and _is(first[:-1], steps[0]) and fits(rest, steps[1:])
    if first.endswith("+"):
        n = _run(first[:-1], steps)
        return any(fits(rest, steps[k:]) for k in range(n, 0, -1))
    if tour := re.fullmatch(r"(W@\d+)x(\d+)", first):
        token, rounds = tour[1], int(tour[2])
        n = _run(token, steps)
        for places in range(3, n // rounds + 1):
            way = [step.place for step in steps[: places * rounds]]
            distinct = len(set(way[:places])) == places
            if distinct and way == way[:places] * rounds and fits(rest, steps[places * rounds :]):
                return True
        return False
    return bool(steps) and _is(first, steps[0]) and fits(rest, steps[1:])


def _run(token: str, steps: Sequence[Step]) -> int:
    n = 0
    while n < len(steps) and _is(token, steps[n]):
        n += 1
    return n


def _is(token: str, step: Step) -> bool:
    if token in ("D*", "P*"):
        return step.token[0] == token[0]
    if token == "W":
        return step.token == "W" or step.token.startswith("W@")
    if token[0] == step.token[0] == "P":
        return abs(float(token[1:]) - float(step.token[1:])) <= 1.0
    return token == step.token


def compare(trace: dict[str, Any], steps: Sequence[Step]) -> str | None:
    """What differs from the trace, or None."""
    done = [s for s in steps if s.token[0] != "P"] if trace.get("waits") == "any" else list(steps)
    if "expect_set" in trace:
        wanted, last = Counter(trace["expect_set"]), trace["expect_set"][-1]
        ok = wanted == Counter(s.token for s in done)
        ok = ok and (last[0] not in "DX" or done[-1].token == last)
        shown: Any = "{" + " ".join(sorted(wanted.elements())) + "}"
    else:
        ways = trace["expect_any"] if "expect_any" in trace else [trace["expect"]]
        ok = any(fits(way, done) for way in ways)
        shown = " or ".join(show(way) for way in ways)
    if not ok:
        got = " ".join(s.token for s in done[:40]) + (" ..." if len(done) > 40 else "")
        return f"expected {shown}, got {got or 'nothing'}{given(trace)}"
    tolerance = float(trace.get("tolerance_s", 1.0))
    for key, times in trace.get("times", {}).items():
        starts = [s.at for s in steps if s.token == (key if key[0] in "DWX" else f"M{key}")]
        near = len(starts) >= len(times) and all(
            abs(a - b) <= tolerance for a, b in zip(starts, times, strict=False)
        )
        if not near:
            return f"{key} should begin at {times} s, begins at {starts} s{given(trace)}"
    return None


def show(way: Sequence[Any]) -> str:
    return " ".join("(" + " ".join(e) + ")" if isinstance(e, list) else e for e in way)


def given(trace: dict[str, Any]) -> str:
    given = [f"{k}={json.dumps(trace[k])}" for k in ("values", "events", "fails") if trace.get(k)]
    return f" with {', '.join(given)}" if given else ""
