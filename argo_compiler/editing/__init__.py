"""Edits: functions that return a changed mission and keep the rules of the language.

Each returns `Edited`: the mission, and what else had to change. An edit that is not possible raises
an `EditError` that names the reason. Missions are frozen and share what did not change, so a
person's steps can be stored and undone. An edit can also be data
(`argo_compiler.editing.commands`), which `apply` executes. `docs/editing.md` shows examples.
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "Consequence",
    "Edit",
    "EditConflict",
    "EditError",
    "EditInvalid",
    "EditNotFound",
    "Edited",
    "add_condition",
    "add_reaction",
    "add_task",
    "add_transition",
    "apply",
    "change_group",
    "change_reaction",
    "change_task",
    "dissolve_group",
    "move_task",
    "read_edit",
    "remove_condition",
    "remove_reaction",
    "remove_task",
    "remove_transition",
    "rename_group",
    "rename_task",
    "replace_task",
    "set_conditions",
    "set_header",
    "set_target",
    "set_transitions",
    "wrap_tasks",
]

if TYPE_CHECKING:
    from argo_compiler.editing.commands import Edit, apply, read_edit
    from argo_compiler.editing.consequences import Consequence, Edited
    from argo_compiler.editing.errors import EditConflict, EditError, EditInvalid, EditNotFound
    from argo_compiler.editing.groups import change_group, dissolve_group, rename_group, wrap_tasks
    from argo_compiler.editing.header import set_header
    from argo_compiler.editing.reactions import add_reaction, change_reaction, remove_reaction
    from argo_compiler.editing.removal import remove_task
    from argo_compiler.editing.tasks import (
        add_task,
        change_task,
        move_task,
        rename_task,
        replace_task,
    )
    from argo_compiler.editing.transitions import (
        add_condition,
        add_transition,
        remove_condition,
        remove_transition,
        set_conditions,
        set_target,
        set_transitions,
    )

else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "commands": ["Edit", "apply", "read_edit"],
            "consequences": ["Consequence", "Edited"],
            "groups": ["change_group", "dissolve_group", "rename_group", "wrap_tasks"],
            "header": ["set_header"],
            "reactions": ["add_reaction", "change_reaction", "remove_reaction"],
            "errors": ["EditConflict", "EditError", "EditInvalid", "EditNotFound"],
            "removal": ["remove_task"],
            "tasks": ["add_task", "change_task", "move_task", "rename_task", "replace_task"],
            "transitions": [
                "add_condition",
                "add_transition",
                "remove_condition",
                "remove_transition",
                "set_conditions",
                "set_target",
                "set_transitions",
            ],
        },
    )
