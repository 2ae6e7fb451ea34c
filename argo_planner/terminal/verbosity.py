"""The options `-q`, `-v` and `-vv`: the amount of output apart from the results.

The level of the libraries' loggers stores it. Their log goes to standard error.
"""

import logging
import sys
from typing import Annotated

import typer

_PACKAGES = ("argo_compiler", "argo_env", "argo_planner", "baselines")
_LOGGER = logging.getLogger("argo_planner")


class _ToStandardError(logging.Handler):
    """Handler that looks up standard error for each line, so that a progress bar stays below."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


_HANDLER = _ToStandardError()
_HANDLER.setFormatter(logging.Formatter("%(levelname)s %(name)s: %(message)s"))


def set_verbosity(verbose: int = 0, quiet: bool = False) -> None:
    """Set how much is shown from now on.

    Args:
        verbose: 0: results, warnings and errors; 1: also each stage of the work; 2 or more: also
            its details
        quiet: only results and errors, no usual warnings; overrides `verbose`
    """
    level = logging.ERROR if quiet else logging.WARNING
    if verbose and not quiet:
        level = logging.INFO if verbose == 1 else logging.DEBUG
    for name in _PACKAGES:
        logger = logging.getLogger(name)
        logger.setLevel(level)
        if _HANDLER not in logger.handlers:
            logger.addHandler(_HANDLER)


def is_quiet() -> bool:
    """Return True if only results and errors are to be shown."""
    return not _LOGGER.isEnabledFor(logging.WARNING)


def _set_verbose(value: int) -> None:
    if value:
        set_verbosity(verbose=value)


def _set_quiet(value: bool) -> None:
    if value:
        set_verbosity(quiet=True)


# These options follow a command's name and override those before it, so only options that are
# given are set.
Verbose = Annotated[
    int,
    typer.Option(
        "-v",
        "--verbose",
        count=True,
        callback=_set_verbose,
        expose_value=False,
        show_default=False,
        help="show what is being done; -vv: in detail",
    ),
]
Quiet = Annotated[
    bool,
    typer.Option(
        "-q",
        "--quiet",
        callback=_set_quiet,
        expose_value=False,
        help="show results and errors only",
    ),
]


def declare_common_options(verbose: Verbose = 0, quiet: Quiet = False) -> None:
    """Do nothing; the parameters declare the options that all commands have."""
