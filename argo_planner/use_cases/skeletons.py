"""Commented skeletons of the files that users write: missions, sites, faults and evaluations."""

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from string import Template

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message

_FOLDER = Path(__file__).parents[1] / "skeletons"


class SkeletonKind(StrEnum):
    """Kind of file that has a skeleton."""

    MISSION = "mission"
    SITE = "site"
    EVALUATION = "evaluation"
    FAULTS = "faults"


def skeleton_file_name(kind: SkeletonKind, name: str) -> str:
    """Return the name of the file of a skeleton. Raises Invalid if `name` can't be its name."""
    if not name or name != Path(name).name or not name.replace("_", "").replace("-", "").isalnum():
        raise Invalid(Message("`{name}` can't be a name: use letters, digits, - and _", name=name))
    return f"{name}.txt" if kind is SkeletonKind.MISSION else f"{name}.yaml"


def fill_skeleton(kind: SkeletonKind, name: str, values: Mapping[str, str]) -> str:
    """Return the text of a skeleton.

    Args:
        kind: Kind of the file.
        name: Name of what the file describes, and of the file.
        values: Texts for the placeholders of the skeleton but `name`; see `site_values`.
    """
    path = next(_FOLDER.glob(f"{kind}.*"))
    return Template(path.read_text(encoding="utf-8")).substitute(values, name=name)


def site_values(site: str, catalog: Catalog) -> dict[str, str]:
    """Return what skeletons say about a site: its name, a starting area, and two checkpoints.

    Raises Invalid if the site has no starting area or no checkpoint.
    """
    if not catalog.areas or not catalog.checkpoints:
        raise Invalid(
            Message("{site} has no starting area or no checkpoint: choose another site", site=site)
        )
    first, last = catalog.checkpoints[0], catalog.checkpoints[-1]
    return {
        "site": site,
        "area": str(catalog.areas[0].number),
        "first": str(first.id),
        "second": last.name,
    }
