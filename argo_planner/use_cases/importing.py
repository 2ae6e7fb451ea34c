"""Missions from what someone hands in: scripts, missions, bags and other tools' missions."""

import logging
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.stages import stage
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    by_position,
    has_errors,
    with_excerpts,
)
from argo_compiler.files.loading import open_file
from argo_compiler.files.mission_file import MissionFile, decode_mission
from argo_compiler.il import Mission
from argo_compiler.isar.recognition import find_definition
from argo_compiler.ros.recognition import is_bag_content
from argo_compiler.script.syntax.text.source import Source as Script
from argo_env.planning.opening import OpenedSite
from argo_env.planning.site_warnings import too_fast

_log = logging.getLogger(__name__)

_BRACE = re.compile(rb"(\xef\xbb\xbf|\xff\xfe|\xfe\xff)?[\s\0]*\{")
"""how JSON begins that is no list, in any encoding"""
_JOURNAL = re.compile(rb'[0-9a-f]{8} \{"n":0,')
_RECORDING = re.compile(rb"\x89MCAP0.{11,16}\x04\x00\x00\x00argo", re.DOTALL)
"""how journals and recordings of runs begin"""


class SourceKind(StrEnum):
    """What a mission is read from."""

    SCRIPT = "script"
    MISSION = "mission"
    ISAR = "isar"
    BAG = "bag"


@dataclass(frozen=True)
class Upload:
    """What someone hands in, and what it is called."""

    name: str
    content: bytes | Mapping[str, bytes] | Path
    """of a file, or of the files of a rosbag2 folder by their names; a Path is a bag on this
    machine, which may be larger than its memory"""


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


@dataclass(frozen=True)
class ImportedMission:
    """A mission without errors."""

    mission: Mission
    source_name: str
    diagnostics: tuple[Diagnostic, ...]
    """what the import had to say: goes into the record of a run"""
    warnings: tuple[Diagnostic, ...]
    """these and what `check` warns of, by place"""


def kind_of(upload: Upload) -> SourceKind:
    """What an upload is, by its name and its content. What is nothing else is meant as a script."""
    if not isinstance(upload.content, bytes) or is_bag_content(upload.name, upload.content):
        return SourceKind.BAG
    # From a pipe there is no name that tells, and no script begins with a brace.
    if Path(upload.name).suffix.lower() != ".json" and not _BRACE.match(upload.content):
        return SourceKind.SCRIPT
    return SourceKind.MISSION if find_definition(upload.content) is None else SourceKind.ISAR


@stage("reading the mission")
def load(
    upload: Upload, catalog: Catalog, start_area: int | None = None, end_area: int | None = None
) -> Loaded:
    """The mission in an upload; whether it makes sense is for `check`.

    Raises DiagnosticError, or Invalid for what is kept of a run, and where areas are chosen for
    what has them already.
    """
    _refuse_runs(upload)
    kind, name = kind_of(upload), upload.name
    _log.info("%s is read as a %s", name, kind)
    if kind is not SourceKind.SCRIPT:
        refuse_areas(name, start_area, end_area)
    if not isinstance(upload.content, bytes):
        return _load_bag(upload.content, name)
    match kind:
        case SourceKind.BAG:
            return _load_bag(upload.content, name)
        case SourceKind.ISAR:
            return _load_isar(upload.content, name, catalog)
        case SourceKind.MISSION:
            file = decode_mission(upload.content, name)
            return Loaded(file.mission, file.placed(file.changes), file)
        case SourceKind.SCRIPT:
            return _load_script(upload.content, name, catalog, start_area, end_area)


def _refuse_runs(upload: Upload) -> None:
    """Raises Invalid for the journal or the recording of a run."""
    beginning = b""
    if isinstance(upload.content, bytes):
        beginning = upload.content[:64]
    elif isinstance(upload.content, Path) and os.path.isfile(upload.content):
        with open_file(upload.content, "bag") as file:
            beginning = file.read(64)
    for begins, what, remedy in (
        (_JOURNAL, "journal", Remedy.RESUME),
        (_RECORDING, "recording", Remedy.REPLAY),
    ):
        if begins.match(beginning):
            raise Invalid(
                f"{upload.name}: is no mission but the {what} of a run",
                remedies=(remedy,),
                about=upload.name,
            )


# Each kind of source imports what reads it, which none of the others needs.


def _load_bag(content: bytes | Mapping[str, bytes] | Path, name: str) -> Loaded:
    from argo_compiler.ros import decode_bag, read_bag

    read = read_bag(content, name) if isinstance(content, Path) else decode_bag(content, name)
    return Loaded(read.mission, read.diagnostics, None)


def _load_isar(content: bytes, name: str, catalog: Catalog) -> Loaded:
    from argo_compiler.isar import from_isar

    imported = from_isar(find_definition(content), name, catalog)
    return Loaded(imported.mission, imported.diagnostics, None)


def _load_script(
    content: bytes, name: str, catalog: Catalog, start_area: int | None, end_area: int | None
) -> Loaded:
    with collector_held():
        from argo_compiler.script import decode_script, import_script

    text = decode_script(content, name)
    resolved = import_script(
        text, catalog, source_name=name, start_area=start_area, end_area=end_area
    )
    return Loaded(resolved.mission, resolved.diagnostics, Script(text, name))


def import_mission(
    upload: Upload, site: OpenedSite, start_area: int | None = None, end_area: int | None = None
) -> ImportedMission:
    """The mission in an upload, for a site. Areas are for scripts that leave them open.

    Raises DiagnosticError if there is none, or `check` finds errors in it, and Invalid where the
    areas make no sense.
    """
    loaded = load(upload, site.catalog, start_area, end_area)
    found = check(loaded.mission, site.catalog)
    found += tuple(too_fast(loaded.mission, site.robot))
    found = by_position((*loaded.diagnostics, *loaded.placed(found)))
    if has_errors(found):
        raise DiagnosticError(upload.name, found)
    return ImportedMission(loaded.mission, upload.name, loaded.diagnostics, found)


def refuse_areas(name: str, start_area: int | None, end_area: int | None) -> None:
    """Raises Invalid where areas are chosen for a mission, which has them already."""
    if start_area is not None or end_area is not None:
        raise Invalid(
            f"{name}: areas are chosen when a script is imported; a mission has its areas already",
            remedies=(Remedy.CHOOSE_AREAS,),
        )
