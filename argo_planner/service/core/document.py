"""Mission plan with its name and versions, and the records that its file consists of."""

from dataclasses import dataclass, replace
from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.core.plan_limits import require_displayable_name
from argo_planner.service.core.refusals import FiledSince

MOST_VERSIONS = 100
"""versions of one plan"""


class PlanVersion(Model):
    """Mission that was stored under a name."""

    number: int = Field(ge=1)
    """unique among the versions that the plan has at the same time"""
    name: str
    revision: int
    author: str
    at: datetime
    mission: Mission


class RevisionMade(Model):
    """Record of a command that was executed."""

    kind: Literal["revision"] = "revision"
    revision: Revision


class PlanRenamed(Model):
    """Record of a new name of the plan."""

    kind: Literal["renamed"] = "renamed"
    name: str
    author: str
    at: datetime


class PlanFiled(Model):
    """Record that the plan was moved to another folder of the list of missions."""

    kind: Literal["filed"] = "filed"
    folder: str
    """empty: it is in no folder"""
    author: str
    at: datetime


class VersionKept(Model):
    """Record of a version that was stored."""

    kind: Literal["version-kept"] = "version-kept"
    version: PlanVersion


class VersionDropped(Model):
    """Record of a version that was deleted."""

    kind: Literal["version-dropped"] = "version-dropped"
    number: int


PlanRecord = Annotated[
    RevisionMade | PlanRenamed | PlanFiled | VersionKept | VersionDropped,
    Field(discriminator="kind"),
]
"""a change of a plan; one line of its file"""


@dataclass(frozen=True)
class PlanDocument:
    """Mission plan with its history, name, times and versions."""

    id: str
    name: str
    created: datetime
    changed: datetime
    plan: MissionPlan
    versions: tuple[PlanVersion, ...] = ()
    folder: str = ""
    """folder of the list of missions that it is in; empty: none"""

    def apply(self, record: PlanRecord) -> "PlanDocument":
        """Return a copy of the document with a change applied, which a line of its file records.

        Raises ValueError if the record is of a revision that does not follow the present one, or
        does not fit the mission. Records of other changes are not checked.
        """
        match record:
            case RevisionMade(revision=revision):
                return replace(
                    self, plan=self.plan.with_next_revision(revision), changed=revision.at
                )
            case PlanRenamed(name=name, at=at):
                return replace(self, name=name, changed=at)
            case PlanFiled(folder=folder):
                return replace(self, folder=folder)  # the mission itself does not change
            case VersionKept(version=version):
                return replace(self, versions=(*self.versions, version))
            case VersionDropped(number=number):
                versions = tuple(v for v in self.versions if v.number != number)
                return replace(self, versions=versions)

    def with_plan(self, plan: MissionPlan) -> tuple["PlanDocument", RevisionMade]:
        """Return a copy of the document with `plan` as its plan, and the record of this change.

        `plan` has exactly one revision more than the document's plan.
        """
        revision = plan.history[-1]
        changed = replace(self, plan=plan, changed=revision.at)
        return changed, RevisionMade.model_construct(revision=revision)

    def make_rename_record(self, name: str, author: str, at: datetime) -> PlanRenamed:
        """Return the record of a new name of the plan, without applying it.

        Raises Invalid if the text can't be a name.
        """
        require_displayable_name(name, Message("the mission"))
        return PlanRenamed(name=name, author=author, at=at)

    def make_folder_record(
        self, folder: str, seen: str | None, author: str, at: datetime
    ) -> PlanFiled:
        """Return the record of a move of the plan to a folder, without applying it.

        `seen` is the folder that the author has seen it in; None: any.

        Raises:
            Invalid: The text can't be the name of a folder; an empty one is no folder.
            FiledSince: Somebody has moved the plan, so that it is no longer where it was seen.
        """
        if folder:
            require_displayable_name(folder, "the folder")
        if seen is not None and seen != self.folder:
            raise FiledSince(self.name, self.folder)
        return PlanFiled(folder=folder, author=author, at=at)

    def make_version_record(self, name: str, author: str, at: datetime) -> VersionKept:
        """Return the record of a new version, which is the present mission, without applying it.

        Raises:
            Invalid: The text can't be a name.
            Conflict: The name is taken, or there are too many versions.
        """
        require_displayable_name(name, Message("the version"))
        if any(version.name == name for version in self.versions):
            raise Conflict(
                Message("there is already a version '{name}': choose another name", name=name)
            )
        if len(self.versions) >= MOST_VERSIONS:
            raise Conflict(
                Message(
                    "the mission has {most_versions} versions: drop one of them first",
                    most_versions=MOST_VERSIONS,
                )
            )
        version = PlanVersion.model_construct(
            number=max((v.number for v in self.versions), default=0) + 1,
            name=name,
            revision=self.plan.revision,
            author=author,
            at=at,
            mission=self.plan.mission,
        )
        return VersionKept.model_construct(version=version)

    def version(self, number: int) -> PlanVersion:
        """Return the version with that number; raises NotFound if there is none."""
        for version in self.versions:
            if version.number == number:
                return version
        known = Listing(f"{v.number} ('{v.name}')" for v in self.versions) or Message("none")
        raise NotFound(
            Message(
                "the mission has no version {number}; it has: {known}", number=number, known=known
            )
        )
