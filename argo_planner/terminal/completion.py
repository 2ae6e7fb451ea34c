"""Values that a shell completes for options whose values are names."""

from collections.abc import Callable, Iterable

from argo_env import site_names


def offer_names(names: Iterable[str]) -> Callable[[str], list[str]]:
    """Return a function that lists the names which begin with the text typed so far."""
    known = tuple(names)

    def matching_names(incomplete: str) -> list[str]:
        return [name for name in known if name.startswith(incomplete)]

    return matching_names


def offer_sites(incomplete: str) -> list[str]:
    """Return the shipped sites that match; the shell itself completes the path of a site's file."""
    return offer_names(site_names())(incomplete)
