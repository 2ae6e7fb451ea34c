"""Planning on sites: opened sites, catalogues, travel times, flaws, generated sites."""

from argo_env.planning.opening import OpenedSite, open_site

__all__ = ["OpenedSite", "open_site"]
