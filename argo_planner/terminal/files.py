"""What the commands read and write: uploads from files and folders, and results."""

from collections.abc import Mapping
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


def keep_input(source: Path, output: Path) -> None:
    """Raises ArgoError where a command would write over what it reads."""
    if source.resolve() == output.resolve():
        raise Conflict(f"{output} is the input as well; choose another place to write to")


def require_mission_output(source: Path, output: Path) -> None:
    """Raises ArgoError where a mission that is written there could not be read again."""
    keep_input(source, output)
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
