"""`argo examples`: list the shipped examples, or copy one."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import Invalid
from argo_planner.terminal.completion import offer_names
from argo_planner.terminal.files import check_outputs, print_written, write_content
from argo_planner.terminal.options import Force
from argo_planner.use_cases.examples import example_files, list_examples

_COPY = "copy"


def _example_names() -> Iterator[str]:
    return (name for examples in list_examples().values() for name in examples)


def examples_command(
    action: Annotated[
        str | None,
        typer.Argument(
            metavar=f"[{_COPY}]",
            help="copy an example with the files that it needs; nothing: list all",
            autocompletion=offer_names(lambda: [_COPY]),
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Argument(help="name of the example", autocompletion=offer_names(_example_names)),
    ] = None,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder to copy to")] = Path(),
    force: Force = False,
) -> None:
    """List the shipped missions, faults, evaluations and sites, or copy one of them."""
    if action is None:
        _print_examples()
        return
    if action != _COPY:
        known = action in _example_names()
        remedy = f"{action}` copies it" if known else "NAME` copies one, `argo examples` lists them"
        raise Invalid(f"there is no `argo examples {action}`; `argo examples copy {remedy}")
    if name is None:
        raise Invalid("give the name of the example to copy; `argo examples` lists them")
    files = example_files(name)
    # Several examples need the same file.
    new = {path: content for path, content in files.items() if not _has(folder / path, content)}
    check_outputs((), (), [(folder, new)], force)
    write_content(folder, new)
    for path in files:
        print_written(folder / path, "copied" if path in new else "already there")


def _has(path: Path, content: bytes) -> bool:
    try:
        return path.read_bytes() == content
    except OSError:
        return False


def _print_examples() -> None:
    for kind, examples in list_examples().items():
        print(f"{kind}:")
        width = max(map(len, examples))
        for name, example in examples.items():
            print(f"  {name:{width}}  {example.about}")
    print("argo examples copy NAME [DIR] copies one, with the files that it needs.")
