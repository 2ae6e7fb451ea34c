"""Routes for many problems, in several processes."""

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import islice
from typing import Any

from loky.process_executor import BrokenProcessPool

from argo_compiler.base.errors import ArgoError, Unavailable, with_message_prefix
from argo_compiler.base.process_pool import ProcessPool
from argo_compiler.route.problem import RouteProblem
from argo_compiler.route.suggested import RouteSuggestion
from argo_compiler.route.suggestion import suggest_route


def suggest_routes(
    problems: Iterable[RouteProblem], processes: int = 2, **arguments: Any
) -> Iterator[RouteSuggestion]:
    """Yield the result of `suggest_route` for each problem, in the problems' order.

    `arguments` are passed to `suggest_route` in other processes: a solver that is registered in
    this process takes part only if it is one of `solvers`. Yields each result as soon as all
    earlier ones are ready. Raises the errors of `suggest_route`, with the number of the problem,
    from 0; and Unavailable if a process is killed.
    """
    numbered = iter(enumerate(problems))
    pool = ProcessPool(processes)
    try:
        # Bounded, so that no problem is taken from the iterable long before a process needs it.
        pending = [
            (number, pool.submit(partial(suggest_route, **arguments), problem))
            for number, problem in islice(numbered, 2 * processes)
        ]
        while pending:
            number, future = pending.pop(0)
            try:
                suggestion = future.result()
            except ArgoError as error:
                raise with_message_prefix(error, f"problem {number}") from error
            for next_number, problem in islice(numbered, 1):
                next_future = pool.submit(partial(suggest_route, **arguments), problem)
                pending.append((next_number, next_future))
            yield suggestion
    except BrokenProcessPool:
        raise Unavailable("a search process was killed: is there enough memory?") from None
    finally:
        pool.shutdown(wait=True, kill_workers=True)
