"""Sites: described as data, built into solids, written as URDF."""

from argo_env.site.site import Site, SiteCheckpoint, load_site, make_site, site_names

__all__ = ["Site", "SiteCheckpoint", "load_site", "make_site", "site_names"]
