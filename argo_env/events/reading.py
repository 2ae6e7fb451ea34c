"""Reads faults from a YAML file, with errors that say where it is wrong."""

from pathlib import Path

from argo_env.events.kinds import AnyFault, FaultFile
from argo_env.yaml_file import read_yaml


def read_faults(path: Path) -> tuple[AnyFault, ...]:
    """The faults in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it holds no faults.
    """
    return read_yaml(
        path,
        FaultFile,
        "faults",
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
        no_field={
            "at": "a fault of this kind is there from the start: remove it",
            "until": "a fault of this kind is there from the start, and stays: remove it",
        },
    ).faults
