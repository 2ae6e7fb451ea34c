"""What those who have a plan open are told, message by message."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Mission
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.document import PlanDocument, PlanVersion
from argo_planner.service.jobs.analysis import AnalysisFound
from argo_planner.service.jobs.job import AnyJob

MOST_DIAGNOSTICS = 500
"""that are told of a mission; the first ones by place"""


class Findings(Model):
    """What the check of a mission found."""

    diagnostics: tuple[Diagnostic, ...] = ()
    more: int = 0
    """how many further ones there are"""

    @staticmethod
    def of(found: tuple[Diagnostic, ...]) -> "Findings":
        told = found[:MOST_DIAGNOSTICS]
        return Findings.model_construct(diagnostics=told, more=len(found) - len(told))


class VersionSummary(Model):
    """A version without its mission."""

    number: int
    name: str
    revision: int
    author: str
    at: datetime

    @staticmethod
    def of(version: PlanVersion) -> "VersionSummary":
        return VersionSummary.model_validate(version, from_attributes=True)


class Member(Model):
    """Somebody who has the plan open, and what they have selected."""

    client: str
    """of the connection"""
    author: str
    selection: tuple[str, ...] = ()
    """names of tasks and groups"""


class PlanState(Model):
    """A plan as it stands."""

    id: str
    name: str
    created: datetime
    changed: datetime
    revision: int
    mission: Mission
    findings: Findings
    analysis: AnalysisFound | None = None
    """the last one, which may be of an earlier revision; None: there is none yet"""
    versions: tuple[VersionSummary, ...] = ()
    undoable: tuple[int, ...] = ()
    """revisions of whoever asks that can be undone, the newest one last"""
    redoable: tuple[int, ...] = ()
    recovered: str | None = None
    """what was lost of a damaged file when it was opened"""

    @staticmethod
    def of(
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
            versions=tuple(map(VersionSummary.of, document.versions)),
            undoable=plan.undoable.get(author, ()),
            redoable=plan.redoable.get(author, ()),
            recovered=recovered,
        )


class CommandDone(Model):
    """What came of a command."""

    revision: Revision
    """what it made; of a command that was sent again, what it made then"""
    newest: int
    """revision of the plan by now"""
    findings: Findings
    """of the mission by now"""
    undoable: tuple[int, ...] = ()
    """revisions of the author that can be undone, the newest one last"""
    redoable: tuple[int, ...] = ()


class SnapshotTold(Model):
    """All of it, at the beginning."""

    kind: Literal["snapshot"] = "snapshot"
    client: str
    """what this connection is called among the members"""
    state: PlanState
    members: tuple[Member, ...]


class ResumedTold(Model):
    """The client knows the plan; what it has missed follows."""

    kind: Literal["resumed"] = "resumed"
    client: str
    revision: int
    """that it has said it knows"""
    name: str
    versions: tuple[VersionSummary, ...]
    members: tuple[Member, ...]


class RevisionTold(Model):
    """A command was carried out."""

    kind: Literal["revision"] = "revision"
    revision: Revision
    findings: Findings | None = None
    """of the mission now; None: as before"""


class AnalysisTold(Model):
    """The analysis of a revision is there."""

    kind: Literal["analysis"] = "analysis"
    analysis: AnalysisFound


class NameTold(Model):
    """The plan has another name."""

    kind: Literal["name"] = "name"
    name: str


class VersionsTold(Model):
    """A version was kept or dropped; these are all."""

    kind: Literal["versions"] = "versions"
    versions: tuple[VersionSummary, ...]


class MembersTold(Model):
    """Who is there, and what they have selected."""

    kind: Literal["members"] = "members"
    members: tuple[Member, ...]


class JobTold(Model):
    """How far a job of the plan is. Of several that wait to be sent only the last one is."""

    kind: Literal["job"] = "job"
    job: AnyJob
    """without the mission in its new order"""


class WorldTold(Model):
    """The obstacles on the site have changed."""

    kind: Literal["world"] = "world"
    revision: int
    """of the obstacles"""


class DeletedTold(Model):
    """The plan was moved to the bin; the connection ends."""

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
"""all that those who have a plan open are told"""


class SelectTasks(Model):
    """What a client tells: it has selected these tasks and groups."""

    kind: Literal["select"] = "select"
    names: Annotated[tuple[Annotated[str, Field(max_length=200)], ...], Field(max_length=2_000)]
