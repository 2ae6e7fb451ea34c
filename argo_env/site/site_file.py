"""A site's description as YAML: read, with errors that say where it is wrong, and written."""

from pathlib import Path

import yaml

from argo_compiler.files.reading import read_text
from argo_env.files.yaml_file import parse_yaml
from argo_env.site.spec import SiteSpec

MAX_BYTES = 50_000_000
"""of a site's file; one with hundreds of checkpoints takes some 100 kB"""


def read_site_spec(path: Path) -> SiteSpec:
    """The description of a site in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it describes no site.
    """
    return parse_site_spec(read_spec_text(path), str(path))


def read_spec_text(path: Path) -> str:
    """The text of a site's file; ArgoError if it can't be read."""
    return read_text(path, "site", MAX_BYTES)


def parse_site_spec(text: str, source_name: str) -> SiteSpec:
    """The description of a site in the text of a YAML file, which messages call `source_name`.

    Raises DiagnosticError if it describes no site.
    """
    return parse_yaml(
        text,
        source_name,
        SiteSpec,
        "sites",
        not_yaml="site.not-yaml",
        duplicate_key="site.duplicate-key",
        wrong_field="site.wrong-field",
    )


def to_yaml(spec: SiteSpec) -> str:
    """As `read_site_spec` reads it; fields that have their defaults are left out."""
    return yaml.safe_dump(
        spec.model_dump(mode="json", exclude_defaults=True),
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=None,
        width=100,
    )
