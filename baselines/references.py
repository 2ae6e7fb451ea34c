"""The best prizes of the test sets, found once by the optimiser, that policies are measured by.

    python -m baselines.references [TEST_SET ...] [--time-limit 60]     # find them and write them

What is proven already is left as it is; of the rest the better of old and new is kept. Where the
optimiser does not get to an end, insertion may have found the better route.

For instances with noise they are those of somebody who knows beforehand which readings fail, and
for whom no stairs are ever blocked: no policy can win more, and most can't win as much.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from pathlib import Path

from argo_compiler.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.route import suggest_route
from baselines.families import TEST_SETS, InstanceSet, find_set
from baselines.heuristics.insertion import insert_and_improve
from baselines.problem import HUNDREDTH, hindsight

_FOLDER = "data"
Known = tuple[int, int]
"""prize and bound in hundredths"""


@dataclass(frozen=True)
class BestKnown:
    """What is known of the best route on one instance."""

    prize: float
    """of the best route that was found"""
    bound: float
    """no route wins more"""

    @property
    def proven(self) -> bool:
        return self.prize == self.bound


@lru_cache(maxsize=16)
def references(name: str) -> tuple[BestKnown, ...]:
    """Those of the test set of that name, in the order of its numbers.

    Raises ArgoError if there are none, or they are not those of the test set as it is now.
    """
    tests = find_set(name)
    found = resources.files("baselines").joinpath(_FOLDER, f"{name}.json")
    if not found.is_file():
        raise NotFound(
            f"test set {name} has no references: `python -m baselines.references {name}` finds them"
        )
    data = json.loads(found.read_text(encoding="utf-8"))
    if data["checksum"] != tests.checksum():
        raise Conflict(
            f"test set {name} is no longer what its references were found for (checksum "
            f"{tests.checksum()}, not {data['checksum']}): give the changed set another version"
        )
    return tuple(
        BestKnown(round(prize * HUNDREDTH, 2), round(bound * HUNDREDTH, 2))
        for prize, bound in data["instances"]
    )


def improved(tests: InstanceSet, place: int, known: Known | None, time_limit: float) -> Known:
    """The prize and the bound, in hundredths, of one instance, after another search of at most so
    long (s); not looked for again where what is known is proven.

    Raises ArgoError if a route wins more than is said to be possible.
    """
    if known is not None and known[0] == known[1]:
        return known
    problem = hindsight(tests.family.source.draw(tests.numbers[place])).problem
    found = suggest_route(problem, time_limit)
    simple = sum(problem.visits[visit].prize for visit in insert_and_improve(problem))
    prize, bound = known or (0, found.prize_bound)
    prize, bound = max(prize, simple, found.prize), min(bound, found.prize_bound)
    if prize > bound:
        raise Invalid(
            f"test set {tests.name}, instance {tests.numbers[place]}: a route wins {prize}, but "
            f"none is said to win more than {bound}: the optimiser is wrong"
        )
    return prize, bound


def improve(tests: InstanceSet, file: Path, time_limit: float) -> None:
    """Writes what is known of a test set after another search. What was known of another one by the
    same name counts for nothing."""
    checksum, count = tests.checksum(), len(tests.numbers)
    data = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    known: list[Known | None] = [None] * count
    if data.get("checksum") == checksum:
        known = [(prize, bound) for prize, bound in data["instances"]]
    for place in range(count):
        known[place] = improved(tests, place, known[place], time_limit)
        print(f"{tests.name} {tests.numbers[place]}: {known[place]}", file=sys.stderr)
    text = json.dumps({"checksum": checksum, "instances": known})
    file.write_text(text.replace("], ", "],\n") + "\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 2 if there is no such test set."""
    parser = argparse.ArgumentParser(prog="python -m baselines.references")
    parser.add_argument("names", nargs="*", metavar="TEST_SET", help="default: all")
    parser.add_argument("--time-limit", type=float, default=60.0, help="s for each instance")
    given = parser.parse_args(arguments)
    folder = Path(__file__).parent / _FOLDER
    try:
        for name in given.names or TEST_SETS:
            improve(find_set(name), folder / f"{name}.json", given.time_limit)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
