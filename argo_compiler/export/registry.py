"""Extension point of the export formats.

A new format of Argo is added here, or, as `btcpp`, `flexbe` and `isar`, by an entry point in
`pyproject.toml`, so that it is imported only when it is used.
"""

from argo_compiler.base.extensions import ExtensionPoint
from argo_compiler.export.exporter import Exporter
from argo_compiler.export.graphviz import to_dot
from argo_compiler.export.mermaid import to_mermaid
from argo_compiler.export.ros import ROS_EXPORTERS
from argo_compiler.export.scxml import to_scxml


def _find_problem(name: str, item: object) -> str | None:  # noqa: ARG001
    return None if isinstance(item, Exporter) else "is no `argo_compiler.export.Exporter`"


EXPORTERS: ExtensionPoint[Exporter] = ExtensionPoint(
    "argo.exporters",
    "format",
    {
        "scxml": Exporter(
            "SCXML state chart, time-outs sent from outside",
            (".scxml",),
            lambda given: to_scxml(given.mission, given.machine),
        ),
        "scxml-timers": Exporter(
            "SCXML state chart, time-outs sent by the engine's clock",
            (".scxml",),
            lambda given: to_scxml(given.mission, given.machine, timers=True),
        ),
        "mermaid": Exporter(
            "Mermaid state diagram", (".mmd", ".mermaid"), lambda given: to_mermaid(given.machine)
        ),
        "dot": Exporter("Graphviz graph", (".dot", ".gv"), lambda given: to_dot(given.machine)),
        **ROS_EXPORTERS,
    },
    _find_problem,
    reserved=("script", "json"),  # the service exports these, too
)
"""exporters by the names of their formats"""
