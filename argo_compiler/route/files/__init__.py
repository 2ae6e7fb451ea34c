"""Route problems from the files that researchers exchange: TSPLIB, OPLib and TSPTW."""

from argo_compiler.route.files.named import Kind, NamedProblem
from argo_compiler.route.files.reading import read_route_problem
from argo_compiler.route.files.solution import KnownRoute, read_known_route

__all__ = ["Kind", "KnownRoute", "NamedProblem", "read_known_route", "read_route_problem"]
