"""Standard output and standard error whose failure does not stop a command.

A reader may close them, as `| head` does, or the disk may be full. The command continues, so that
it writes its files; the caller decides which exit status it has.
"""

import io
import os
import sys
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from typing_extensions import Buffer


EXIT_INCOMPLETE = 3
"""exit status for a script with lines to confirm or to answer"""


class Output(io.FileIO):
    """Stream that drops data after its first failure. Holds that failure."""

    failure: OSError | None = None

    def write(self, data: "Buffer", /) -> int:
        if self.failure is None:
            try:
                return super().write(data)
            except OSError as error:
                self.failure = error
        return memoryview(data).nbytes


def guard_stdout_and_stderr() -> Output:
    """Replace standard output and error by streams that never fail; return the one for output."""
    output, sys.stdout = _guarded(sys.stdout)
    _, sys.stderr = _guarded(sys.stderr)
    return output


def _guarded(stream: TextIO | None) -> tuple[Output, io.TextIOWrapper]:
    if stream is None:  # closed by the caller, who wants no output
        output = Output(os.open(os.devnull, os.O_WRONLY), "wb")
        return output, io.TextIOWrapper(io.BufferedWriter(output))
    assert isinstance(stream, io.TextIOWrapper)
    output = Output(stream.fileno(), "wb", closefd=False)
    return output, io.TextIOWrapper(
        # If Python was asked not to buffer, nothing may buffer here either.
        output if stream.write_through else io.BufferedWriter(output),
        encoding=stream.encoding,
        errors="backslashreplace",  # a terminal may lack letters of a name
        line_buffering=stream.line_buffering,
        write_through=stream.write_through,
    )
