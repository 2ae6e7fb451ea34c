"""Reads a site's description from its YAML file, with errors that say where it is wrong."""

from pathlib import Path

from argo_env.files.yaml_file import read_yaml
from argo_env.site.spec import SiteSpec


def read_spec(path: Path) -> SiteSpec:
    """The description of a site in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it describes no site.
    """
    return read_yaml(
        path,
        SiteSpec,
        "sites",
        not_yaml="site.not-yaml",
        duplicate_key="site.duplicate-key",
        wrong_field="site.wrong-field",
    )
