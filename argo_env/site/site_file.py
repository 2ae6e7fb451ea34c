"""Site descriptions as YAML: parser, with errors that state the place, and writer."""

from pathlib import Path

from argo_compiler.files.loading import read_text
from argo_compiler.files.yaml_text import dump_yaml
from argo_env.files.yaml_file import parse_yaml
from argo_env.site.spec import MAX_BYTES, SiteSpec


def read_site_spec(path: Path) -> SiteSpec:
    """Read the description of a site from a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it describes no site.
    """
    return parse_site_spec(read_text(path, "site", MAX_BYTES), str(path))


def parse_site_spec(text: str, source_name: str) -> SiteSpec:
    """Parse the description of a site from YAML text; messages call its source `source_name`.

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
    """Return a site's description as YAML that `read_site_spec` reads.

    Fields that have their defaults are left out.
    """
    return dump_yaml(spec.model_dump(mode="json", exclude_defaults=True))
