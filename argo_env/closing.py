"""What has to be closed can be used as a context that closes it, and is not copied."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import NoReturn, Self, SupportsIndex

from argo_compiler.base.errors import Invalid


class CopyRefused(Invalid, TypeError):
    """A copy or pickle was asked for of what there can be only one of."""


class NonCopyable:
    """There is one of it only: a copy would hold the same simulator or file."""

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raises CopyRefused: two that hold the same would move and close each other's."""
        raise CopyRefused(
            f"a {type(self).__name__} can't be copied or pickled, as the copy would hold the same "
            "simulator or file and disturb it: make another one of the same arguments"
        )


class Closing(NonCopyable, ABC):
    """Closes itself where its context ends."""

    @abstractmethod
    def close(self) -> None:
        """Gives back what it holds; it is of no use afterwards."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
