"""Import and export of missions for isar, Equinor's software for inspection robots.

isar (https://github.com/equinor/isar) reads the `StartMissionDefinition` of its API, version 1.34:
inspections in a fixed order. `docs/exchange.md` describes which missions that can express.
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = ["Imported", "InspectionView", "find_isar_data", "from_isar", "read_isar", "to_isar"]

if TYPE_CHECKING:
    from argo_compiler.export.exporter import InspectionView
    from argo_compiler.isar.exporter import to_isar
    from argo_compiler.isar.importer import Imported, from_isar, read_isar
    from argo_compiler.isar.recognition import find_isar_data
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "importer": ["Imported", "from_isar", "read_isar"],
            "recognition": ["find_isar_data"],
            "exporter": ["InspectionView", "to_isar"],
        },
    )
