"""Commands that people send to a mission plan, and the revisions that they make."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.editing import Consequence, Edit
from argo_compiler.il import Mission
from argo_planner.service.core.change import MissionChange

MOST_EDITS = 1000
"""edits in one command"""

CommandId = Annotated[str, Field(pattern=r"^[A-Za-z0-9._:-]{1,64}$")]
"""chosen by the sender, so that a command that is sent again is executed only once"""


class EditPlan(Model):
    """Command to make all of the edits together, or none if one of them is refused."""

    kind: Literal["edit"] = "edit"
    id: CommandId
    edits: tuple[Edit, ...] = Field(min_length=1, max_length=MOST_EDITS)


class UndoEdit(Model):
    """Command to undo the author's last change, or one revision of theirs."""

    kind: Literal["undo"] = "undo"
    id: CommandId
    revision: int | None = Field(default=None, ge=1)


class RedoEdit(Model):
    """Command to redo the change that the author has undone last."""

    kind: Literal["redo"] = "redo"
    id: CommandId


class ReplacePlan(Model):
    """Command to replace the whole mission, such as by a script, a version or another order."""

    kind: Literal["replace"] = "replace"
    id: CommandId
    mission: Mission
    about: str = ""
    """source of the mission, for people"""


class ReplaceFrom(Model):
    """Request for a `replace` by a stored mission, identified by where the mission is stored.

    When the request is sent again, the stored mission may have changed or been deleted.
    """

    id: CommandId
    kept_as: str


PlanCommand = EditPlan | UndoEdit | RedoEdit | ReplacePlan


class Revision(Model):
    """Step of a mission plan's history: the command, its author, and its changes."""

    number: int = Field(ge=1)
    """number of the plan's state after this step"""
    id: CommandId
    """id of the command"""
    kind: Literal["edit", "undo", "redo", "replace"]
    author: str
    at: datetime
    edits: tuple[Edit, ...] = ()
    """edits of an `edit` command; empty for other kinds"""
    reverts: int | None = None
    """the revision that an `undo` or a `redo` reverts"""
    about: str = ""
    """source of the mission of a `replace`, for people"""
    digest: str = ""
    """digest of the command and its author; tells it apart from another command with the same id"""
    change: MissionChange
    consequences: tuple[Consequence, ...] = ()
    """further changes that the command made necessary"""
