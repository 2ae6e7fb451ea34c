"""`argo doctor`: show the optional parts of this installation, and its cache on disk."""

from typing import Annotated

import typer

from argo_compiler.base.errors import Unavailable
from argo_env.files import cache
from argo_planner.use_cases.doctor import examine_installation


def doctor_command(
    empty_cache: Annotated[
        bool,
        typer.Option("--empty-cache", help="delete the cached data, which is computed again"),
    ] = False,
) -> None:
    """Show Argo's version, its cache on disk, its optional parts, and what extends it."""
    if empty_cache:
        _empty_cache()
    found = examine_installation()
    print(f"argo {found.version}, Python {found.python}, {found.system}")
    stored = found.cache
    print(
        f"cache: {stored.folder}, {stored.entries} sites, {_megabytes(stored.size)} of at most "
        f"{_megabytes(stored.limit)}"
    )
    if stored.write_problem:
        print(
            "  nothing can be stored there, so each command computes its site again: "
            f"{stored.write_problem}"
        )
    for extra in found.extras:
        if extra.missing:
            lacks = ", ".join(extra.missing)
            print(f"{extra.name} ({extra.purpose}): not installed, {lacks}; {extra.remedy}")
        else:
            print(f"{extra.name} ({extra.purpose}): installed")
    print(f"PyBullet: {'works' if found.physics is None else f'does not work: {found.physics}'}")
    for one in found.extensions:
        print(f"{one.kind} `{one.name}` of {one.package}: {one.problem or 'works'}")


def _empty_cache() -> None:
    """Empty the cache; raise Unavailable if files remain, or its folder is not writable."""
    before, problem = cache.contents().size, cache.unwritable_reason()
    cache.clear()
    if problem is not None or cache.contents().files:
        raise Unavailable(
            f"{cache.cache_folder()}: the cache can't be emptied: {problem or 'files remain'}; "
            f"set {cache.VARIABLE} to a writable folder, or change the permissions of this one"
        )
    print(f"cache: emptied, {_megabytes(before)} freed")


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
