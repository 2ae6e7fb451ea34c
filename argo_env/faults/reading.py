"""Reads faults from YAML, with errors that say where it is wrong."""

from dataclasses import dataclass
from pathlib import Path

from argo_compiler.files.json_places import JsonPath
from argo_compiler.files.reading import decode_text, read_bytes, require_size
from argo_env.faults.kinds import AnyFault, FaultFile, misfits
from argo_env.files.yaml_file import parse_yaml, placed
from argo_env.site import Site

MAX_BYTES = 10_000_000
"""of a file of faults; one takes some hundred bytes"""


@dataclass(frozen=True)
class FaultText:
    """Faults, with the text that they were read from and what it is called."""

    faults: tuple[AnyFault, ...]
    text: str
    source_name: str

    def require_fit(self, site: Site, seed: int) -> None:
        """Raises DiagnosticError, with the lines, if the site does not have what these faults are
        about. `seed` is the run's."""
        if found := misfits(self.faults, site, seed):
            places: dict[JsonPath, str] = {("faults", k): said for k, said in found.items()}
            raise placed(self.text, self.source_name, "faults.not-on-site", places)


def read_faults(path: Path) -> tuple[AnyFault, ...]:
    """The faults in a YAML file.

    Raises ArgoError if the file can't be read, and DiagnosticError if it holds no faults.
    """
    return decode_faults(read_bytes(path, "file of faults", MAX_BYTES), str(path)).faults


def decode_faults(content: bytes, source_name: str) -> FaultText:
    """The faults in YAML, which messages call `source_name`. Raises as `read_faults`."""
    require_size(content, source_name, "file of faults", MAX_BYTES)
    text = decode_text(content, source_name, "file of faults")
    found = parse_yaml(
        text,
        source_name,
        FaultFile,
        "faults",
        not_yaml="faults.not-yaml",
        duplicate_key="faults.duplicate-key",
        wrong_field="faults.wrong-field",
        no_field={
            "at": "a fault of this kind is there from the start: remove it",
            "until": "a fault of this kind is there from the start, and stays: remove it",
        },
    )
    return FaultText(found.faults, text, source_name)
