"""What this installation of Argo has and lacks, and where it keeps things."""

import platform
from importlib.util import find_spec

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.extras import install_line
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_env.files import cache

_EXTRAS: dict[str, tuple[str, tuple[str, ...]]] = {
    "cluster": ("evaluations on Ray or Dask", ("ray", "dask", "distributed")),
    "results": ("rows of evaluations in Parquet files", ("pyarrow",)),
    "film": ("films as .mp4", ("imageio_ffmpeg",)),
    "learned": (
        "policies that learn",
        ("torch", "stable_baselines3", "sb3_contrib", "tensorboard"),
    ),
    "recording": (
        "recordings of runs",
        ("mcap", "mcap_protobuf", "foxglove_schemas_protobuf"),
    ),
    "planner": (
        "the planning service",
        ("fastapi", "uvicorn", "uvloop", "httptools", "websockets"),
    ),
    "foxglove": ("runs live in Foxglove", ("foxglove",)),
    "ros": ("missions in bags of ROS", ("rosbags",)),
    "route": ("better routes", ("pyvrp", "numba")),
    "vision": ("reading gauges from pictures", ("cv2",)),
}
"""What each extra is for, and the modules that it brings."""


class CacheReport(Model):
    """What is in the cache on disk."""

    folder: str
    entries: int
    """sites, each with its robot"""
    size: int
    """bytes"""
    limit: int
    """bytes"""
    flaw: str | None
    """why nothing can be written there, if so"""


class Extra(Model):
    """An optional part of Argo."""

    name: str
    purpose: str
    missing: tuple[str, ...]
    """modules that are not installed"""

    @property
    def remedy(self) -> str:
        """The command that installs it."""
        return install_line(self.name)


class Examination(Model):
    """What was found out about this installation."""

    version: str
    python: str
    system: str
    cache: CacheReport
    extras: tuple[Extra, ...]
    physics: str | None
    """why PyBullet does not work, if so"""


def examine() -> Examination:
    """Looks at the installation; nothing is changed."""
    kept = cache.contents()
    return Examination(
        version=__version__,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}",
        cache=CacheReport(
            folder=str(cache.cache_folder()),
            entries=kept.sites,
            size=kept.size,
            limit=cache.MAX_SIZE,
            flaw=cache.write_problem(),
        ),
        extras=tuple(
            Extra(
                name=name,
                purpose=purpose,
                missing=tuple(module for module in modules if find_spec(module) is None),
            )
            for name, (purpose, modules) in _EXTRAS.items()
        ),
        physics=_physics_flaw(),
    )


def _physics_flaw() -> str | None:
    """Why PyBullet does not work; None if it does."""
    try:
        from argo_env.world.pybullet_client import Connection

        with Connection():
            return None
    except (ImportError, OSError, RuntimeError, ArgoError) as error:
        return str(error)
