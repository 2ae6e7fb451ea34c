"""Files that the commands read and write."""

import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from argo_compiler.base.errors import Conflict, Invalid, Remedy, Unavailable
from argo_compiler.files.atomic_write import (
    check_writable,
    is_stream,
    write_atomically,
    write_files_atomically,
)
from argo_compiler.files.loading import read_bytes
from argo_compiler.files.mission_file import read_mission_bytes
from argo_compiler.ros.recognition import is_bag
from argo_compiler.script.documents.reading import MAX_BYTES
from argo_env.files.folders import require_folder_or_creatable
from argo_planner.terminal.draft_files import read_draft_beside
from argo_planner.use_cases.importing import Upload

STANDARD_OUTPUT = Path("-")
"""path that stands for standard output"""


def read_upload(source: Path) -> Upload:
    """Read a script or a mission file; the upload of a ROS bag only holds its path.

    The use cases find out which of them it is. Any folder counts as a bag.

    Raises:
        ArgoError: The file can't be read.
    """
    if is_bag(source):
        return Upload(str(source), source)
    if source.suffix.lower() == ".json":
        return Upload(str(source), read_mission_bytes(source))
    content = read_bytes(source, "script", MAX_BYTES)
    stored = read_draft_beside(source)
    if stored is None:
        return Upload(str(source), content)
    return Upload(str(source), content, stored.decisions, stored.suggestions)


def check_outputs(
    inputs: Iterable[Path | str | None],
    files: Iterable[Path | None] = (),
    folders: Iterable[tuple[Path | None, Iterable[str]]] = (),
    force: bool = False,
) -> None:
    """Raise ArgoError if the outputs of a command can't be written; to be called first.

    That is the case if an output is also an input, if two outputs have the same path, if a path
    can't be written to, or if a file exists and `force` is not set.

    Args:
        inputs: files that are read; a text is the name or the file of a site
        files: files to be written; None and streams such as `-` are skipped
        folders: folders to be written, each with the names of the files that are written into it
        force: whether existing files may be replaced
    """
    single = [file for file in files if file is not None and not is_stream(file)]
    several: list[Path] = []
    together: list[Path] = []
    for folder, names in folders:
        if folder is not None:
            require_folder_or_creatable(folder)
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
                f"{output} already exists: choose another path, or replace it",
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
        path = os.path.realpath(output)
        if path in read:
            raise Conflict(f"{output} is the input as well; choose another path for the output")
        if path in written:
            raise Conflict(
                f"{output} is to be written twice; choose another path for one of the outputs"
            )
        written.add(path)


def require_mission_output(output: Path) -> None:
    """Raise Invalid unless the file name of a mission ends in `.json`, as reading requires."""
    if output.suffix.lower() != ".json":
        raise Invalid(f"{output}: a mission is written as JSON; name a file that ends in .json")


def write_content(path: Path, content: str | bytes | Mapping[str, bytes]) -> None:
    """Write a file, or several files into a folder; a file with the path `-` is standard output.

    Other files in the folder stay. Text is written as UTF-8 with Unix line ends.

    Raises:
        Unavailable: The path can't be written to.
    """
    try:
        if isinstance(content, Mapping):
            write_files_atomically(path, content)
        elif path != STANDARD_OUTPUT:
            write_atomically(path, content)
    except OSError as error:
        raise Unavailable(f"{path} can't be written: {error.strerror}") from error
    if path == STANDARD_OUTPUT and isinstance(content, str):
        sys.stdout.write(content)
    elif path == STANDARD_OUTPUT and isinstance(content, bytes):
        sys.stdout.buffer.write(content)


def print_written(path: Path, text: str) -> None:
    """Print a line about a written file, unless the content went to standard output."""
    if path != STANDARD_OUTPUT:
        from rich.console import Console  # slow to import, and most commands show their result

        Console(highlight=False).print(f"{path}: {text}", soft_wrap=True, markup=False)
