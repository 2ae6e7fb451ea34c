"""Imports of missions in separate processes, with limits of time and memory."""

import asyncio
import os
from collections import Counter, defaultdict
from collections.abc import AsyncIterable
from contextlib import AsyncExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from argo_compiler.base.errors import ArgoError, Invalid, Unavailable
from argo_compiler.base.limited_process import CallLimits, LimitExceeded, limited, limits_for_size
from argo_compiler.base.operating_system import niceness, set_niceness
from argo_compiler.il import Mission
from argo_compiler.ros.bags import suffix_by_first_bytes
from argo_compiler.ros.recognition import first_bytes_if_readable, is_bag_content
from argo_env.files.checked_lines import write_all
from argo_env.planning.opening import open_site
from argo_planner.service.core.change import mission_change
from argo_planner.service.core.plan_limits import require_within_limits
from argo_planner.service.processes.job_process import JobProcess, ReportProgress
from argo_planner.use_cases.importing import ImportedMission, Upload, import_mission

MOST_IMPORTS = 2
"""imports that are read at the same time; each visitor has at most one of them"""
MOST_OF_VISITOR = 8
"""imports of one visitor that are read or wait, as each is stored meanwhile"""
_LOWER_PRIORITY = 10
"""niceness that is added, so that edits come first"""


class Imports:
    """Imports of missions for one site. Each is read in its own process, which ends after it."""

    def __init__(self, site: str) -> None:
        """Create the imports for the site that the reference `site` opens."""
        self._site = site
        self._turns = asyncio.Semaphore(MOST_IMPORTS)
        self._visitors: defaultdict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        """held while an import of the visitor is read, so that others have their turn"""
        self._under_way: Counter[str] = Counter()
        """imports that are read or wait, by visitor"""

    async def import_upload(
        self,
        name: str,
        content: AsyncIterable[bytes],
        visitor: str,
        start_area: int | None = None,
        end_area: int | None = None,
    ) -> ImportedMission:
        """Read and check the mission in an upload, as `import_mission` does.

        Args:
            name: Name of the file.
            content: Its content in parts.
            visitor: Key of who has sent it.
            start_area: Starting area, as for `import_mission`.
            end_area: Area to end in, likewise.

        Raises:
            ArgoError: As `import_mission` does, if the mission is too large for a plan, if reading
                it exceeds the limits of time and memory, or if too many imports of the visitor
                are under way.
        """
        if self._under_way[visitor] >= MOST_OF_VISITOR:
            raise Unavailable(
                f"{MOST_OF_VISITOR} imports with this token are under way: try again when some of "
                "them have ended"
            )
        self._under_way[visitor] += 1
        try:
            return await self._store_and_read(name, content, visitor, start_area, end_area)
        finally:
            self._under_way[visitor] -= 1

    async def _store_and_read(
        self,
        name: str,
        content: AsyncIterable[bytes],
        visitor: str,
        start_area: int | None,
        end_area: int | None,
    ) -> ImportedMission:
        try:
            folder = TemporaryDirectory(prefix="argo-import-", ignore_cleanup_errors=True)
        except OSError as error:
            raise _unwritable(error) from None
        with folder:
            path = Path(folder.name) / "upload"
            size = await _store(path, content)
            async with AsyncExitStack() as stack:
                await stack.enter_async_context(self._visitors[visitor])
                await stack.enter_async_context(self._turns)
                return await self._read(name, path, limits_for_size(size), start_area, end_area)

    async def _read(
        self,
        name: str,
        path: Path,
        limits: CallLimits,
        start_area: int | None,
        end_area: int | None,
    ) -> ImportedMission:
        process = JobProcess[ImportedMission](
            import_file, self._site, name, path, limits, start_area, end_area, limits=limits
        )
        try:
            return await process.start_and_wait(lambda _: None)
        except LimitExceeded as error:
            raise Invalid(
                f"{name} {error}: is it the right file? A mission takes far less"
            ) from None
        finally:
            await process.end()


async def _store(path: Path, content: AsyncIterable[bytes]) -> int:
    """Write the parts of an upload to a file, and return its size in bytes."""
    with open(path, "wb", buffering=0) as file:
        async for part in content:
            try:
                write_all(file.fileno(), part)
            except OSError as error:
                raise _unwritable(error) from None
        return file.tell()


def _unwritable(error: OSError) -> ArgoError:
    return Unavailable(
        f"the upload can't be stored: {error.strerror}; free some space for temporary files"
    )


def import_file(
    site: str,
    name: str,
    path: Path,
    limits: CallLimits,
    start_area: int | None,
    end_area: int | None,
    _: ReportProgress,
) -> ImportedMission:
    """Read and check the mission in a file within limits, as the work of a process.

    `site` is a reference that `open_site` takes, `name` that of the file in messages. Raises the
    errors of `import_mission`, LimitExceeded, and PlanTooLarge.
    """
    opened = open_site(site)
    set_niceness(niceness() + _LOWER_PRIORITY)
    first = first_bytes_if_readable(path)
    with limited(limits):
        if is_bag_content(name, first):
            bag = path.with_suffix(suffix_by_first_bytes(first))
            os.rename(path, bag)
            upload = Upload(name, bag)
        else:
            upload = Upload(name, path.read_bytes())
        imported = import_mission(upload, opened, start_area, end_area)
        mission = imported.mission
        require_within_limits(mission, mission_change(Mission(tasks=()), mission))
        return imported
