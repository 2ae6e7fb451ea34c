"""Known values and bounds of published route problems.

Values of TSPLIB are those of its pages "ATSP" and "SOP" (G. Reinelt, Heidelberg,
comopt.ifi.uni-heidelberg.de/software/TSPLIB95). If there are two figures, they are the upper and
the lower bound that it lists for an open problem.

Values of OPLib are in the `.sol` files beside its problems. A heuristic found them (G. Kobeaga, M.
Merino, J. A. Lozano, "An efficient evolutionary algorithm for the orienteering problem", 2018), so
they need not be the best. Two were improved and proven with CP-SAT since.

Values of tours with time windows are in a file `best_known.txt` with lines `file cost violations`
(M. López-Ibáñez and C. Blum, lopez-ibanez.eu/tsptw-instances), and their lower bounds in a file
`bounds.txt` with lines `file bound`. Text after `#` is a comment.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from benchmarks.instances import Kind, read_known_route


@dataclass(frozen=True)
class KnownValue:
    """Best known value of a problem, and a bound that no route is better than, if there is one."""

    value: float
    bound: float | None = None
    rounded: float = 0.0
    """largest difference from the exact value, which was published with fewer decimals"""

    @property
    def proven(self) -> bool:
        return self.value == self.bound


def _optimal(values: dict[str, int]) -> dict[str, KnownValue]:
    return {name: KnownValue(value, value) for name, value in values.items()}


TSPLIB = {
    **_optimal({"br17": 39, "ft53": 6905, "ft70": 38673, "ftv33": 1286, "ftv35": 1473}),
    **_optimal({"ftv38": 1530, "ftv44": 1613, "ftv47": 1776, "ftv55": 1608, "ftv64": 1839}),
    **_optimal({"ftv70": 1950, "ftv170": 2755, "kro124p": 36230, "p43": 5620, "ry48p": 14422}),
    **_optimal({"rbg323": 1326, "rbg358": 1163, "rbg403": 2465, "rbg443": 2720}),
    **_optimal({"br17.10": 55, "br17.12": 55, "ESC07": 2125, "ESC11": 2075, "ESC12": 1675}),
    **_optimal({"ESC25": 1681, "ESC47": 1288, "ESC63": 62, "ESC78": 18230}),
    **_optimal({"ft53.1": 7531, "ft53.2": 8026, "ft53.3": 10262, "ft53.4": 14425}),
    **_optimal({"ft70.1": 39313, "ft70.3": 42535, "ft70.4": 53530, "p43.1": 28140}),
    **_optimal({"p43.2": 28480, "p43.3": 28835, "p43.4": 83005, "prob.42": 243, "rbg048a": 351}),
    **_optimal({"rbg050c": 467, "rbg109a": 1038, "rbg150a": 1750, "rbg174a": 2033}),
    **_optimal({"ry48p.1": 15805, "ry48p.4": 31446}),
    "ft70.2": KnownValue(40419, 40101),
    "kro124p.1": KnownValue(39420, 38762),
    "kro124p.2": KnownValue(41336, 39841),
    "kro124p.3": KnownValue(49499, 43904),
    "kro124p.4": KnownValue(76103, 73021),
    "prob.100": KnownValue(1163, 1045),
    "ry48p.2": KnownValue(16666, 16074),
    "ry48p.3": KnownValue(19894, 19490),
}
OPLIB = _optimal({"eil51-gen2-50": 1674, "st70-gen2-50": 2286})


def find_known_value(path: Path, kind: Kind) -> KnownValue | None:
    """Return the known value of the problem in a file; None: there is none. See the module."""
    name = path.stem
    if kind == Kind.OP:
        solution = path.with_suffix(".sol")
        published = KnownValue(read_known_route(solution).score) if solution.exists() else None
        return OPLIB.get(name, published)
    if kind == Kind.TSPTW:
        costs = [words[1] for words in _table_rows(path, "best_known.txt") if len(words) == 3]
        bounds = [float(words[1]) for words in _table_rows(path, "bounds.txt")]
        if not costs:
            return None
        rounded = 0.5 * 10.0 ** -len(costs[0].partition(".")[2])
        return KnownValue(float(costs[0]), bounds[0] if bounds else None, rounded)
    return TSPLIB.get(name)


def _table_rows(path: Path, name: str) -> Iterator[list[str]]:
    """Yield the words of each line on the problem at `path` in the file `name` beside it."""
    table = path.with_name(name)
    if table.exists():
        for line in table.read_text(encoding="utf-8").splitlines():
            words = line.partition("#")[0].split()
            if len(words) > 1 and words[0] == path.name:
                yield words
