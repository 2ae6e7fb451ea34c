"""What was found for published route problems, as a Markdown table."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from benchmarks.instances import Kind
from benchmarks.known_values import Known

SMALL = 100
"""the number of nodes up to which proofs are counted apart"""


@dataclass(frozen=True)
class PeerFinding:
    """What another solver found for a problem."""

    name: str
    value: float | None
    """as the file counts; None: nothing"""
    none_because: str | None = None
    """why it was not asked, or why what it found does not count"""


@dataclass(frozen=True)
class Row:
    """What was found for one problem. Values as the file counts."""

    name: str
    kind: Kind
    nodes: int
    known: Known | None
    value: float | None
    bound: float
    proven: bool
    seconds: float
    method: str
    peers: tuple[PeerFinding, ...]
    wrong: str | None
    """what contradicts the evaluation or what is known: a defect of the solvers"""

    def off(self, value: float | None) -> float | None:
        """By what share a value is worse than the best known one, which may be ours."""
        known = None if self.known is None else self.known.value
        found = (self.value, known, *(peer.value for peer in self.peers))
        values = [each for each in found if each is not None]
        if value is None or not values:
            return None
        best = max(values) if self.kind == Kind.OP else min(values)
        if abs(value - best) <= (self.known.rounded if self.known else 0.0):
            return 0.0
        return abs(value - best) / best if best else float("inf")


def summary(rows: Iterable[Row]) -> Iterator[str]:
    """What holds of the problems of each kind."""
    for kind, group in groupby(sorted(rows, key=lambda row: row.kind), key=lambda row: row.kind):
        some = list(group)
        small = [row for row in some if row.nodes <= SMALL]
        best = sum(row.off(row.value) == 0.0 for row in some)
        said = (
            f"{kind}: {len(some)} problems, {sum(row.proven for row in some)} proven "
            f"({sum(row.proven for row in small)} of {len(small)} with up to {SMALL} nodes), best "
            f"known value or better {best} times, {sum(row.seconds for row in some):.1f} s in all"
        )
        for name in _peers(some):
            found = [(row, peer) for row in some for peer in row.peers if peer.name == name]
            asked = [(row, peer) for row, peer in found if peer.none_because is None]
            reached = sum(row.off(peer.value) == 0.0 for row, peer in asked)
            said += f"; {name} " + (
                f"best known value {reached} times of {len(asked)}"
                if asked
                else f"not asked: {found[0][1].none_because}"
            )
        yield said


def head(peers: Sequence[str]) -> Iterator[str]:
    """Return the first two lines of the Markdown table with these peers."""
    heads = ["", "nodes", "known", "ours", "off", "bound", "proven", "time", "by", *peers]
    yield f"| {' | '.join(heads)} |"
    yield "|" + "---|" * len(heads)


def line(row: Row) -> str:
    """Return the line of a problem."""
    cells = [
        f"{row.kind} {row.name}", str(row.nodes), _known(row.known), _number(row.value),
        _share(row.off(row.value)), _number(row.bound), "yes" if row.proven else "no",
        f"{row.seconds:.1f} s", row.method + (f" WRONG: {row.wrong}" if row.wrong else ""),
    ]  # fmt: skip
    return f"| {' | '.join([*cells, *(_of_peer(row, peer) for peer in row.peers)])} |"


def _peers(rows: Iterable[Row]) -> list[str]:
    return list(dict.fromkeys(peer.name for row in rows for peer in row.peers))


def _of_peer(row: Row, peer: PeerFinding) -> str:
    if peer.value is None:
        return "" if peer.none_because else "none"
    return f"{_number(peer.value)}, {_share(row.off(peer.value))}"


def _known(known: Known | None) -> str:
    return "-" if known is None else _number(known.value) + ("" if known.proven else "?")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{round(value, 2):.10g}"


def _share(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.2f} %" if share else "0"
