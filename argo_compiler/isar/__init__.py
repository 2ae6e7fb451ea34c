"""Missions for isar, Equinor's supervisor of inspection robots (https://github.com/equinor/isar).

What it reads is the `StartMissionDefinition` of its API, version 1.34: inspections in a fixed
order. `docs/exchange.md` says what that can hold.
"""

from argo_compiler.isar.reading import Imported, from_isar, read_isar
from argo_compiler.isar.writing import InspectionView, to_isar

__all__ = ["Imported", "InspectionView", "from_isar", "read_isar", "to_isar"]
