"""Folders that results are written to."""

from pathlib import Path

from argo_compiler.errors import Unavailable


def make_folder(path: Path) -> None:
    """Makes the folder now, so that no work is lost for want of a place for its results. Raises
    ArgoError if that is impossible."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Unavailable(f"{path}: can't be made a folder: {error.strerror}") from error
