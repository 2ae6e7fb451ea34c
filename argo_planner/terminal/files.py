"""What the commands read and write: uploads from files and folders, and results."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from argo_compiler.errors import Conflict, Invalid, Unavailable
from argo_compiler.files.mission_file import read_mission_bytes
from argo_compiler.files.reading import read_bytes
from argo_compiler.files.writing import write_whole
from argo_compiler.ros import is_bag
from argo_compiler.script.syntax.reading import MAX_BYTES
from argo_env.files.folders import make_folder
from argo_planner.use_cases.importing import Upload


def read_upload(source: Path) -> Upload:
    """A script, a mission's file or a bag; what it is, is for the use cases.

    Raises ArgoError if it can't be read.
    """
    if is_bag(source):
        return Upload(str(source), source)
    if source.suffix.lower() == ".json":
        return Upload(str(source), read_mission_bytes(source))
    return Upload(str(source), read_bytes(source, "script", MAX_BYTES))


def keep_apart(inputs: Iterable[Path | str | None], outputs: Iterable[Path | None]) -> None:
    """Raises Conflict where a command would write over what it reads, or twice to one place. A
    text is a site: its file, if it is one."""
    read = {
        Path(given).resolve()
        for given in inputs
        if isinstance(given, Path) or (given and Path(given).suffix in {".yaml", ".yml"})
    }
    written: set[Path] = set()
    for output in outputs:
        if output is None:
            continue
        place = output.resolve()
        if place in read:
            raise Conflict(f"{output} is the input as well; choose another place to write to")
        if place in written:
            raise Conflict(f"{output} is to be written twice; choose another place for one of them")
        written.add(place)


def require_mission_output(output: Path) -> None:
    """Raises Invalid where a mission that is written there could not be read again."""
    if output.suffix.lower() != ".json":
        raise Invalid(f"{output}: a mission is written as JSON; name a file that ends in .json")


def write_text(path: Path, text: str) -> None:
    """Writes text as UTF-8 with Unix line ends; ArgoError if that is impossible."""
    try:
        write_whole(path, text)
    except OSError as error:
        raise Unavailable(f"{path}: can't be written: {error.strerror}") from error


def write_content(path: Path, content: str | bytes | Mapping[str, bytes]) -> None:
    """Writes a file, or a folder of files; ArgoError if that is impossible."""
    if isinstance(content, str):
        write_text(path, content)
    elif isinstance(content, bytes):
        _write_bytes(path, content)
    else:
        _write_folder(path, content)


def _write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    if folder.exists() and not folder.is_dir():
        raise Conflict(f"{folder}: this format is a folder of files, and there is a file already")
    for path, content in files.items():
        make_folder((folder / path).parent)
        _write_bytes(folder / path, content)


def _write_bytes(path: Path, content: bytes) -> None:
    try:
        path.write_bytes(content)
    except OSError as error:
        raise Unavailable(f"{path}: can't be written: {error.strerror}") from error
