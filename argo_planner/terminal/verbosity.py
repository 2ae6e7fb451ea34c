"""How much the commands say beside their results: `-q`, `-v` and `-vv`.

The level of the libraries' loggers is what holds it. What they log goes to standard error.
"""

import logging
import sys
from typing import Annotated

import typer

_PACKAGES = ("argo_compiler", "argo_env", "argo_planner", "baselines")
_LOGGER = logging.getLogger("argo_planner")


class _ToStandardError(logging.Handler):
    """Prints to what is standard error at the time, so that a progress bar stays below it."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


_HANDLER = _ToStandardError()
_HANDLER.setFormatter(logging.Formatter("%(levelname)s %(name)s: %(message)s"))


def set_verbosity(verbose: int = 0, quiet: bool = False) -> None:
    """From now on only results and errors are shown, or what is done as well: once in stages, twice
    in detail."""
    level = logging.ERROR if quiet else logging.WARNING
    if verbose and not quiet:
        level = logging.INFO if verbose == 1 else logging.DEBUG
    for name in _PACKAGES:
        logger = logging.getLogger(name)
        logger.setLevel(level)
        if _HANDLER not in logger.handlers:
            logger.addHandler(_HANDLER)


def is_quiet() -> bool:
    """Whether only results and errors are to be shown."""
    return not _LOGGER.isEnabledFor(logging.WARNING)


def _more(value: int) -> None:
    if value:
        set_verbosity(verbose=value)


def _less(value: bool) -> None:
    if value:
        set_verbosity(quiet=True)


# Said after a command's name these count from its own place on, so only what is said is set.
Verbose = Annotated[
    int,
    typer.Option(
        "-v",
        "--verbose",
        count=True,
        callback=_more,
        expose_value=False,
        show_default=False,
        help="say what is done; -vv: in detail",
    ),
]
Quiet = Annotated[
    bool,
    typer.Option(
        "-q", "--quiet", callback=_less, expose_value=False, help="show results and errors only"
    ),
]


def common_options(verbose: Verbose = 0, quiet: Quiet = False) -> None:
    """Stands for the options that all commands have."""
