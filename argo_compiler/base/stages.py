"""Stages of long computations, reported with their progress to a listener.

As in logging, callers in between need not pass the listener on: a site's data is computed on first
use, wherever that is. Stages of other threads are not reported. Only packages above this one have
long computations; the module is here because `argo --help` shows stages and must not import
`argo_env`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol, TypeVar

T = TypeVar("T")

StageListener = Callable[[str | None, float | None, str], None]
"""function that is called with the present stage, None if no stage is active any more; the share of
it that is done, None if unknown; and a detail"""


class ProgressReporter(Protocol):
    """Function that reports the progress of a stage."""

    def __call__(self, share: float | None, detail: str = "") -> None:
        """Report the progress of the stage under way.

        Args:
            share: share of the stage that is done, 0 to 1; None if it is not known.
            detail: text that is shown with the name of the stage.
        """


_listener: ContextVar[StageListener | None] = ContextVar("stage listener", default=None)
_active_stage: ContextVar[str | None] = ContextVar("stage", default=None)


@contextmanager
def listen_to_stages(listener: StageListener | None) -> Iterator[None]:
    """Report all stages within the `with` block to the listener; with None, to nobody."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def stage(name: str) -> Iterator[ProgressReporter]:
    """Report a computation that may take seconds, such as `finding the walkable surface`.

    The `with` block is the computation; it may report its progress by the yielded function. The
    listener gets the name of a stage within another one as `outer: inner`.
    """
    listener = _listener.get()
    if listener is None:
        yield _ignore
        return

    def report(share: float | None, detail: str = "") -> None:
        listener(full_name, share, detail)

    outer = _active_stage.get()
    full_name = f"{outer}: {name}" if outer else name
    token = _active_stage.set(full_name)
    listener(full_name, None, "")
    try:
        yield report
    finally:
        _active_stage.reset(token)
        listener(outer, None, "")


def stage_items(name: str, items: Sequence[T]) -> Iterator[T]:
    """Yield the items, and report a stage whose progress is the share of items yielded so far."""
    with stage(name) as report:
        for k, item in enumerate(items):
            report(k / len(items))
            yield item


def _ignore(share: float | None, detail: str = "") -> None:
    pass
