"""Folders that results are written to."""

from pathlib import Path

from argo_compiler.errors import ArgoError


def make_folder(folder: Path) -> Path:
    """Makes it, before anything is worked out for it. Raises ArgoError if that is impossible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ArgoError(
            f"{folder} can't be made a folder ({error.strerror}): give another one"
        ) from None
    return folder
