"""Import of missions from scripts, mission files, ROS bags and isar missions."""

import logging
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Invalid, Remedy
from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.base.message import Message
from argo_compiler.base.stages import stage
from argo_compiler.checks import check
from argo_compiler.diagnostics import (
    Diagnostic,
    DiagnosticError,
    by_position,
    has_errors,
    with_excerpts,
)
from argo_compiler.files.foreign import require_no_foreign_file
from argo_compiler.files.loading import open_file
from argo_compiler.files.mission_file import MissionFile, decode_mission
from argo_compiler.il import Mission
from argo_compiler.isar.recognition import find_isar_data
from argo_compiler.ros.recognition import is_bag_content
from argo_compiler.script.documents.document import Document
from argo_compiler.script.documents.reading import document_format
from argo_compiler.script.documents.source import Source as Script
from argo_env.planning.opening import OpenedSite
from argo_env.planning.site_warnings import above_own_speed_warnings, with_seeing_poses

if TYPE_CHECKING:
    from argo_compiler.script import Draft, LineDecision
    from argo_compiler.script.assistant.suggestion import LineSuggestion

_log = logging.getLogger(__name__)

_BRACE = re.compile(rb"(\xef\xbb\xbf|\xff\xfe|\xfe\xff)?[\s\0]*\{")
"""beginning of a JSON object, in any encoding"""
_PLAN = re.compile(rb'[0-9a-f]{8} \{"n":0,"format":"argo plan"')
"""beginning of a mission plan of the planning service"""
_BEGINNING = 1 << 16
"""number of bytes in which a file of another program is recognised, if it may be a bag"""
_JOURNAL = re.compile(rb'[0-9a-f]{8} \{"n":0,')
"""beginning of the journal of a run"""
_RECORDING = re.compile(rb"\x89MCAP0.{11,16}\x04\x00\x00\x00argo", re.DOTALL)
"""beginning of the recording of a run"""


_TABLES = (".csv", ".tsv")
"""suffixes of tables; some have steps in their cells, and are read as scripts"""


class SourceKind(StrEnum):
    """Kind of file that a mission is read from."""

    SCRIPT = "script"
    MISSION = "mission"
    ISAR = "isar"
    BAG = "bag"


@dataclass(frozen=True)
class Upload:
    """A file or folder to import, with its name."""

    name: str
    content: bytes | Mapping[str, bytes] | Path | Document
    """content of a file, or of the files of a rosbag2 folder by name; a Path is a bag on this
    machine, which may be larger than the memory; a Document is what the file of a script has been
    read as already"""
    decisions: tuple["LineDecision", ...] = ()
    """of a script: what a person has decided on for its lines"""
    suggestions: tuple["LineSuggestion", ...] = ()
    """of a script: what an assistant has suggested for its lines"""
    draft: "Draft | None" = None
    """of a script: its draft with these decisions, if it has been read already"""


@dataclass(frozen=True)
class LoadedMission:
    """A mission, the diagnostics of its import, and the text of its file."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...]
    file: MissionFile | Script | None
    """the file; None: a bag or another tool's file, whose lines mean nothing to people"""

    def diagnostics_with_positions(
        self, diagnostics: Iterable[Diagnostic]
    ) -> tuple[Diagnostic, ...]:
        """Return copies of all diagnostics, with positions in `file` unless it is None."""
        if self.file is None:
            return tuple(f.model_copy(update={"span": None}) for f in diagnostics)
        if isinstance(self.file, Script):
            return self.file.placed(with_excerpts(diagnostics, self.file.lines))
        return self.file.diagnostics_with_positions(diagnostics)


@dataclass(frozen=True)
class ImportedMission:
    """A mission without errors."""

    mission: Mission
    source_name: str
    diagnostics: tuple[Diagnostic, ...]
    """diagnostics of the import, which become part of the record of a run"""
    warnings: tuple[Diagnostic, ...]
    """these and the warnings of `check`, by position"""


def guess_source_kind(upload: Upload) -> SourceKind:
    """Return the kind of an upload by its name and content; a script if it is nothing else."""
    if isinstance(upload.content, Document):
        return SourceKind.SCRIPT
    if not isinstance(upload.content, bytes) or is_bag_content(upload.name, upload.content):
        return SourceKind.BAG
    # A pipe has no name with a suffix, but no script begins with a brace.
    if _is_document(upload):
        return SourceKind.SCRIPT
    if Path(upload.name).suffix.lower() != ".json" and not _BRACE.match(upload.content):
        return SourceKind.SCRIPT
    return SourceKind.MISSION if find_isar_data(upload.content) is None else SourceKind.ISAR


@stage("reading the mission")
def load_unchecked_mission(
    upload: Upload,
    catalog: Catalog,
    start_area: int | None = None,
    end_area: int | None = None,
    site: OpenedSite | None = None,
) -> LoadedMission:
    """Read the mission in an upload, without checking it.

    With a site, poses of an isar mission that do not see their checkpoints are replaced.

    Raises:
        DiagnosticError: The upload can't be read as a mission.
        Invalid: It is a file of another kind, such as the journal of a run, or areas are given for
            a mission that has its own.
    """
    name = upload.name
    _require_no_plan_or_run(upload)
    if not _is_document(upload):
        require_no_foreign_file(name, _beginning(upload, _BEGINNING))
    kind = guess_source_kind(upload)
    _log.info("%s is read as a %s", name, kind)
    if kind is not SourceKind.SCRIPT:
        require_no_areas(name, start_area, end_area)
    if kind is SourceKind.SCRIPT:
        return _load_script(upload, catalog, start_area, end_area)
    assert not isinstance(upload.content, Document), Message("a document is a script")
    if kind is SourceKind.BAG or not isinstance(upload.content, bytes):
        return _load_bag(upload.content, name)
    if kind is SourceKind.ISAR:
        return _load_isar(upload.content, name, catalog, site)
    file = decode_mission(upload.content, name)
    return LoadedMission(file.mission, file.diagnostics_with_positions(file.changes), file)


def _beginning(upload: Upload, size: int) -> bytes:
    """Return the content of a file, of a bag on this machine only its first `size` bytes."""
    if isinstance(upload.content, bytes):
        return upload.content
    if isinstance(upload.content, Path) and os.path.isfile(upload.content):
        with open_file(upload.content, "bag") as file:
            return file.read(size)
    return b""


def _require_no_plan_or_run(upload: Upload) -> None:
    """Raise Invalid if an upload is a plan, or the journal or recording of a run."""
    beginning = _beginning(upload, 64)
    for pattern, kind, remedies in (
        (_PLAN, Message("a plan of the planning service, which exports its mission"), ()),
        (_JOURNAL, Message("the journal of a run"), (Remedy.RESUME,)),
        (_RECORDING, Message("the recording of a run"), (Remedy.REPLAY,)),
    ):
        if pattern.match(beginning):
            raise Invalid(
                Message("{upload} is {kind}, not a mission", upload=upload.name, kind=kind),
                remedies=remedies,
                about=upload.name,
            )


# Each kind of source imports its reader here, as the other kinds do not need it.


def _load_bag(content: bytes | Mapping[str, bytes] | Path, name: str) -> LoadedMission:
    from argo_compiler.ros import decode_bag, read_bag

    read = read_bag(content, name) if isinstance(content, Path) else decode_bag(content, name)
    return LoadedMission(read.mission, read.diagnostics, None)


def _load_isar(
    content: bytes, name: str, catalog: Catalog, site: OpenedSite | None
) -> LoadedMission:
    from argo_compiler.isar import from_isar

    imported = from_isar(find_isar_data(content), name, catalog)
    if site is None:
        return LoadedMission(imported.mission, imported.diagnostics, None)
    mission, moved = with_seeing_poses(imported.mission, site)
    return LoadedMission(mission, (*imported.diagnostics, *moved), None)


def _load_script(
    upload: Upload, catalog: Catalog, start_area: int | None, end_area: int | None
) -> LoadedMission:
    draft = upload.draft or load_draft(upload, catalog, start_area, end_area)
    name = upload.name
    table = Path(name).suffix.lower() in _TABLES
    if table and draft.mission is None and not _has_steps(draft):
        raise Invalid(
            Message(
                "{name} is no mission, but a table (CSV): write its rows as steps, such as "
                "`Check checkpoint 4`",
                name=name,
            )
        )
    mission = draft.require_mission()
    return LoadedMission(mission, draft.diagnostics, Script.of(script_in(upload), name))


def _has_steps(draft: "Draft") -> bool:
    """Return True if lines of a table are, or may be, what the robot does."""
    from argo_compiler.script import LineState
    from argo_compiler.script.layout.forms import SHEET_HEADINGS
    from argo_compiler.script.layout.rows import COLUMN_HEADINGS

    steps = (LineState.UNDERSTOOD, LineState.PROPOSED)
    headings = (COLUMN_HEADINGS, SHEET_HEADINGS)
    return any(line.state in steps or line.reason in headings for line in draft.lines)


def load_draft(
    upload: Upload,
    catalog: Catalog,
    start_area: int | None = None,
    end_area: int | None = None,
    decisions: tuple["LineDecision", ...] | None = None,
) -> "Draft":
    """Read the draft of a script; `decisions` replace those of the upload.

    Raises:
        ArgoError: The upload is no script: not text, empty, or too long.
    """
    if isinstance(upload.content, bytes) and not _is_document(upload):
        require_no_foreign_file(upload.name, upload.content)
    with collector_held():
        from argo_compiler.script import import_script

    return import_script(
        script_in(upload),
        catalog,
        source_name=upload.name,
        start_area=start_area,
        end_area=end_area,
        decisions=upload.decisions if decisions is None else decisions,
        suggestions=upload.suggestions,
    )


def script_in(upload: Upload) -> str | Document:
    """Return the script in an upload; raises ArgoError as `load_draft` does."""
    if isinstance(upload.content, Document):
        return upload.content
    assert isinstance(upload.content, bytes), Message("a script is one file")
    return _decoded(upload.content, upload.name)


@lru_cache(maxsize=1)
def _decoded(content: bytes, name: str) -> str | Document:
    """Return the script in a file; the last one is cached, as each decision reads it again."""
    from argo_compiler.script import decode_document

    return decode_document(content, name)


def _is_document(upload: Upload) -> bool:
    """Return True if an upload is a document that is no text, such as a workbook."""
    content = upload.content
    if isinstance(content, bytes):
        return document_format(content) is not None
    return isinstance(content, Document)


def import_mission(
    upload: Upload, site: OpenedSite, start_area: int | None = None, end_area: int | None = None
) -> ImportedMission:
    """Read and check the mission in an upload, for a site.

    Args:
        upload: script, mission, bag or isar mission
        site: site of the mission
        start_area: starting area, for a script that names none; an error if it names another
        end_area: area to end in, likewise

    Raises:
        DiagnosticError: The upload can't be read as a mission, or `check` finds errors.
        Invalid: It is of a run, or areas are given for a mission that has its own.
    """
    loaded = load_unchecked_mission(upload, site.catalog, start_area, end_area, site)
    found = check(loaded.mission, site.catalog)
    found += tuple(above_own_speed_warnings(loaded.mission, site.robot))
    found = by_position((*loaded.diagnostics, *loaded.diagnostics_with_positions(found)))
    if has_errors(found):
        raise DiagnosticError(upload.name, found)
    return ImportedMission(loaded.mission, upload.name, loaded.diagnostics, found)


def require_no_areas(name: str, start_area: int | None, end_area: int | None) -> None:
    """Raise Invalid if areas are given for a mission, which has its own."""
    if start_area is not None or end_area is not None:
        raise Invalid(
            Message("{name} has its areas already; they can be chosen for scripts only", name=name),
            remedies=(Remedy.CHOOSE_AREAS,),
        )
