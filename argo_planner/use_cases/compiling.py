"""Lowering of missions to state machines."""

from dataclasses import dataclass

from argo_compiler.export import to_mermaid
from argo_compiler.hfsm import Hfsm, lower
from argo_planner.use_cases.importing import ImportedMission


@dataclass(frozen=True)
class CompiledMission:
    """The state machine of a mission."""

    machine: Hfsm

    @property
    def json(self) -> str:
        """The machine as the content of its file."""
        return self.machine.model_dump_json(indent=2) + "\n"

    @property
    def mermaid(self) -> str:
        """The machine as a Mermaid diagram."""
        return to_mermaid(self.machine)


def compile_mission(imported: ImportedMission) -> CompiledMission:
    """Lower a mission to its state machine; raise DiagnosticError if the mission has errors."""
    return CompiledMission(lower(imported.mission, source_name=imported.source_name))
