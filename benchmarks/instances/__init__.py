"""Route problems from the files that researchers exchange: TSPLIB, OPLib and TSPTW."""

from benchmarks.instances.named import Kind, NamedProblem
from benchmarks.instances.reading import read_route_problem
from benchmarks.instances.solution import KnownRoute, read_known_route

__all__ = ["Kind", "KnownRoute", "NamedProblem", "read_known_route", "read_route_problem"]
