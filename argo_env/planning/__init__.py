"""What plans are made with on a site: opened sites, catalogues, travel times, generated sites."""

from argo_env.planning.opening import OpenedSite, open_site

__all__ = ["OpenedSite", "open_site"]
