"""Table of the export formats; a new format is added here."""

from argo_compiler.export.btcpp import to_btcpp
from argo_compiler.export.exporter import Exporter
from argo_compiler.export.flexbe import to_flexbe
from argo_compiler.export.graphviz import to_dot
from argo_compiler.export.mermaid import to_mermaid
from argo_compiler.export.ros import ROS_EXPORTERS
from argo_compiler.export.scxml import to_scxml

EXPORTERS: dict[str, Exporter] = {
    "scxml": Exporter("SCXML state chart, time-outs sent from outside", (".scxml",), to_scxml),
    "scxml-timers": Exporter(
        "SCXML state chart, time-outs sent by the engine's clock",
        (".scxml",),
        lambda mission, hfsm: to_scxml(mission, hfsm, timers=True),
    ),
    "btcpp": Exporter("BehaviorTree.CPP 4 tree", (".xml",), lambda mission, _: to_btcpp(mission)),
    "flexbe": Exporter("FlexBE behaviour, its states and its manifest", (), to_flexbe),
    "mermaid": Exporter(
        "Mermaid state diagram", (".mmd", ".mermaid"), lambda _, hfsm: to_mermaid(hfsm)
    ),
    "dot": Exporter("Graphviz graph", (".dot", ".gv"), lambda _, hfsm: to_dot(hfsm)),
    **ROS_EXPORTERS,
}
"""Exporters by the names of their formats."""
