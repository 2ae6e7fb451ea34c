"""What a recorder writes to: a file, or those who look on."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from argo_compiler.base.model import Model

if TYPE_CHECKING:  # what the extra brings
    from google.protobuf.message import Message


class TopicWriter(Protocol):
    """Takes messages on topics, at simulated times (s)."""

    @property
    def until(self) -> float | None:
        """s up to which all can be read, whatever happens; None: nothing can."""

    def put(self, topic: str, message: "Message", t: float) -> None:
        """A protobuf message."""

    def put_json(self, topic: str, message: Model, t: float) -> None:
        """A model as JSON; fields that are None are left out."""

    def attach(self, name: str, media_type: str, content: str | bytes, t: float = 0.0) -> None:
        """A file that belongs to the run."""

    def describe(self, name: str, facts: Mapping[str, str]) -> None:
        """Texts by name."""

    def flush_if_due(self, t: float) -> None:
        """Time has passed."""

    def flush(self, t: float) -> None:
        """What came before the time t is to be kept."""

    def close(self) -> None:
        """The run is over."""
