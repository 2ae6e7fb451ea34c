"""Test whether the robot is docked on all execution paths."""

from argo_compiler.analysis.study import Study
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Task
from argo_compiler.il.docked import is_at_dock


def is_docked_after(study: Study, leaf: int, dock: Pose) -> bool:
    """Return True if the robot is certainly at the dock after a leaf; a WAIT does not move it."""
    seen = {leaf}
    pending = [leaf]
    while pending:
        node = pending.pop()
        if study.flow.is_leaf(node) and study.flow.leaves[node].wait is None:
            missed = node != leaf and study.flow.leaves[node].deadline is not None
            if missed or not _drives_to(study.leaf_task(node), dock):
                return False
            continue
        before = study.predecessors[node]
        cut = not study.flow.is_leaf(node) and study.flow.group_of_round_end(node) is None
        if cut or node == study.flow.initial or not before:
            return False
        pending += [other for other in before if other not in seen]
        seen.update(before)
    return True


def _drives_to(task: Task, dock: Pose) -> bool:
    return task.action is Action.WAYPOINT and task.pose is not None and is_at_dock(task.pose, dock)
