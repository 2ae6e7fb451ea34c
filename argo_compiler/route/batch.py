"""Many problems, one a process at a time."""

from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import islice
from multiprocessing import get_context
from typing import Any

from argo_compiler.base.errors import ArgoError, located
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route


def suggest_routes(
    problems: Iterable[RouteProblem], processes: int = 2, **arguments: Any
) -> Iterator[RouteSuggestion]:
    """What `suggest_route` suggests for each problem with these arguments, in the problems' order,
    each as soon as those before it are there.

    The arguments go to other processes: what can't be pickled, such as a lambda, can't be one; nor
    does a solver that is registered in this process take part, unless it is one of `solvers`. A
    program's own module needs `if __name__ == "__main__":` around the call. Raises what
    `suggest_route` raises, with the number of the problem, from 0.
    """
    numbered = iter(enumerate(problems))
    pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn"))
    try:
        # So that no more problems are asked for than are under way.
        ahead = [
            (number, pool.submit(partial(suggest_route, **arguments), problem))
            for number, problem in islice(numbered, 2 * processes)
        ]
        while ahead:
            number, future = ahead.pop(0)
            try:
                found = future.result()
            except ArgoError as error:
                raise located(error, f"problem {number}") from error
            for following, problem in islice(numbered, 1):
                again = pool.submit(partial(suggest_route, **arguments), problem)
                ahead.append((following, again))
            yield found
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
