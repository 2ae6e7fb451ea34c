"""Preparation of a process from which tests fork many others."""

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
    """Load the modules that each forked process would otherwise load itself."""
    for module in LOADED_LATE:
        import_module(module)


def draw_small_overviews() -> None:
    """Make the site's pictures in reports small: drawing them takes most of a report's time."""
    overview.SIZE, overview._FINER, overview._SHADOW_MAP = (400, 300), 1, 200
