"""Results for published route problems as a Markdown table."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from benchmarks.instances import Kind
from benchmarks.known_values import KnownValue

SMALL = 100
"""number of nodes up to which proofs are counted separately"""


@dataclass(frozen=True)
class PeerResult:
    """Result of another solver for a problem."""

    name: str
    value: float | None
    """value in the file's terms; None: no valid route"""
    reason: str | None = None
    """reason why the solver was not run, or why its route is not valid"""


@dataclass(frozen=True)
class Row:
    """Results for one problem. Values are in the file's terms."""

    name: str
    kind: Kind
    nodes: int
    known: KnownValue | None
    value: float | None
    bound: float
    proven: bool
    seconds: float
    method: str
    peers: tuple[PeerResult, ...]
    wrong: str | None
    """contradiction of the evaluation or of a known value, a defect of the solvers; None: none"""

    def relative_loss_to_best(self, value: float | None) -> float | None:
        """Return the relative loss of a value to the best of all: known, Argo's and the peers'.

        None: there is no value. A loss within the rounding of the known value counts as 0.
        """
        known = None if self.known is None else self.known.value
        candidates = (self.value, known, *(peer.value for peer in self.peers))
        values = [candidate for candidate in candidates if candidate is not None]
        if value is None or not values:
            return None
        best = max(values) if self.kind == Kind.OP else min(values)
        if abs(value - best) <= (self.known.rounded if self.known else 0.0):
            return 0.0
        return abs(value - best) / best if best else float("inf")


def summary_lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield one sentence of totals for the problems of each kind."""
    for kind, group in groupby(sorted(rows, key=lambda row: row.kind), key=lambda row: row.kind):
        rows_of_kind = list(group)
        small = [row for row in rows_of_kind if row.nodes <= SMALL]
        best = sum(row.relative_loss_to_best(row.value) == 0.0 for row in rows_of_kind)
        text = (
            f"{kind}: {len(rows_of_kind)} problems, "
            f"{sum(row.proven for row in rows_of_kind)} proven "
            f"({sum(row.proven for row in small)} of {len(small)} with up to {SMALL} nodes), best "
            f"known value or better {best} times, "
            f"{sum(row.seconds for row in rows_of_kind):.1f} s in all"
        )
        for name in _peer_names(rows_of_kind):
            results = [
                (row, peer) for row in rows_of_kind for peer in row.peers if peer.name == name
            ]
            valid = [(row, peer) for row, peer in results if peer.reason is None]
            reached = sum(row.relative_loss_to_best(peer.value) == 0.0 for row, peer in valid)
            text += f"; {name} " + (
                f"best known value {reached} times of {len(valid)}"
                if valid
                else f"left out: {results[0][1].reason}"
            )
        yield text


def header_lines(peers: Sequence[str]) -> Iterator[str]:
    """Yield the first two lines of the Markdown table with these peers."""
    titles = ["", "nodes", "known", "ours", "off", "bound", "proven", "time", "by", *peers]
    yield f"| {' | '.join(titles)} |"
    yield "|" + "---|" * len(titles)


def row_line(row: Row) -> str:
    """Return the line of the table for a problem."""
    cells = [
        f"{row.kind} {row.name}", str(row.nodes), _known_text(row.known), _number_text(row.value),
        _share_text(row.relative_loss_to_best(row.value)), _number_text(row.bound),
        "yes" if row.proven else "no",
        f"{row.seconds:.1f} s", row.method + (f" WRONG: {row.wrong}" if row.wrong else ""),
    ]  # fmt: skip
    return f"| {' | '.join([*cells, *(_peer_text(row, peer) for peer in row.peers)])} |"


def _peer_names(rows: Iterable[Row]) -> list[str]:
    return list(dict.fromkeys(peer.name for row in rows for peer in row.peers))


def _peer_text(row: Row, peer: PeerResult) -> str:
    if peer.value is None:
        return "" if peer.reason else "none"
    return f"{_number_text(peer.value)}, {_share_text(row.relative_loss_to_best(peer.value))}"


def _known_text(known: KnownValue | None) -> str:
    return "-" if known is None else _number_text(known.value) + ("" if known.proven else "?")


def _number_text(value: float | None) -> str:
    return "-" if value is None else f"{round(value, 2):.10g}"


def _share_text(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.2f} %" if share else "0"
