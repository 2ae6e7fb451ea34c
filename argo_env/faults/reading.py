"""Reads faults from a YAML file, with errors that say where it is wrong."""

from collections.abc import Sequence
from pathlib import Path

from argo_compiler.files.json_places import JsonPath
from argo_env.faults.kinds import AnyFault, FaultFile, misfits
from argo_env.files.yaml_file import placed, read_yaml
from argo_env.site import Site


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


def require_fit(faults: Sequence[AnyFault], path: Path, site: Site, seed: int) -> None:
    """Raises DiagnosticError, with the lines, if the site does not have what these faults, read
    from that file, are about. `seed` is the run's."""
    if found := misfits(faults, site, seed):
        places: dict[JsonPath, str] = {("faults", k): said for k, said in found.items()}
        raise placed(path, "faults.not-on-site", places)
