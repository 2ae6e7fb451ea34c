"""What takes long says what it is doing and how far it is, to whoever listens.

As with logging, nobody in between has to hand the listener on: what a site is made of is found when
it is first asked for, wherever that is. Other threads are not heard. Only packages above this one
have what takes long; it is here because `argo --help` shows stages and must not import `argo_env`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol, TypeVar

T = TypeVar("T")

StageListener = Callable[[str | None, float | None, str], None]
"""Is told what is being done, None: nothing that takes long any more; the share of it that is done,
None: that is not known; and a detail."""


class TellShare(Protocol):
    """Tells how far a stage is."""

    def __call__(self, share: float | None, detail: str = "") -> None:
        """`share`: 0 to 1; the `detail` is shown with the stage."""


_listener: ContextVar[StageListener | None] = ContextVar("stage listener", default=None)
_under_way: ContextVar[str | None] = ContextVar("stage", default=None)


@contextmanager
def heard_by(listener: StageListener | None) -> Iterator[None]:
    """Within this, the listener hears of all stages; None: nobody does."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def stage(name: str) -> Iterator[TellShare]:
    """Something that may take seconds, in words such as `finding the walkable surface`. One within
    another is said with it."""
    listener = _listener.get()
    if listener is None:
        yield _unheard
        return

    def tell(share: float | None, detail: str = "") -> None:
        listener(said, share, detail)

    around = _under_way.get()
    said = f"{around}: {name}" if around else name
    token = _under_way.set(said)
    listener(said, None, "")
    try:
        yield tell
    finally:
        _under_way.reset(token)
        listener(around, None, "")


def each(name: str, items: Sequence[T]) -> Iterator[T]:
    """The items, one after the other, as a stage."""
    with stage(name) as tell:
        for k, item in enumerate(items):
            tell(k / len(items))
            yield item


def _unheard(share: float | None, detail: str = "") -> None:
    pass
