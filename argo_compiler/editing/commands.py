"""The edits as data, so that they can be sent, kept and made again.

Each is the call of a function of this package: its `kind` is the function's name, its other fields
are the function's parameters. As JSON an edit has only what was given: in a header `null` takes a
value away, and what is not there stays.
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

from argo_compiler.base.model import Model, Pose
from argo_compiler.editing import groups, header, reactions, removal, tasks, transitions
from argo_compiler.editing.consequences import Edited
from argo_compiler.editing.header import wrong_values
from argo_compiler.editing.refusals import EditInvalid, invalid
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
    """The call of one function of `argo_compiler.editing` on a mission."""

    kind: str

    def given(self) -> dict[str, Any]:
        """What the edit says: what is not there keeps its default, or stays as it is."""
        return {name: getattr(self, name) for name in self.model_fields_set if name != "kind"}

    def __eq__(self, other: object) -> bool:
        # A value that is given changes something where one that is not given stays.
        if not isinstance(other, EditCommand):
            return NotImplemented
        return self.kind == other.kind and self.given() == other.given()

    def __hash__(self) -> int:
        return hash((self.kind, frozenset(self.given().items())))

    @model_serializer(mode="wrap")
    def _as_given(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = write(self)
        return {k: v for k, v in written.items() if k == "kind" or k in self.model_fields_set}


class AddTask(EditCommand):
    """See `add_task`."""

    kind: Literal["add_task"] = "add_task"
    task: Task
    before: str | None = None
    after: str | None = None
    first: bool = False
    into: str | None = None


class RemoveTask(EditCommand):
    """See `remove_task`."""

    kind: Literal["remove_task"] = "remove_task"
    name: str


class ReplaceTask(EditCommand):
    """See `replace_task`."""

    kind: Literal["replace_task"] = "replace_task"
    name: str
    task: Task


class ChangeTask(EditCommand):
    """See `change_task`. What is not given stays."""

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
    """See `move_task`."""

    kind: Literal["move_task"] = "move_task"
    name: str
    before: str | None = None
    after: str | None = None
    first: bool = False
    into: str | None = None


class RenameTask(EditCommand):
    """See `rename_task`."""

    kind: Literal["rename_task"] = "rename_task"
    name: str
    new_name: str


class WrapTasks(EditCommand):
    """See `wrap_tasks`."""

    kind: Literal["wrap_tasks"] = "wrap_tasks"
    group: Group


class DissolveGroup(EditCommand):
    """See `dissolve_group`."""

    kind: Literal["dissolve_group"] = "dissolve_group"
    name: str


class RenameGroup(EditCommand):
    """See `rename_group`."""

    kind: Literal["rename_group"] = "rename_group"
    name: str
    own_name: str


class ChangeGroup(EditCommand):
    """See `change_group`. What is not given stays."""

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
    """See `set_transitions`."""

    kind: Literal["set_transitions"] = "set_transitions"
    task: str
    transitions: tuple[Transition, ...]


class AddTransition(EditCommand):
    """See `add_transition`."""

    kind: Literal["add_transition"] = "add_transition"
    task: str
    transition: Transition
    at: int | None = None


class RemoveTransition(EditCommand):
    """See `remove_transition`."""

    kind: Literal["remove_transition"] = "remove_transition"
    task: str
    at: int


class SetTarget(EditCommand):
    """See `set_target`."""

    kind: Literal["set_target"] = "set_target"
    task: str
    at: int
    target: str


class SetConditions(EditCommand):
    """See `set_conditions`."""

    kind: Literal["set_conditions"] = "set_conditions"
    task: str
    at: int
    conditions: tuple[Condition, ...]


class AddCondition(EditCommand):
    """See `add_condition`."""

    kind: Literal["add_condition"] = "add_condition"
    task: str
    at: int
    condition: Condition


class RemoveCondition(EditCommand):
    """See `remove_condition`."""

    kind: Literal["remove_condition"] = "remove_condition"
    task: str
    at: int
    condition: int


class AddReaction(EditCommand):
    """See `add_reaction`."""

    kind: Literal["add_reaction"] = "add_reaction"
    reaction: Reaction


class ChangeReaction(EditCommand):
    """See `change_reaction`."""

    kind: Literal["change_reaction"] = "change_reaction"
    event: EventKind
    reaction: Reaction


class RemoveReaction(EditCommand):
    """See `remove_reaction`."""

    kind: Literal["remove_reaction"] = "remove_reaction"
    event: EventKind


class SetHeader(EditCommand):
    """See `set_header`. What is not given stays."""

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
"""all edits there are, told apart by `kind`"""

_KINDS = {command.model_fields["kind"].default for command in EditCommand.__subclasses__()}
FUNCTIONS: dict[str, Callable[..., Edited]] = {
    name: function
    for module in (tasks, removal, groups, transitions, reactions, header)
    for name, function in vars(module).items()
    if name in _KINDS
}
"""what makes the edit of each kind"""

_EDIT: TypeAdapter[Edit] = TypeAdapter(Edit)


def apply(mission: Mission, edit: Edit) -> Edited:
    """The mission after the edit. Raises what the function of the edit's kind raises, and
    EditInvalid for what is no edit or mission."""
    if not isinstance(mission, Mission):
        message = f"a {type(mission).__name__} is no mission"
        raise invalid("edit.value", message, "read the mission from its file first")
    if not isinstance(edit, EditCommand):
        message = f"a {type(edit).__name__} is no edit"
        raise invalid("edit.value", message, "read an edit in JSON with read_edit first")
    return FUNCTIONS[edit.kind](mission, **edit.given())


def read_edit(text: str | bytes) -> Edit:
    """The edit that a JSON text holds. Raises EditInvalid."""
    try:
        edit = _EDIT.validate_json(text)
    except ValidationError as error:
        raise EditInvalid(wrong_values(error)) from None
    json.loads(text, object_pairs_hook=_require_once, parse_int=str, parse_float=str)
    return edit


def _require_once(pairs: list[tuple[str, object]]) -> None:
    for name, count in Counter(name for name, _ in pairs).items():
        if count > 1:
            message = f"`{name}` is given {count} times in one object"
            raise invalid("edit.value", message, "keep one of them")
