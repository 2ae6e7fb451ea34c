"""Exporter of a checklist for a person who walks the round, as CSV: a line for each inspection."""

import csv
import io

from argo_compiler.export import Exporter, ExportInput
from argo_compiler.il import Action


def to_checklist(given: ExportInput) -> str:
    """Return the inspections of the mission in the order of its tasks, with where to stand."""
    views = given.find_views()
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["task", "checkpoint", "name", "x in m", "y in m", "z in m", "done"])
    for task in given.mission.tasks:
        if task.action is Action.MEASURE:
            view = views[task.object_id or ""]
            position = (f"{value:.1f}" for value in (view.pose.x, view.pose.y, view.pose.z))
            table.writerow([task.name, task.object_id, view.name, *position, ""])
    return text.getvalue()


EXPORTER = Exporter("checklist for a person, as CSV", (".csv",), to_checklist)
