"""Shipped examples: missions, faults, evaluations, sites and scoring rules, with their files."""

import re
from collections.abc import Iterator
from pathlib import Path

from argo_compiler.base.errors import NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.files.yaml_text import load_yaml
from argo_env.files.resources import scenarios_folder

INDEX = "examples.yaml"
"""file in the folder of scenarios that lists the examples"""
MISSIONS = "missions"
"""the kind of examples that are missions"""
SITES = "sites"
"""the kind of examples that are sites"""


class Example(Model):
    """Example: a file, and those that it needs."""

    about: str
    """line about the example"""
    start_area: int | None = None
    """starting area to import it with, if it names none"""
    end_area: int | None = None
    """area to end in, likewise"""
    files: tuple[str, ...]
    """paths from the folder of scenarios; the first one is the example itself"""


def list_examples() -> dict[str, dict[str, Example]]:
    """Return the examples by their kind, such as `missions`, and name."""
    path = scenarios_folder() / INDEX
    kinds = load_yaml(path.read_text(encoding="utf-8"), str(path))
    return {
        kind: {name: Example.model_validate(content) for name, content in examples.items()}
        for kind, examples in kinds.items()
    }


def example_files(name: str) -> dict[str, bytes]:
    """Return the files of an example, by their paths in the folder to which they are copied.

    The example itself comes first; its file is called as the example. A copied site has the name
    `my_NAME`, since NAME stands for the shipped site. Raises NotFound.
    """
    kinds = list_examples()
    kind = next((kind for kind, examples in kinds.items() if name in examples), None)
    if kind is None:
        known = [name for examples in kinds.values() for name in examples]
        near = nearest_name(name, known)
        hint = (
            Message("did you mean {near}?", near=near)
            if near
            else Message("choose one of: {known}", known=Listing(known))
        )
        raise NotFound(Message("there is no example {name}: {hint}", name=name, hint=hint))
    first, *others = kinds[kind][name].files
    if kind == SITES:
        text = (scenarios_folder() / first).read_text(encoding="utf-8")
        text = re.sub(rf"(?m)^name: {name}$", f"name: my_{name}", text, count=1)
        return {f"my_{name}.yaml": text.encode()}
    copied = dict(_paths_and_contents(Path(first).parent, others))
    return {name + Path(first).suffix: (scenarios_folder() / first).read_bytes(), **copied}


def list_missions_on_site(site: str) -> dict[str, Example]:
    """Return the examples of missions on a shipped site by name; none on any other site."""
    missions = list_examples()[MISSIONS].items()
    return {name: one for name, one in missions if Path(one.files[0]).parts[0] == site}


def _paths_and_contents(folder: Path, files: list[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the path and the content of each file; the path is relative to `folder`.

    Files that are not in the folder are put directly into it.
    """
    for file in files:
        path = Path(file)
        inside = path.relative_to(folder) if path.is_relative_to(folder) else Path(path.name)
        yield inside.as_posix(), (scenarios_folder() / file).read_bytes()
