"""What was found for published route problems, as text and as Markdown.

    python -m benchmarks.routes_table routes.json ...

Prints the Markdown table and summary of what `python -m benchmarks.routes` wrote with `--json`.
"""

import argparse
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

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


def header(peers: Sequence[str]) -> str:
    """The first line of the table with these peers."""
    theirs = "".join(f"{name:>9}{'off':>8}" for name in peers)
    return (
        f"{'problem':<18}{'kind':<7}{'nodes':>5}{'known':>9} {'ours':>9}{'bound':>9}{'proven':>8}"
        f"{'off':>8}{'time':>8}  {theirs}  by"
    )


def row_text(row: Row) -> str:
    """One line of the table."""
    theirs = "".join(
        f"{_number(peer.value):>9}{_share(row.off(peer.value)):>8}" for peer in row.peers
    )
    return (
        f"{row.name:<18}{row.kind:<7}{row.nodes:>5}{_known(row.known):>9} {_number(row.value):>9}"
        f"{_number(row.bound):>9}{'yes' if row.proven else 'no':>8}{_share(row.off(row.value)):>8}"
        f"{row.seconds:>7.2f}s  {theirs}  {row.method}"
        + (f"  WRONG: {row.wrong}" if row.wrong else "")
    )


def summary(rows: Iterable[Row]) -> Iterator[str]:
    """What holds of the problems of each kind."""
    for kind, group in groupby(sorted(rows, key=lambda row: row.kind), key=lambda row: row.kind):
        some = list(group)
        small = [row for row in some if row.nodes <= SMALL]
        best = sum(row.off(row.value) == 0.0 for row in some)
        line = (
            f"{kind}: {len(some)} problems, {sum(row.proven for row in some)} proven "
            f"({sum(row.proven for row in small)} of {len(small)} with up to {SMALL} nodes), best "
            f"known value or better {best} times, {sum(row.seconds for row in some):.1f} s in all"
        )
        for name in _peers(some):
            found = [(row, peer) for row in some for peer in row.peers if peer.name == name]
            asked = [(row, peer) for row, peer in found if peer.none_because is None]
            reached = sum(row.off(peer.value) == 0.0 for row, peer in asked)
            line += f"; {name} " + (
                f"best known value {reached} times of {len(asked)}"
                if asked
                else f"not asked: {found[0][1].none_because}"
            )
        yield line


def markdown(rows: Sequence[Row]) -> Iterator[str]:
    """The lines of a table of all problems, by kind and size, and the summary as a list."""
    names = _peers(rows)
    heads = ["", "nodes", "known", "ours", "off", "bound", "proven", "time", "by"]
    yield f"| {' | '.join([*heads, *names])} |"
    yield "|" + "---|" * (len(heads) + len(names))
    for row in sorted(rows, key=lambda row: (row.kind, row.nodes, row.name)):
        by_name = {peer.name: peer for peer in row.peers}
        theirs = [_of_peer(row, by_name.get(name)) for name in names]
        cells = [
            f"{row.kind} {row.name}", str(row.nodes), _known(row.known), _number(row.value),
            _short(row.off(row.value)), _number(row.bound), "yes" if row.proven else "no",
            f"{row.seconds:.1f} s", row.method,
        ]  # fmt: skip
        yield f"| {' | '.join([*cells, *theirs])} |"
    yield ""
    yield from (f"- {line}" for line in summary(rows))


def read_rows(path: Path) -> tuple[str, list[Row]]:
    """The setting and the rows of a file that `--json` wrote."""
    written = json.loads(path.read_text(encoding="utf-8"))
    rows = [
        Row(**{
            **row,
            "kind": Kind(row["kind"]),
            "known": row["known"] and Known(**row["known"]),
            "peers": tuple(PeerFinding(**peer) for peer in row["peers"]),
        })
        for row in written["rows"]
    ]  # fmt: skip
    return written["setting"], rows


def _peers(rows: Iterable[Row]) -> list[str]:
    return list(dict.fromkeys(peer.name for row in rows for peer in row.peers))


def _of_peer(row: Row, peer: PeerFinding | None) -> str:
    if peer is None or (peer.value is None and peer.none_because is not None):
        return ""
    return f"{_number(peer.value)}, {_short(row.off(peer.value))}" if peer.value else "none"


def _known(known: Known | None) -> str:
    return "-" if known is None else _number(known.value) + ("" if known.proven else "?")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{round(value, 2):.10g}"


def _share(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.2f} %"


def _short(share: float | None) -> str:
    return "0" if share == 0.0 else _share(share)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints it, with the setting of each file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("files", type=Path, nargs="+")
    read = [read_rows(path) for path in parser.parse_args(arguments).files]
    for setting in dict.fromkeys(setting for setting, _ in read):
        print(setting + "\n")
    for line in markdown([row for _, rows in read for row in rows]):
        print(line)


if __name__ == "__main__":
    main()
