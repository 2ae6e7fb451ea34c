"""Values that a shell completes for options whose values are names."""

from collections.abc import Callable, Iterable

from argo_env import site_names


def offer_names(find_names: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return a function that finds the names which begin with the text typed so far."""

    def matching_names(incomplete: str) -> list[str]:
        return [name for name in find_names() if name.startswith(incomplete)]

    return matching_names


offer_sites = offer_names(site_names)
"""Return the shipped sites that match; the shell itself completes the path of a site's file."""
