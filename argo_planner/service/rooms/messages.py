"""Messages to and from the members of a room, who have a mission plan open."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_field
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Mission
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.document import PlanDocument, PlanVersion
from argo_planner.service.jobs.analysis import AnalysisFound
from argo_planner.service.jobs.job import AnyJob

MOST_DIAGNOSTICS = 500
"""diagnostics that are sent for one mission: the first ones by place"""


class Findings(Model):
    """Diagnostics from the check of a mission."""

    diagnostics: tuple[Diagnostic, ...] = ()
    more: int = 0
    """number of further diagnostics, which are left out"""

    @staticmethod
    def from_first_diagnostics(diagnostics: tuple[Diagnostic, ...]) -> "Findings":
        """Return the first MOST_DIAGNOSTICS diagnostics, and the number of the others."""
        first = diagnostics[:MOST_DIAGNOSTICS]
        return Findings.model_construct(diagnostics=first, more=len(diagnostics) - len(first))


class VersionSummary(Model):
    """Version of a mission plan, without its mission."""

    number: int
    name: str
    revision: int
    author: str
    at: datetime

    @staticmethod
    def from_version(version: PlanVersion) -> "VersionSummary":
        return VersionSummary.model_validate(version, from_attributes=True)


class Member(Model):
    """Client that has the plan open, with its author and selection."""

    client: str
    """id of the connection"""
    author: str
    selection: tuple[str, ...] = ()
    """names of the selected tasks and groups"""


class PlanState(Model):
    """Present state of a mission plan, for one author."""

    id: str
    name: str
    created: datetime
    changed: datetime
    revision: int
    mission: Mission
    findings: Findings
    analysis: AnalysisFound | None = None
    """last analysis, which may be of an earlier revision; None: there is none yet"""
    versions: tuple[VersionSummary, ...] = ()
    undoable: tuple[int, ...] = ()
    """revisions of the requesting author that can be undone, the newest one last"""
    redoable: tuple[int, ...] = ()
    """undos of the requesting author that can be reverted by a redo, the newest one last"""
    recovered: Text | None = None
    """what was lost when a damaged file was opened; None: nothing"""
    recovered_wording: Wording | None = wording_field("recovered")

    @staticmethod
    def from_document(
        document: PlanDocument,
        findings: Findings,
        author: str,
        analysis: AnalysisFound | None = None,
        recovered: str | None = None,
    ) -> "PlanState":
        plan = document.plan
        return PlanState.model_construct(
            id=document.id,
            name=document.name,
            created=document.created,
            changed=document.changed,
            revision=plan.revision,
            mission=plan.mission,
            findings=findings,
            analysis=analysis,
            versions=tuple(map(VersionSummary.from_version, document.versions)),
            undoable=plan.undoable.get(author, ()),
            redoable=plan.redoable.get(author, ()),
            recovered=recovered,
        )


class CommandDone(Model):
    """Result of a command."""

    revision: Revision
    """the revision that the command made; also when the command is sent again"""
    newest: int
    """present revision of the plan"""
    findings: Findings
    """of the present mission"""
    undoable: tuple[int, ...] = ()
    """revisions of the author that can be undone, the newest one last"""
    redoable: tuple[int, ...] = ()
    """undos of the author that can be reverted by a redo, the newest one last"""


class SnapshotTold(Model):
    """First message of a connection: the whole state of the plan."""

    kind: Literal["snapshot"] = "snapshot"
    client: str
    """id of this connection among the members"""
    state: PlanState
    members: tuple[Member, ...]


class ResumedTold(Model):
    """First message of a connection that resumes; the missed revisions follow."""

    kind: Literal["resumed"] = "resumed"
    client: str
    revision: int
    """last revision that the client knows, as it has stated"""
    name: str
    versions: tuple[VersionSummary, ...]
    members: tuple[Member, ...]


class RevisionTold(Model):
    """Message that a command was executed."""

    kind: Literal["revision"] = "revision"
    revision: Revision
    findings: Findings | None = None
    """of the present mission; None: unchanged"""


class AnalysisTold(Model):
    """Message that the analysis of a revision is complete."""

    kind: Literal["analysis"] = "analysis"
    analysis: AnalysisFound


class NameTold(Model):
    """Message that the plan was renamed."""

    kind: Literal["name"] = "name"
    name: str


class VersionsTold(Model):
    """Message that a version was stored or deleted, with all present versions."""

    kind: Literal["versions"] = "versions"
    versions: tuple[VersionSummary, ...]


class MembersTold(Model):
    """Message with all members and their selections."""

    kind: Literal["members"] = "members"
    members: tuple[Member, ...]


class JobTold(Model):
    """Message with the state of a job; if several wait for the same job, only the last is sent."""

    kind: Literal["job"] = "job"
    job: AnyJob
    """the job, without the mission in its new order"""


class WorldTold(Model):
    """Message that the obstacles on the site have changed."""

    kind: Literal["world"] = "world"
    revision: int
    """revision of the obstacles"""


class DeletedTold(Model):
    """Message that the plan was moved to the bin; the connection ends."""

    kind: Literal["deleted"] = "deleted"


RoomMessage = Annotated[
    SnapshotTold
    | ResumedTold
    | RevisionTold
    | AnalysisTold
    | NameTold
    | VersionsTold
    | MembersTold
    | JobTold
    | WorldTold
    | DeletedTold,
    Field(discriminator="kind"),
]
"""any message that is sent to a member"""


class SelectTasks(Model):
    """Message from a client with the names of the tasks and groups that it has selected."""

    kind: Literal["select"] = "select"
    names: Annotated[tuple[Annotated[str, Field(max_length=200)], ...], Field(max_length=2_000)]
