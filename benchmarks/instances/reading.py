"""Which form a file has is seen from how it begins."""

from pathlib import Path

from argo_compiler.base.errors import ArgoError
from benchmarks.instances.named import NamedProblem
from benchmarks.instances.text import read_source
from benchmarks.instances.tsplib import read_tsplib
from benchmarks.instances.tsptw import read_tsptw


def read_route_problem(path: Path) -> NamedProblem:
    """The problem in a TSPLIB (TSP, ATSP, SOP), OPLib or TSPTW file.

    Raises ArgoError, with the line where there is one, if the file can't be read or holds none.
    """
    source = read_source(path)
    first = next(line for line in source.lines if line.strip()).lstrip()
    read = read_tsptw if first[0] in "0123456789#!" else read_tsplib
    try:
        return read(source)
    except ArgoError as error:
        if str(path) in str(error):
            raise
        raise ArgoError(f"{path}: {error}") from None  # a RouteProblem knows no file
