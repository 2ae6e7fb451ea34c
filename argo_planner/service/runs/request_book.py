"""What has been asked of a run, and how far each request is."""

from collections.abc import Iterable

from argo_compiler.base.errors import Conflict, NotFound
from argo_planner.service.runs.requests import RequestState, RunRequest

MOST_TOLD = 50
"""of the requests that are over, in the state of a run"""


class RequestBook:
    """The requests to one run, by their ids. Holds how far each is."""

    def __init__(self, run: str, requests: Iterable[RequestState] = ()) -> None:
        self._run = run
        self._requests = {request.id: request for request in requests}

    def of(self, id: str) -> RequestState:
        """Raises NotFound."""
        if id not in self._requests:
            raise NotFound(f"run {self._run} has had no request {id[:64]!r}")
        return self._requests[id]

    def known(self, request: RunRequest, by: str) -> RequestState | None:
        """How far a request is that is sent again. Raises Conflict if another one has its id."""
        known = self._requests.get(request.id)
        if known is not None and (known.kind, known.by) != (request.kind, by):
            raise Conflict(f"another request has had the id {request.id}: give each its own")
        return known

    def note(self, request: RequestState) -> None:
        """A request has come, or come further."""
        self._requests[request.id] = request

    def forget(self, id: str) -> None:
        """A request was not taken after all."""
        del self._requests[id]

    @property
    def pending(self) -> tuple[RequestState, ...]:
        """Those that are not over, in the order in which they came."""
        return tuple(one for one in self._requests.values() if not one.over)

    def told(self, news: Iterable[RequestState] = ()) -> tuple[RequestState, ...]:
        """Those that are not over, and the last ones that are, with the news of some of them."""
        requests = (self._requests | {one.id: one for one in news}).values()
        over = [one.id for one in requests if one.over]
        old = set(over[: max(0, len(over) - MOST_TOLD)])
        return tuple(one for one in requests if one.id not in old)
