"""Missions for isar, Equinor's supervisor of inspection robots (https://github.com/equinor/isar).

What it reads is the `StartMissionDefinition` of its API, version 1.34: inspections in a fixed
order. `docs/exchange.md` says what that can hold.
"""

from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names

__all__ = ["Imported", "InspectionView", "find_definition", "from_isar", "read_isar", "to_isar"]

if TYPE_CHECKING:
    from argo_compiler.isar.reading import Imported, from_isar, read_isar
    from argo_compiler.isar.recognition import find_definition
    from argo_compiler.isar.writing import InspectionView, to_isar
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "reading": ["Imported", "from_isar", "read_isar"],
            "recognition": ["find_definition"],
            "writing": ["InspectionView", "to_isar"],
        },
    )
