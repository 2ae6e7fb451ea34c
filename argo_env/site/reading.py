"""Reads a site's description from its YAML file, with errors that say where it is wrong."""

from pathlib import Path

from argo_env.files.yaml_file import parse_yaml, read_text
from argo_env.site.spec import SiteSpec


def read_spec(path: Path) -> SiteSpec:
    """The description of a site in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it describes no site.
    """
    return parse_spec(read_text(path), path)


def parse_spec(text: str, path: Path) -> SiteSpec:
    """The description of a site in the text of a YAML file, which messages call `path`.

    Raises DiagnosticError if it describes no site.
    """
    return parse_yaml(
        text,
        path,
        SiteSpec,
        "sites",
        not_yaml="site.not-yaml",
        duplicate_key="site.duplicate-key",
        wrong_field="site.wrong-field",
    )
