"""What the commands read and write: sites, missions from scripts, files and bags, and text."""

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from argo_compiler.catalog import Catalog
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    by_place,
    has_errors,
    to_text,
    with_excerpts,
)
from argo_compiler.errors import ArgoError
from argo_compiler.files.mission_file import MissionFile, read_mission_file
from argo_compiler.files.writing import write_whole
from argo_compiler.il import Mission
from argo_compiler.isar import read_isar
from argo_compiler.ros import is_bag, read_bag
from argo_compiler.script import import_script, read_script
from argo_compiler.script.syntax.source import Source as Script
from argo_env.navigation import Navigator
from argo_env.planning import open_site
from argo_env.planning.catalog import make_catalog


def load_navigator(site: str) -> Navigator:
    """The navigator of a site by its name, by the file that describes it, or of a generated one."""
    return open_site(site).navigator


def is_mission_file(source: Path) -> bool:
    """Whether a command takes it for a mission: Argo's, isar's or a bag. Else it is a script."""
    return source.suffix.lower() == ".json" or is_bag(source)


def is_own_mission(source: Path) -> bool:
    """Whether it is a mission in Argo's own format."""
    return is_mission_file(source) and not is_bag(source) and read_isar(source) is None


@dataclass(frozen=True)
class Loaded:
    """A mission, what its import had to say, and the text of the file that it was read from."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...]
    file: MissionFile | Script | None
    """None: a bag or another tool's file, whose lines say nothing to people"""

    def placed(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Diagnostics about the mission, with the lines of the file that they point at."""
        if self.file is None:
            return tuple(f.model_copy(update={"span": None}) for f in diagnostics)
        if isinstance(self.file, Script):
            return with_excerpts(diagnostics, self.file.lines)
        return self.file.placed(diagnostics)


def load_source(
    source: Path, catalog: Catalog, start_area: int | None, end_area: int | None
) -> Loaded:
    """The mission in a script, a .json or a bag; whether it makes sense is for `check`.

    Raises DiagnosticError, or ArgoError where the request makes no sense.
    """
    if is_mission_file(source):
        refuse_areas(source, start_area, end_area)
        if is_bag(source):
            return Loaded(read_bag(source), (), None)
        if imported := read_isar(source, catalog):
            return Loaded(imported.mission, imported.diagnostics, None)
        file = read_mission_file(source)
        return Loaded(file.mission, (), file)
    text = read_script(source)
    resolved = import_script(
        text, catalog, source_name=str(source), start_area=start_area, end_area=end_area
    )
    return Loaded(resolved.mission, resolved.diagnostics, Script(text, str(source)))


def load_mission(
    source: Path, navigator: Navigator, start_area: int | None, end_area: int | None
) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """The mission of a source, and what the import had to say. Warnings are shown.

    Raises DiagnosticError if there is none, or `check` finds errors in it.
    """
    catalog = make_catalog(navigator)
    loaded = load_source(source, catalog, start_area, end_area)
    diagnostics = by_place((*loaded.diagnostics, *loaded.placed(check(loaded.mission, catalog))))
    if has_errors(diagnostics):
        raise DiagnosticError(str(source), diagnostics)
    if diagnostics:
        print(to_text(diagnostics, str(source)), file=sys.stderr)
    return loaded.mission, loaded.diagnostics


def refuse_areas(source: Path, start_area: int | None, end_area: int | None) -> None:
    """Raises ArgoError where areas are chosen for a mission, which has them already."""
    if start_area is not None or end_area is not None:
        raise ArgoError(
            f"{source}: --start-area and --end-area belong to the import of a script; "
            "a mission has its areas already"
        )


def keep_input(source: Path, output: Path) -> None:
    """Raises ArgoError where a command would write over what it reads."""
    if source.resolve() == output.resolve():
        raise ArgoError(f"{output} is the input as well; choose another place to write to")


def require_mission_output(source: Path, output: Path) -> None:
    """Raises ArgoError where a mission that is written there could not be read again."""
    keep_input(source, output)
    if output.suffix.lower() != ".json":
        raise ArgoError(f"{output}: a mission is written as JSON; name a file that ends in .json")


def write_text(path: Path, text: str) -> None:
    """Writes text as UTF-8 with Unix line ends; ArgoError if that is impossible."""
    try:
        write_whole(path, text)
    except OSError as error:
        raise ArgoError(f"{path}: can't be written: {error.strerror}") from error
