"""`argo examples`: list the shipped examples, or copy one."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.base.errors import Invalid
from argo_planner.terminal.files import check_outputs, print_written, write_content
from argo_planner.terminal.options import Force
from argo_planner.use_cases.examples import example_files, list_examples


class ExampleAction(StrEnum):
    """Use of an example."""

    COPY = "copy"


def _offer_examples(incomplete: str) -> list[str]:
    names = (name for examples in list_examples().values() for name in examples)
    return [name for name in names if name.startswith(incomplete)]


def examples_command(
    action: Annotated[
        ExampleAction | None,
        typer.Argument(help="copy: copy an example with the files that it needs"),
    ] = None,
    name: Annotated[
        str | None, typer.Argument(help="name of the example", autocompletion=_offer_examples)
    ] = None,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder to copy to")] = Path(),
    force: Force = False,
) -> None:
    """List the shipped missions, faults, evaluations and sites, or copy one of them."""
    if action is None:
        _print_examples()
        return
    if name is None:
        raise Invalid("give the name of the example to copy; `argo examples` lists them")
    files = example_files(name)
    check_outputs((), (), [(folder, files)], force)
    write_content(folder, files)
    for path in files:
        print_written(folder / path, "copied")


def _print_examples() -> None:
    for kind, examples in list_examples().items():
        print(f"{kind}:")
        width = max(map(len, examples))
        for name, example in examples.items():
            print(f"  {name:{width}}  {example.about}")
    print("argo examples copy NAME [DIR] copies one, with the files that it needs.")
