"""Base classes of objects that must be closed, and of objects that can't be copied."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import NoReturn, Self, SupportsIndex

from argo_compiler.base.errors import Invalid
from argo_compiler.base.quantity_text import with_article


class CopyRefused(Invalid, TypeError):
    """Raised when a simulator or an open file is copied or pickled."""


class NonCopyable:
    """Object that can't be copied: a copy would hold the same simulator or file."""

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raise CopyRefused: two objects with one simulator would disturb each other."""
        raise CopyRefused(
            f"{with_article(type(self).__name__)} can't be copied or pickled, as the copy would "
            "hold the same simulator or file and disturb it: make another one of the same arguments"
        )


class Closing(NonCopyable, ABC):
    """Base of objects with a `close`, which also the end of a `with` block calls."""

    @abstractmethod
    def close(self) -> None:
        """Release the simulator or file; the object can't be used afterwards."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
