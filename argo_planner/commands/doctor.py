"""`argo doctor`: what this installation has and lacks."""

from typing import Annotated

import typer

from argo_compiler.base.errors import Unavailable
from argo_env.files import cache
from argo_planner.use_cases.doctor import examine


def show_health(
    empty_cache: Annotated[
        bool,
        typer.Option("--empty-cache", help="take away all that is kept; it is made again"),
    ] = False,
) -> None:
    """Show Argo's version, its cache on disk, and which optional parts are installed."""
    if empty_cache:
        _empty()
    found = examine()
    print(f"argo {found.version}, Python {found.python}, {found.system}")
    kept = found.cache
    print(
        f"cache: {kept.folder}, {kept.entries} sites, {_megabytes(kept.size)} of at most "
        f"{_megabytes(kept.limit)}"
    )
    if kept.flaw:
        print(f"  nothing can be kept there, so each command builds its site anew: {kept.flaw}")
    for extra in found.extras:
        if extra.missing:
            lacks = ", ".join(extra.missing)
            print(f"{extra.name} ({extra.purpose}): not installed, {lacks}; {extra.remedy}")
        else:
            print(f"{extra.name} ({extra.purpose}): installed")
    print(f"PyBullet: {'works' if found.physics is None else f'does not work: {found.physics}'}")


def _empty() -> None:
    """Raises Unavailable if anything is left, or there is no such folder to be had."""
    before, why = cache.contents().size, cache.write_problem()
    cache.clear()
    if why is not None or cache.contents().files:
        raise Unavailable(
            f"{cache.cache_folder()}: the cache can't be emptied: {why or 'some of it is left'}; "
            f"name a folder that can be written to ({cache.VARIABLE}), or let it be written to"
        )
    print(f"cache: emptied, {_megabytes(before)} freed")


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
