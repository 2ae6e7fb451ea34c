"""Examination of an installation of Argo: its optional parts and its cache."""

import platform
import sys
from importlib.util import find_spec

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.extensions import InstalledExtension
from argo_compiler.base.extras import install_line
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_env.files import cache
from argo_planner.use_cases.extensions import find_extensions

_UVLOOP = () if sys.platform == "win32" else ("uvloop",)
_EXTRAS: dict[str, tuple[str, tuple[str, ...]]] = {
    "assistant": ("suggestions for scripts from an endpoint", ("httpx",)),
    "cluster": ("evaluations on Ray or Dask", ("ray", "dask", "distributed")),
    "results": ("rows of evaluations in Parquet files", ("pyarrow",)),
    "documents": (
        "scripts in spreadsheets, text documents and PDF",
        ("openpyxl", "docx", "pdfplumber"),
    ),
    "film": ("films as .mp4", ("imageio_ffmpeg",)),
    "learned": (
        "learned policies",
        ("torch", "stable_baselines3", "sb3_contrib", "tensorboard"),
    ),
    "recording": (
        "recordings of runs",
        ("mcap", "mcap_protobuf", "foxglove_schemas_protobuf"),
    ),
    "planner": (
        "the planning service",
        ("fastapi", "uvicorn", *_UVLOOP, "httptools", "websockets"),
    ),
    "foxglove": ("live view of runs in Foxglove", ("foxglove",)),
    "ros": ("missions in ROS bags", ("rosbags",)),
    "route": ("more solvers for routes", ("pyvrp", "numba")),
    "vision": ("reading gauges from pictures", ("cv2",)),
}
"""extras by name: the purpose of each, and the modules that it installs"""


class CacheReport(Model):
    """Content of the cache on disk."""

    folder: str
    entries: int
    """number of sites, each with its robot"""
    size: int
    """size in bytes"""
    limit: int
    """highest size in bytes"""
    write_problem: str | None
    """reason why nothing can be written there; None: it can"""


class Extra(Model):
    """An optional part of Argo."""

    name: str
    purpose: str
    missing: tuple[str, ...]
    """modules that are not installed"""

    @property
    def remedy(self) -> str:
        """Command that installs this part."""
        return install_line(self.name)


class Examination(Model):
    """Result of an examination of this installation."""

    version: str
    python: str
    system: str
    cache: CacheReport
    extras: tuple[Extra, ...]
    physics: str | None
    """reason why PyBullet does not work; None: it works"""
    extensions: tuple[InstalledExtension, ...]


def examine_installation() -> Examination:
    """Return the version, the cache, the extras, and whether PyBullet works; change nothing."""
    contents = cache.contents()
    return Examination(
        version=__version__,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}",
        cache=CacheReport(
            folder=str(cache.cache_folder()),
            entries=contents.sites,
            size=contents.size,
            limit=cache.MAX_SIZE,
            write_problem=cache.unwritable_reason(),
        ),
        extras=tuple(
            Extra(
                name=name,
                purpose=purpose,
                missing=tuple(module for module in modules if find_spec(module) is None),
            )
            for name, (purpose, modules) in _EXTRAS.items()
        ),
        physics=_physics_problem(),
        extensions=tuple(find_extensions()),
    )


def _physics_problem() -> str | None:
    """Return the reason why PyBullet does not work, or None if it works."""
    try:
        from argo_env.world.pybullet_client import Connection

        with Connection():
            return None
    except (ImportError, OSError, RuntimeError, ArgoError) as error:
        return str(error)
