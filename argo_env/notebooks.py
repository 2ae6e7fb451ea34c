"""Display of missions, machines and records in notebooks: as a table, a diagram, a report.

In IPython and Jupyter `import argo_env` is sufficient; elsewhere nothing is imported for it.
"""

import sys
from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from argo_compiler.hfsm import Hfsm
    from argo_compiler.il import Mission, Task
    from argo_env.run.record import RunRecord

_HEIGHT = 640  # px of a report


def mission_html(mission: "Mission") -> str:
    """Return an HTML table of a mission's tasks.

    Above it are the mission's designation, its number of tasks and, if it has one, its maximum
    duration.
    """
    title, limits = mission.designation or "Mission", [f"{len(mission.tasks)} tasks"]
    if mission.max_duration is not None:
        limits.append(f"at most {mission.max_duration:g} s")
    head = "".join(f"<th>{name}</th>" for name in ("task", "action", "of", "group", "then"))
    lines = "".join(f"<tr>{_cells(task)}</tr>" for task in mission.tasks)
    return (
        f"<p><b>{escape(title)}</b>, {escape(', '.join(limits))}</p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{lines}</tbody></table>"
    )


def _cells(task: "Task") -> str:
    then = [
        transition.target + (" if …" if transition.conditions else "")
        for transition in task.transitions
    ]
    cells = (task.name, str(task.action), task.object_id or "", task.group, ", ".join(then))
    return "".join(f"<td>{escape(cell)}</td>" for cell in cells)


def machine_html(machine: "Hfsm") -> str:
    """Return HTML that shows a state machine's diagram, or its Mermaid text if it is too large."""
    from argo_compiler.export import to_mermaid
    from argo_env.report.html import machine_page
    from argo_env.report.machine import is_drawable

    if not is_drawable(machine):
        return f"<pre>{escape(to_mermaid(machine))}</pre>"
    return _framed(machine_page(machine))


def record_html(record: "RunRecord") -> str:
    """Return HTML with the report of a run, or only its headline if its site can't be opened."""
    from argo_compiler.base.errors import ArgoError
    from argo_env.planning.opening import open_site
    from argo_env.report.html import page

    try:
        site = open_site(record.site).site
    except ArgoError:
        return f"<p>{escape(str(record.headline))}</p>"
    return _framed(page(record, site))


def _framed(page: str) -> str:
    """Return an HTML page in a frame, so that the page's style does not affect the notebook."""
    return (
        f'<iframe srcdoc="{escape(page)}" style="width:100%;height:{_HEIGHT}px;border:0" '
        'sandbox=""></iframe>'
    )


_HTML_FUNCTIONS: dict[tuple[str, str], Callable[[Any], str]] = {
    ("argo_compiler.il.mission", "Mission"): mission_html,
    ("argo_compiler.hfsm.model", "Hfsm"): machine_html,
    ("argo_env.run.record", "RunRecord"): record_html,
}
"""Functions that return the HTML of an object, by the module and name of its class."""


def register_with_ipython() -> None:
    """Make IPython show missions, state machines and records as HTML.

    Outside of IPython this does nothing.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        html = shell.display_formatter.formatters["text/html"]
        for (module, name), show in _HTML_FUNCTIONS.items():
            html.for_type_by_name(module, name, show)
