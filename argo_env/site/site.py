"""Site that is ready to use: its description, elements, checkpoints, docks and named poses."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.memoization import thread_safe_cached_property
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Pose
from argo_env.files import resources
from argo_env.site.family import PREFIX, is_generated_name
from argo_env.site.spec import FloorSpec, SiteSpec

if TYPE_CHECKING:
    from argo_env.site.index import SolidIndex, SolidRays
    from argo_env.site.shapes import Element, Vector

SCALES: dict[CheckpointKind, tuple[str, Interval]] = {
    CheckpointKind.PRESSURE_GAUGE: ("bar", Interval(low=0.0, high=10.0)),
    CheckpointKind.LIQUID_LEVEL_GAUGE: ("%", Interval(low=0.0, high=100.0)),
    CheckpointKind.VALVE: ("deg", Interval(low=0.0, high=90.0)),
}
"""Unit and scale of each kind of checkpoint; a valve is closed at 0 and open at 90 degrees."""


@dataclass(frozen=True)
class SiteCheckpoint:
    """Checkpoint in the site's frame: the middle of its face (m) and its direction (`yaw`, rad)."""

    id: int
    kind: CheckpointKind
    name: str
    floor: int
    position: "Vector"
    yaw: float
    nominal: Interval
    tags: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        return SCALES[self.kind][0]

    @property
    def range(self) -> Interval:
        return SCALES[self.kind][1]


@dataclass(frozen=True)
class Site:
    """Site: its description, the solids made from it, and the poses and checkpoints in it."""

    spec: SiteSpec
    checkpoints: tuple[SiteCheckpoint, ...]
    docks: dict[int, Pose]
    """pose of the docked robot for each starting area"""
    places: dict[str, Pose]
    """poses on the ground that have a name"""
    altered: "tuple[Element, ...] | None" = None
    """elements that replace those of the description; None if there are none"""

    @property
    def name(self) -> str:
        return self.spec.name

    # The check of a mission does not need its site's solids, so their modules are imported late.

    @thread_safe_cached_property
    def elements(self) -> "tuple[Element, ...]":
        """Named parts of the site, with their solids."""
        from argo_env.site.build import build_site

        return build_site(self.spec) if self.altered is None else self.altered

    @thread_safe_cached_property
    def solids(self) -> "SolidIndex":
        """Index that finds the solids of the site whose bounding boxes touch a box."""
        from argo_env.site.index import SolidIndex

        return SolidIndex(self.elements)

    @thread_safe_cached_property
    def rays(self) -> "SolidRays":
        """Ray casting against all solids of the site."""
        from argo_env.site.index import SolidRays

        return SolidRays(self.elements)

    def replacing_elements(self, elements: "tuple[Element, ...]") -> "Site":
        """Return a copy of this site with `elements` in place of all of its own.

        They may contain an obstacle, for example. If they are equal to its own, this returns the
        site itself.
        """
        return self if elements == self.elements else replace(self, altered=elements)

    def checkpoint(self, id: int) -> SiteCheckpoint:
        """Return the checkpoint with this id; raises NotFound if there is none."""
        for checkpoint in self.checkpoints:
            if checkpoint.id == id:
                return checkpoint
        numbers = (checkpoint.id for checkpoint in self.checkpoints)
        raise NotFound(
            Message(
                "site {site} has no checkpoint {id}; {there_are}",
                site=self.name,
                id=id,
                there_are=_there_are(numbers),
            )
        )

    def checkpoint_for(self, object_id: str | None) -> SiteCheckpoint:
        """Return the checkpoint that tasks call `object_id`; raises NotFound if none or None."""
        for checkpoint in self.checkpoints:
            if str(checkpoint.id) == object_id:
                return checkpoint
        raise NotFound(
            Message(
                "site {site} has no checkpoint {object_id}", site=self.name, object_id=object_id
            )
        )

    def floor(self, number: int) -> FloorSpec:
        """Return the floor with this number; raises NotFound if there is none."""
        for floor in self.spec.floors:
            if floor.number == number:
                return floor
        numbers = (floor.number for floor in self.spec.floors)
        raise NotFound(
            Message(
                "site {site} has no floor {number}; {there_are}",
                site=self.name,
                number=number,
                there_are=_there_are(numbers),
            )
        )

    def floor_at(self, z: float) -> int:
        """Return the number of the highest floor that lies at most 0.1 m above the height `z` (m).

        It is 1 if `z` is below all floors.
        """
        return max([f.number for f in self.spec.floors if f.z <= z + 0.1], default=1)


def _there_are(numbers: Iterable[int]) -> str:
    """Return a text that lists the numbers, with consecutive ones as `1 to 4`."""
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][-1] + 1:
            runs[-1][1:] = [number]
        else:
            runs.append([number])
    return Message(
        "there are: {value}",
        value=Listing(" to ".join(map(str, run)) for run in runs) or Message("none"),
    )


def site_names() -> tuple[str, ...]:
    """Return the names of the sites that Argo ships, sorted."""
    return tuple(sorted(p.parent.name for p in resources.scenarios_folder().glob("*/site.yaml")))


def load_site(name_or_path: str) -> Site:
    """Return the shipped site with this name, or the one that a file with this path describes.

    Raises ArgoError if there is no such site, if `name_or_path` is the name of a generated site
    (`generated:…`, see `open_site`), or if the description is wrong; the message then states the
    place in the file.
    """
    from argo_env.site.site_file import read_site_spec

    return make_site(read_site_spec(site_file(name_or_path)))


def site_file(name_or_path: str) -> Path:
    """Return the path of the file that describes a site.

    `name_or_path` is the name of a shipped site, or a path that ends in `.yaml` or `.yml`, which
    is returned even if there is no such file. Raises NotFound if no site has this name, and Invalid
    if it is that of a generated site.
    """
    if is_generated_name(name_or_path):
        raise Invalid(
            Message(
                "site `{name_or_path}` is generated and has no file: open it with `open_site`",
                name_or_path=name_or_path,
            )
        )
    path = Path(name_or_path)
    if path.suffix in {".yaml", ".yml"}:
        return path
    if name_or_path not in site_names():
        known = Listing(site_names())
        raise NotFound(
            Message(
                "no site `{name_or_path}`; there are: {known}, or a path to a site's "
                ".yaml, or {prefix}floors=3,seed=7",
                name_or_path=name_or_path,
                known=known,
                prefix=PREFIX,
            )
        )
    return resources.scenarios_folder() / name_or_path / "site.yaml"


def make_site(spec: SiteSpec) -> Site:
    """Return the site that `spec` describes."""
    checkpoints = tuple(
        SiteCheckpoint(
            c.id,
            c.kind,
            c.name,
            floor.number,
            (c.position[0], c.position[1], floor.z + c.position[2]),
            math.radians(c.yaw),
            c.nominal,
            c.tags,
        )
        for floor in spec.floors
        for c in floor.checkpoints
    )
    return Site(
        spec,
        tuple(sorted(checkpoints, key=lambda c: c.id)),
        {a.number: _ground_pose(a.dock, spec) for a in spec.areas},
        {p.name: _ground_pose(p.pose, spec) for p in spec.places},
    )


def _ground_pose(pose: tuple[float, float, float], spec: SiteSpec) -> Pose:
    return Pose(x=pose[0], y=pose[1], z=spec.ground_z, yaw=math.radians(pose[2]))
