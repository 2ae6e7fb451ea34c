"""Many problems, one a process at a time."""

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import islice
from typing import Any

from loky import ProcessPoolExecutor
from loky.process_executor import BrokenProcessPool

from argo_compiler.base.errors import ArgoError, Unavailable, located
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route


def suggest_routes(
    problems: Iterable[RouteProblem], processes: int = 2, **arguments: Any
) -> Iterator[RouteSuggestion]:
    """What `suggest_route` suggests for each problem with these arguments, in the problems' order,
    each as soon as those before it are there.

    The arguments go to other processes: a solver that is registered in this process takes part only
    if it is one of `solvers`. Raises what `suggest_route` raises, with the number of the problem,
    from 0; and Unavailable if a process is killed.
    """
    numbered = iter(enumerate(problems))
    pool = ProcessPoolExecutor(processes)
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
    except BrokenProcessPool:
        raise Unavailable("a process that searched was ended: is there enough memory?") from None
    finally:
        pool.shutdown(wait=True, kill_workers=True)
