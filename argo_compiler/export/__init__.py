"""Exporters, which write a state machine in the formats of other tools.

`docs/export.md` lists what each format can express.
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = [
    "EXPORTERS",
    "ExportInput",
    "Exported",
    "Exporter",
    "InspectionView",
    "to_btcpp",
    "to_dot",
    "to_flexbe",
    "to_mermaid",
    "to_scxml",
]

if TYPE_CHECKING:
    from argo_compiler.export.btcpp import to_btcpp
    from argo_compiler.export.exporter import Exported, Exporter, ExportInput, InspectionView
    from argo_compiler.export.flexbe import to_flexbe
    from argo_compiler.export.graphviz import to_dot
    from argo_compiler.export.mermaid import to_mermaid
    from argo_compiler.export.registry import EXPORTERS
    from argo_compiler.export.scxml import to_scxml
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "btcpp": ["to_btcpp"],
            "exporter": ["ExportInput", "Exported", "Exporter", "InspectionView"],
            "flexbe": ["to_flexbe"],
            "graphviz": ["to_dot"],
            "mermaid": ["to_mermaid"],
            "registry": ["EXPORTERS"],
            "scxml": ["to_scxml"],
        },
    )
