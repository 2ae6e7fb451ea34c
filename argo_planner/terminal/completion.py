"""What a shell offers for options whose values are names."""

from collections.abc import Callable, Iterable

from argo_env import site_names


def among(names: Iterable[str]) -> Callable[[str], list[str]]:
    """Offers those of the names that begin with what is there."""
    known = tuple(names)

    def offer(incomplete: str) -> list[str]:
        return [name for name in known if name.startswith(incomplete)]

    return offer


def sites(incomplete: str) -> list[str]:
    """Offers the sites that Argo ships; of a site's file the shell completes the path."""
    return among(site_names())(incomplete)
