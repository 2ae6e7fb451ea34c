"""Exporters, which write a state machine in the formats of other tools.

`docs/export.md` lists what each format can express.
"""

from argo_compiler.export.btcpp import to_btcpp
from argo_compiler.export.exporter import Exported, Exporter
from argo_compiler.export.flexbe import to_flexbe
from argo_compiler.export.graphviz import to_dot
from argo_compiler.export.mermaid import to_mermaid
from argo_compiler.export.registry import EXPORTERS
from argo_compiler.export.scxml import to_scxml

__all__ = [
    "EXPORTERS",
    "Exported",
    "Exporter",
    "to_btcpp",
    "to_dot",
    "to_flexbe",
    "to_mermaid",
    "to_scxml",
]
