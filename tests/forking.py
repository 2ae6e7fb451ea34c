"""Preparation of a process that many others are forked from: for tests of what those do."""

from importlib import import_module

from argo_env.pictures import overview

LOADED_LATE = (
    "argo_env.drives.kinematic",
    "argo_env.evaluation.report.page",
    "argo_env.remote.robot",
    "argo_planner.service.web.access",
    "argo_planner.service.web.serving",
    "matplotlib.backends.backend_svg",
    "pandas",
    "pyarrow.parquet",
    "scipy.stats",
)
"""modules that commands and runs load only where they need them"""


def load_late_modules() -> None:
    """Load what the forked processes would each load for themselves."""
    for module in LOADED_LATE:
        import_module(module)


def draw_small_overviews() -> None:
    """Let reports have a small picture of the site, which is most of what they take."""
    overview.SIZE, overview._FINER, overview._SHADOW_MAP = (400, 300), 1, 200
