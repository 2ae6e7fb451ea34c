"""Standard output and standard error that a command can do without.

A reader may close them, as `| head` does, and a disk may be full. The command goes on then, so that
what it writes elsewhere is written; how it ends is for whoever started it.
"""

import io
import os
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from typing_extensions import Buffer


class Output(io.FileIO):
    """Takes all that is written, also when it can be written no longer. Holds why."""

    failure: OSError | None = None

    def write(self, data: "Buffer", /) -> int:
        if self.failure is None:
            try:
                return super().write(data)
            except OSError as error:
                self.failure = error
        return memoryview(data).nbytes


def guard_output() -> Output:
    """Standard output, guarded as standard error is from now on."""
    output, sys.stdout = _guarded(sys.stdout)
    _, sys.stderr = _guarded(sys.stderr)
    return output


def _guarded(stream: TextIO | None) -> tuple[Output, io.TextIOWrapper]:
    if stream is None:  # closed by whoever wants no output
        output = Output(os.open(os.devnull, os.O_WRONLY), "wb")
        return output, io.TextIOWrapper(io.BufferedWriter(output))
    assert isinstance(stream, io.TextIOWrapper)
    output = Output(stream.fileno(), "wb", closefd=False)
    return output, io.TextIOWrapper(
        # Where Python was asked not to buffer, there is nothing between them.
        output if stream.write_through else io.BufferedWriter(output),
        encoding=stream.encoding,
        errors="backslashreplace",  # names need not be of a terminal's letters
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
