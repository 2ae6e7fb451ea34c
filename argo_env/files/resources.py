"""Folders of the data that Argo ships: beside the packages in a checkout, else inside them."""

from pathlib import Path

_PACKAGE = Path(__file__).parents[1]


def _root(folder: str) -> Path:
    # A wheel carries the folders inside this package; see `force-include` in pyproject.toml.
    installed = _PACKAGE / "data" / folder
    return installed if installed.is_dir() else _PACKAGE.parent / folder


def scenarios_folder() -> Path:
    """Return the folder of the shipped sites, which has one folder for each site."""
    return _root("scenarios")


def docs_folder() -> Path:
    """Return the folder of the documentation's pages."""
    return _root("docs")


def urdf_folder() -> Path:
    """Return the folder with the models of robots and checkpoints."""
    return _root("urdf")
