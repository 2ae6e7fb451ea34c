"""Edits as data, so that they can be sent, stored and executed again.

Each is the call of a function of this package: its `kind` is the function's name, its other fields
are the function's parameters. As JSON an edit has only the fields that were set: in a header `null`
removes a value, and a missing field leaves the value unchanged.
"""

import json
from collections import Counter
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    TypeAdapter,
    ValidationError,
    model_serializer,
)

from argo_compiler.base.message import Message
from argo_compiler.base.model import Model, Pose
from argo_compiler.base.quantity_text import with_article
from argo_compiler.editing import groups, header, reactions, removal, tasks, transitions
from argo_compiler.editing.consequences import Edited
from argo_compiler.editing.errors import EditInvalid, invalid
from argo_compiler.editing.header import invalid_value_diagnostics
from argo_compiler.il import (
    Condition,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)


class EditCommand(Model):
    """Call of one function of `argo_compiler.editing` on a mission."""

    kind: str

    def given_fields(self) -> dict[str, Any]:
        """Return the fields that the edit sets, by name.

        For each other field the default of the function's parameter applies, or the mission's value
        stays.
        """
        return {name: getattr(self, name) for name in self.model_fields_set if name != "kind"}

    def __eq__(self, other: object) -> bool:
        # A field that is set to its default differs from one that is not set: it changes a value.
        if not isinstance(other, EditCommand):
            return NotImplemented
        return self.kind == other.kind and self.given_fields() == other.given_fields()

    def __hash__(self) -> int:
        return hash((self.kind, frozenset(self.given_fields().items())))

    @model_serializer(mode="wrap")
    def _serialize_given_fields(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        values: dict[str, Any] = write(self)
        return {k: v for k, v in values.items() if k == "kind" or k in self.model_fields_set}


class AddTask(EditCommand):
    """Call of `add_task`."""

    kind: Literal["add_task"] = "add_task"
    task: Task
    before: str | None = None
    after: str | None = None
    first: bool = False
    into: str | None = None


class RemoveTask(EditCommand):
    """Call of `remove_task`."""

    kind: Literal["remove_task"] = "remove_task"
    name: str


class ReplaceTask(EditCommand):
    """Call of `replace_task`."""

    kind: Literal["replace_task"] = "replace_task"
    name: str
    task: Task


class ChangeTask(EditCommand):
    """Call of `change_task`. Fields that are not set stay unchanged."""

    kind: Literal["change_task"] = "change_task"
    name: str
    object_id: str | None = None
    pose: Pose | None = None
    wait: WaitRule | None = None
    velocity: float | None = None
    joint_states: JointState | None = None
    retries: int = 0
    on_failure: OnFailure = OnFailure.CONTINUE
    failure_target: str | None = None
    time_limit: float | None = None
    reading_limit: float | None = None
    optional: bool = False
    priority: int = 1
    window: TimeWindow | None = None


class MoveTask(EditCommand):
    """Call of `move_task`."""

    kind: Literal["move_task"] = "move_task"
    name: str
    before: str | None = None
    after: str | None = None
    first: bool = False
    into: str | None = None


class RenameTask(EditCommand):
    """Call of `rename_task`."""

    kind: Literal["rename_task"] = "rename_task"
    name: str
    new_name: str


class WrapTasks(EditCommand):
    """Call of `wrap_tasks`."""

    kind: Literal["wrap_tasks"] = "wrap_tasks"
    group: Group


class DissolveGroup(EditCommand):
    """Call of `dissolve_group`."""

    kind: Literal["dissolve_group"] = "dissolve_group"
    name: str


class RenameGroup(EditCommand):
    """Call of `rename_group`."""

    kind: Literal["rename_group"] = "rename_group"
    name: str
    own_name: str


class ChangeGroup(EditCommand):
    """Call of `change_group`. Fields that are not set stay unchanged."""

    kind: Literal["change_group"] = "change_group"
    name: str
    start: str = ""
    end: str = ""
    max_repeat_count: int = 0
    max_repeat_duration: float = 0.0
    count_interruptions: bool = False
    stop: Stop = Stop.HARD
    every: float = 0.0
    until: tuple[Condition, ...] = ()


class SetTransitions(EditCommand):
    """Call of `set_transitions`."""

    kind: Literal["set_transitions"] = "set_transitions"
    task: str
    transitions: tuple[Transition, ...]


class AddTransition(EditCommand):
    """Call of `add_transition`."""

    kind: Literal["add_transition"] = "add_transition"
    task: str
    transition: Transition
    at: int | None = None


class RemoveTransition(EditCommand):
    """Call of `remove_transition`."""

    kind: Literal["remove_transition"] = "remove_transition"
    task: str
    at: int


class SetTarget(EditCommand):
    """Call of `set_target`."""

    kind: Literal["set_target"] = "set_target"
    task: str
    at: int
    target: str


class SetConditions(EditCommand):
    """Call of `set_conditions`."""

    kind: Literal["set_conditions"] = "set_conditions"
    task: str
    at: int
    conditions: tuple[Condition, ...]


class AddCondition(EditCommand):
    """Call of `add_condition`."""

    kind: Literal["add_condition"] = "add_condition"
    task: str
    at: int
    condition: Condition


class RemoveCondition(EditCommand):
    """Call of `remove_condition`."""

    kind: Literal["remove_condition"] = "remove_condition"
    task: str
    at: int
    condition: int


class AddReaction(EditCommand):
    """Call of `add_reaction`."""

    kind: Literal["add_reaction"] = "add_reaction"
    reaction: Reaction


class ChangeReaction(EditCommand):
    """Call of `change_reaction`."""

    kind: Literal["change_reaction"] = "change_reaction"
    event: EventKind
    reaction: Reaction


class RemoveReaction(EditCommand):
    """Call of `remove_reaction`."""

    kind: Literal["remove_reaction"] = "remove_reaction"
    event: EventKind


class SetHeader(EditCommand):
    """Call of `set_header`. Fields that are not set stay unchanged."""

    kind: Literal["set_header"] = "set_header"
    designation: str = ""
    site: str = ""
    mode: Mode = Mode.AUTONOMOUS
    max_duration: float | None = None
    start_area: int | None = None
    end_area: int | None = None
    dock: Pose | None = None
    order: Order = Order.PRECISE
    anomaly_specification: str = ""
    real_time_reporting: str = ""
    after_mission_report: str = ""
    current: str | None = None
    left_out: tuple[str, ...] = ()
    before: tuple[tuple[str, str], ...] = ()


Edit = Annotated[
    AddTask
    | RemoveTask
    | ReplaceTask
    | ChangeTask
    | MoveTask
    | RenameTask
    | WrapTasks
    | DissolveGroup
    | RenameGroup
    | ChangeGroup
    | SetTransitions
    | AddTransition
    | RemoveTransition
    | SetTarget
    | SetConditions
    | AddCondition
    | RemoveCondition
    | AddReaction
    | ChangeReaction
    | RemoveReaction
    | SetHeader,
    Field(discriminator="kind"),
]
"""any edit; `kind` distinguishes them"""

_KINDS = {command.model_fields["kind"].default for command in EditCommand.__subclasses__()}
FUNCTIONS: dict[str, Callable[..., Edited]] = {
    name: function
    for module in (tasks, removal, groups, transitions, reactions, header)
    for name, function in vars(module).items()
    if name in _KINDS
}
"""the function that executes each kind of edit, by `kind`"""

_EDIT: TypeAdapter[Edit] = TypeAdapter(Edit)


def apply(mission: Mission, edit: Edit) -> Edited:
    """Return the mission after the edit.

    Raises what the function of the edit's kind raises, and EditInvalid if an argument is not a
    mission or not an edit.
    """
    if not isinstance(mission, Mission):
        message = Message(
            "{with_article} is not a mission", with_article=with_article(type(mission).__name__)
        )
        raise invalid("edit.value", message, "read the mission from its file first")
    if not isinstance(edit, EditCommand):
        message = Message(
            "{with_article} is not an edit", with_article=with_article(type(edit).__name__)
        )
        raise invalid("edit.value", message, "read an edit in JSON with read_edit first")
    return FUNCTIONS[edit.kind](mission, **edit.given_fields())


def read_edit(text: str | bytes) -> Edit:
    """Parse an edit from JSON text. Raises EditInvalid."""
    try:
        edit = _EDIT.validate_json(text)
    except ValidationError as error:
        raise EditInvalid(invalid_value_diagnostics(error)) from None
    json.loads(text, object_pairs_hook=_require_unique_names, parse_int=str, parse_float=str)
    return edit


def _require_unique_names(pairs: list[tuple[str, object]]) -> None:
    for name, count in Counter(name for name, _ in pairs).items():
        if count > 1:
            message = Message(
                "`{name}` is given {count} times in one object", name=name, count=count
            )
            raise invalid("edit.value", message, "keep one of them")
