"""How missions, machines and records are shown in notebooks: as a table, a diagram, a report.

In IPython and Jupyter `import argo_env` is enough; elsewhere nothing is imported for it.
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
    """The tasks of a mission, one a line, and what its sheet says."""
    said = [mission.designation or "Mission", f"{len(mission.tasks)} tasks"]
    if mission.max_duration is not None:
        said.append(f"at most {mission.max_duration:g} s")
    head = "".join(f"<th>{name}</th>" for name in ("task", "action", "of", "group", "then"))
    lines = "".join(f"<tr>{_cells(task)}</tr>" for task in mission.tasks)
    return (
        f"<p><b>{escape(said[0])}</b>, {escape(', '.join(said[1:]))}</p>"
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
    """The diagram of a machine; of one that is too large to be drawn, its Mermaid text."""
    from argo_compiler.export import to_mermaid
    from argo_env.report.html import machine_page
    from argo_env.report.machine import drawable

    if not drawable(machine):
        return f"<pre>{escape(to_mermaid(machine))}</pre>"
    return _framed(machine_page(machine))


def record_html(record: "RunRecord") -> str:
    """The report of a run; only how it went if its site can't be opened by its name."""
    from argo_compiler.base.errors import ArgoError
    from argo_env.planning.opening import open_site
    from argo_env.report.html import page

    try:
        site = open_site(record.site).site
    except ArgoError:
        return f"<p>{escape(str(record.headline))}</p>"
    return _framed(page(record, site))


def _framed(page: str) -> str:
    """A page in a frame of its own, so that its style is its own as well."""
    return (
        f'<iframe srcdoc="{escape(page)}" style="width:100%;height:{_HEIGHT}px;border:0" '
        'sandbox=""></iframe>'
    )


_SHOWN: dict[tuple[str, str], Callable[[Any], str]] = {
    ("argo_compiler.il.mission", "Mission"): mission_html,
    ("argo_compiler.hfsm.model", "Hfsm"): machine_html,
    ("argo_env.run.record", "RunRecord"): record_html,
}
"""By module and name of the class, what shows its objects."""


def register_with_ipython() -> None:
    """Lets IPython show them, if this process is a notebook's or IPython's."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        html = shell.display_formatter.formatters["text/html"]
        for (module, name), show in _SHOWN.items():
            html.for_type_by_name(module, name, show)
