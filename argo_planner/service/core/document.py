"""A plan with its name and its kept versions, and the records of which its file consists."""

from dataclasses import dataclass, replace
from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.errors import Conflict, NotFound
from argo_compiler.base.model import Model
from argo_compiler.il import Mission
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.core.plan_limits import require_name

MOST_VERSIONS = 100
"""of a plan"""


class PlanVersion(Model):
    """A mission that was kept under a name."""

    number: int = Field(ge=1)
    """that no other version of the plan has, or has had while it was there"""
    name: str
    revision: int
    author: str
    at: datetime
    mission: Mission


class RevisionMade(Model):
    """A command was carried out."""

    kind: Literal["revision"] = "revision"
    revision: Revision


class PlanRenamed(Model):
    """The plan has another name."""

    kind: Literal["renamed"] = "renamed"
    name: str
    author: str
    at: datetime


class VersionKept(Model):
    """A version was kept under a name."""

    kind: Literal["version-kept"] = "version-kept"
    version: PlanVersion


class VersionDropped(Model):
    """A version is kept no longer."""

    kind: Literal["version-dropped"] = "version-dropped"
    number: int


PlanRecord = Annotated[
    RevisionMade | PlanRenamed | VersionKept | VersionDropped, Field(discriminator="kind")
]
"""what has happened to a plan, one line of its file each"""


@dataclass(frozen=True)
class PlanDocument:
    """All that is known of one plan."""

    id: str
    name: str
    created: datetime
    changed: datetime
    plan: MissionPlan
    versions: tuple[PlanVersion, ...] = ()

    def after(self, record: PlanRecord) -> "PlanDocument":
        """The document after a record. Raises ValueError if it does not follow."""
        match record:
            case RevisionMade(revision=revision):
                return replace(self, plan=self.plan.repeat(revision), changed=revision.at)
            case PlanRenamed(name=name, at=at):
                return replace(self, name=name, changed=at)
            case VersionKept(version=version):
                return replace(self, versions=(*self.versions, version))
            case VersionDropped(number=number):
                kept = tuple(v for v in self.versions if v.number != number)
                return replace(self, versions=kept)

    def made(self, plan: MissionPlan) -> tuple["PlanDocument", RevisionMade]:
        """The document with the plan after one more revision, and the record of that."""
        revision = plan.history[-1]
        changed = replace(self, plan=plan, changed=revision.at)
        return changed, RevisionMade.model_construct(revision=revision)

    def rename(self, name: str, author: str, at: datetime) -> PlanRenamed:
        """The record of another name. Raises Invalid for what can't be one."""
        require_name(name, "the mission")
        return PlanRenamed(name=name, author=author, at=at)

    def keep_version(self, name: str, author: str, at: datetime) -> VersionKept:
        """The record of the present mission under a name. Raises Invalid, or Conflict if the name
        is taken or there are too many."""
        require_name(name, "the version")
        if any(version.name == name for version in self.versions):
            raise Conflict(f"there is a version '{name}' already: choose another name")
        if len(self.versions) >= MOST_VERSIONS:
            raise Conflict(f"the mission has {MOST_VERSIONS} versions: drop one of them first")
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
        """The version of that number. Raises NotFound."""
        for version in self.versions:
            if version.number == number:
                return version
        known = ", ".join(f"{v.number} ('{v.name}')" for v in self.versions) or "none"
        raise NotFound(f"the mission has no version {number}; it has: {known}")
