"""`argo docs`: list the pages of the documentation, or print one."""

from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import NotFound
from argo_compiler.base.nearest_name import nearest_name
from argo_env.files.resources import docs_folder
from argo_planner.terminal.completion import offer_names


def _find_pages() -> dict[str, Path]:
    """Return the files of the pages by the pages' names, such as `routes`."""
    return {path.stem: path for path in sorted(docs_folder().glob("*.md"))}


def docs_command(
    page: Annotated[
        str | None,
        typer.Argument(help="name of the page to print", autocompletion=offer_names(_find_pages)),
    ] = None,
) -> None:
    """List the pages of the documentation, or print one as Markdown."""
    if page is None:
        _print_titles()
        return
    pages = _find_pages()
    name = page.removesuffix(".md")  # the name as other pages link to it
    if name not in pages:
        near = nearest_name(name, pages)
        hint = f"did you mean {near}?" if near else "`argo docs` lists them"
        raise NotFound(f"the documentation has no page {name}: {hint}")
    print(pages[name].read_text(encoding="utf-8"), end="")


def _print_titles() -> None:
    pages = _find_pages()
    width = max(map(len, pages))
    for name, path in pages.items():
        title = path.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
        print(f"{name:{width}}  {title}")
    print(f"argo docs PAGE prints one. The files are in {docs_folder()}.")
