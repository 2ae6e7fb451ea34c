"""The thread in which all that runs read and write on disk is done, in order."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, TypeVar

T = TypeVar("T")


class DiskThread:
    """Does work on the disk beside the event loop, one after the other. Holds the thread."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="runs-disk")

    async def do(self, work: Callable[..., T], *arguments: Any) -> T:
        """What comes of the work, once all that was to be done before it has been."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, partial(work, *arguments))

    def close(self) -> None:
        """Nothing more is to be done; what was is done first."""
        self._thread.shutdown()
