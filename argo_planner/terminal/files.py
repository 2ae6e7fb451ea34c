"""What the commands read and write: uploads from files and folders, and results."""

import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from argo_compiler.base.errors import Conflict, Invalid, Remedy, Unavailable
from argo_compiler.files.atomic_write import (
    check_writable,
    is_stream,
    write_atomically,
    write_folder,
)
from argo_compiler.files.loading import read_bytes
from argo_compiler.files.mission_file import read_mission_bytes
from argo_compiler.ros.recognition import is_bag
from argo_compiler.script.syntax.reading import MAX_BYTES
from argo_env.files.folders import check_folder
from argo_planner.use_cases.importing import Upload

STANDARD_OUTPUT = Path("-")
"""what is named where a result is to be shown, not kept"""


def read_upload(source: Path) -> Upload:
    """A script, a mission's file or a bag; what it is, is for the use cases.

    Raises ArgoError if it can't be read.
    """
    if is_bag(source):
        return Upload(str(source), source)
    if source.suffix.lower() == ".json":
        return Upload(str(source), read_mission_bytes(source))
    return Upload(str(source), read_bytes(source, "script", MAX_BYTES))


def check_outputs(
    inputs: Iterable[Path | str | None],
    files: Iterable[Path | None] = (),
    folders: Iterable[tuple[Path | None, Iterable[str]]] = (),
    force: bool = False,
) -> None:
    """Raises ArgoError where a command would write over what it reads, twice to one place, to where
    nothing can be written, or, without `force`, over what is there already. To be called first.

    A text among the inputs is a site: its file, if it is one. The `folders` come with the names
    that are to be written in them.
    """
    single = [file for file in files if file is not None and not is_stream(file)]
    several: list[Path] = []
    together: list[Path] = []
    for folder, names in folders:
        if folder is not None:
            check_folder(folder)
            together.append(folder)
            several += [folder / name for name in names]
    _keep_apart(inputs, [*single, *several, *together])
    for output in (*single, *several):
        if output == STANDARD_OUTPUT:
            continue
        if output in single or os.path.isdir(output.parent):
            check_writable(output)
        if os.path.exists(output) and not force:
            raise Conflict(
                f"{output}: is there already: choose another place, or replace it",
                remedies=(Remedy.REPLACE,),
            )


def _keep_apart(inputs: Iterable[Path | str | None], outputs: Iterable[Path]) -> None:
    read = {
        os.path.realpath(given)
        for given in inputs
        if isinstance(given, Path) or (given and Path(given).suffix in {".yaml", ".yml"})
    }
    written: set[str] = set()
    for output in outputs:
        place = os.path.realpath(output)
        if place in read:
            raise Conflict(f"{output} is the input as well; choose another place to write to")
        if place in written:
            raise Conflict(f"{output} is to be written twice; choose another place for one of them")
        written.add(place)


def require_mission_output(output: Path) -> None:
    """Raises Invalid where a mission that is written there could not be read again."""
    if output.suffix.lower() != ".json":
        raise Invalid(f"{output}: a mission is written as JSON; name a file that ends in .json")


def write_content(path: Path, content: str | bytes | Mapping[str, bytes]) -> None:
    """Writes a file, or a folder of files, to their place or to standard output, text as UTF-8 with
    Unix line ends; ArgoError if that is impossible."""
    try:
        if isinstance(content, Mapping):
            write_folder(path, content)
        elif path != STANDARD_OUTPUT:
            write_atomically(path, content)
    except OSError as error:
        raise Unavailable(f"{path}: can't be written: {error.strerror}") from error
    if path == STANDARD_OUTPUT and isinstance(content, str):
        sys.stdout.write(content)
    elif path == STANDARD_OUTPUT and isinstance(content, bytes):
        sys.stdout.buffer.write(content)


def say_written(path: Path, text: str) -> None:
    """Says in a line what was written, but where that was shown itself."""
    if path != STANDARD_OUTPUT:
        from rich.console import Console  # slow to import, and most commands show their result

        Console(highlight=False).print(f"{path}: {text}", soft_wrap=True, markup=False)
