"""Writes a site's description as the YAML that `read_spec` reads."""

import yaml

from argo_env.site.spec import SiteSpec


def to_yaml(spec: SiteSpec) -> str:
    """The description as YAML; fields that have their defaults are left out."""
    return yaml.safe_dump(
        spec.model_dump(mode="json", exclude_defaults=True),
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=None,
        width=100,
    )
