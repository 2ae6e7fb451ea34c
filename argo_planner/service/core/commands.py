"""What a person asks of a plan, as data, and what came of it."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from argo_compiler.base.model import Model
from argo_compiler.editing import Consequence, Edit
from argo_compiler.il import Mission
from argo_planner.service.core.change import MissionChange

MOST_EDITS = 1000
"""in one command"""

CommandId = Annotated[str, Field(pattern=r"^[A-Za-z0-9._:-]{1,64}$")]
"""chosen by whoever sends the command, so that sending it again does nothing twice"""


class EditPlan(Model):
    """Edits that are made together, or none of them."""

    kind: Literal["edit"] = "edit"
    id: CommandId
    edits: tuple[Edit, ...] = Field(min_length=1, max_length=MOST_EDITS)


class UndoEdit(Model):
    """Puts back what the author changed last, or in one revision of theirs."""

    kind: Literal["undo"] = "undo"
    id: CommandId
    revision: int | None = Field(default=None, ge=1)


class RedoEdit(Model):
    """Changes again what the author has undone last."""

    kind: Literal["redo"] = "redo"
    id: CommandId


class ReplacePlan(Model):
    """Another mission in place of the whole one: read from a script, an earlier version, in
    another order."""

    kind: Literal["replace"] = "replace"
    id: CommandId
    mission: Mission
    about: str = ""
    """where it comes from, for people"""


class ReplaceFrom(Model):
    """Stands for a `replace` by a mission that is kept somewhere: what is kept there may have gone,
    or be another one, when the command is sent again."""

    id: CommandId
    kept_as: str


PlanCommand = EditPlan | UndoEdit | RedoEdit | ReplacePlan


class Revision(Model):
    """One step of a plan's history: what was asked for, by whom, and what it changed."""

    number: int = Field(ge=1)
    """of the plan as it is after this"""
    id: CommandId
    """of the command"""
    kind: Literal["edit", "undo", "redo", "replace"]
    author: str
    at: datetime
    edits: tuple[Edit, ...] = ()
    """those of an `edit`"""
    reverts: int | None = None
    """the revision that an `undo` or a `redo` puts back"""
    about: str = ""
    """where the mission of a `replace` comes from"""
    digest: str = ""
    """of the command, so that another one with its id is told from it"""
    change: MissionChange
    consequences: tuple[Consequence, ...] = ()
    """what else had to change"""
