"""A site that is ready for work: the one way to get geometry, paths, names and travel times."""

import hashlib
import logging
import os
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.stages import stage
from argo_compiler.files.loading import read_text
from argo_env.files import cache
from argo_env.files.parts import NO_CACHE, Parts
from argo_env.planning.catalog import kept_catalog, make_catalog
from argo_env.planning.code import digest_of_code
from argo_env.robot.spec import RobotSpec, load_robot, validate_robot
from argo_env.site import Site, make_site
from argo_env.site.family import Family, is_family, parse_family
from argo_env.site.site import site_file
from argo_env.site.spec import MAX_BYTES, SiteSpec

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.planning.travel import SiteTravel

_log = logging.getLogger(__name__)

_KEPT = 8  # sites in memory; each holds some 100 MB
_PATHS = 4096  # of a site; simulations go the same ways again and again


class OpenedSite:
    """A site with all that planning and driving on it need. Keeps what it has worked out.

    All who open a site share one, and so do its copies. It is pickled by its reference, or by its
    description where it was made in memory: who unpickles it opens the site again.
    """

    def __init__(
        self, reference: str | None, site: Site, robot: RobotSpec, parts: Parts = NO_CACHE
    ) -> None:
        """What takes long to find is looked up in `parts`, and kept there."""
        self._reference = reference
        self.site = site
        self.robot = robot
        self.parts = parts

    @staticmethod
    def of(site: Site, robot: RobotSpec | None = None) -> "OpenedSite":
        """A site that was made in memory, for the tracker unless told otherwise."""
        robot = robot or load_robot()
        if site.altered is None:
            return _make_again(site.spec, robot)
        return OpenedSite(None, site, robot)

    @staticmethod
    def of_navigator(navigator: "Navigator") -> "OpenedSite":
        """The site of a navigator that was made in memory, with that navigator."""
        opened = OpenedSite(None, navigator.site, navigator.robot, navigator.parts)
        opened.navigator = navigator
        return opened

    @property
    def reference(self) -> str:
        """What opens it again: the site's name, the whole path of its file, or its parameters. Of a
        site made in memory just its name."""
        return self._reference or self.name

    @property
    def name(self) -> str:
        return self.site.name

    # A mission that was checked before is checked without what follows: imported when needed.

    @cached_property
    def navigator(self) -> "Navigator":
        """What finds paths on the site; remembers those that it planned last."""
        from argo_env.navigation import Navigator

        return Navigator(self.site, self.robot, self.parts, cached_paths=_PATHS)

    @cached_property
    def catalog(self) -> Catalog:
        """What scripts may name on the site."""
        return kept_catalog(self.site, self.parts) or make_catalog(self.navigator)

    @cached_property
    def travel(self) -> "SiteTravel":
        """Travel times and energy, for the analysis and for routes."""
        from argo_env.planning.travel import SiteTravel

        return SiteTravel(self)

    @cached_property
    def digest(self) -> str:
        """A digest of the site's description and the robot's."""
        text = self.site.spec.model_dump_json() + self.robot.model_dump_json()
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()

    def prepare(self) -> "OpenedSite":
        """Finds out now what all paths share, so that no later call takes the time for it.

        Raises ArgoError if the robot can't drive on the site.
        """
        self.navigator.prepare()
        return self

    def __copy__(self) -> "OpenedSite":
        return self

    def __deepcopy__(self, _: dict[int, Any]) -> "OpenedSite":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        if self._reference is not None:
            return _open_again, (self._reference, self.robot, self.digest)
        if self.site.altered is not None:
            raise Conflict(
                f"site {self.name} is not as its description says, and can't be sent to another "
                "process; send the faults that have changed it, and apply them there"
            )
        return _make_again, (self.site.spec, self.robot)


def open_site(reference: str = "umad", robot: RobotSpec | None = None) -> OpenedSite:
    """The site of that name, the one that the file `reference` describes, or a generated one such
    as `generated:floors=3,seed=7`, ready for work by the `robot` (the tracker).

    Equal calls give the same object, also from several threads at once, however the parameters of
    a generated site are written; of a file that has changed a new one is made. What takes long to
    find is kept on disk from process to process.

    Raises NotFound if there is no such site, and ArgoError, with the place in the file, if it makes
    no sense. That the robot can't drive there shows with the first path: see `prepare`.
    """
    if not isinstance(reference, str):
        raise Invalid(f"{reference!r} is no text: a site is opened by its name or its file's path")
    robot = validate_robot(robot) if robot else load_robot()
    if is_family(reference):
        family = parse_family(reference)
        if parse_family(str(family)) == family:  # a text may lack digits
            reference = str(family)
        return _open(reference, family.model_dump_json(), robot, partial(_draw, family, robot))
    path = site_file(reference)
    text = read_text(path, "site", MAX_BYTES)
    if path == Path(reference):
        reference = os.path.realpath(path)

    def described() -> Site:
        from argo_env.site.site_file import parse_site_spec

        return make_site(parse_site_spec(text, str(path)))

    return _open(reference, text, robot, described)


def forget_sites() -> None:
    """Lets go of the sites in memory; those who use them keep them."""
    with _lock:
        _slots.clear()


@dataclass
class _Slot:
    """Room for an opened site. Filled once, by whoever is first."""

    lock: Lock = field(default_factory=Lock)
    opened: OpenedSite | None = None


_lock = Lock()
_slots: OrderedDict[tuple[str | None, ...], _Slot] = OrderedDict()


def _open(
    reference: str | None, text: str, robot: RobotSpec, make: Callable[[], "Site | Navigator"]
) -> OpenedSite:
    """The site that is opened by `reference` and made from `text`, by `make` if it is new."""
    key = reference, text, robot.model_dump_json()
    with _lock:
        slot = _slots.setdefault(key, _Slot())
        _slots.move_to_end(key)
        while len(_slots) > _KEPT:
            _slots.popitem(last=False)
    with slot.lock:
        if slot.opened is None:
            parts = cache.entry_for((digest_of_code(), text, robot.model_dump_json()))
            known = parts.load_text("site")
            _log.info("the site is %s", "made" if known is None else "taken from the cache on disk")
            if known is None:
                with stage(f"making the site {reference or ''}".rstrip()):
                    slot.opened = _keep(reference, robot, parts, make())
            else:
                site = make_site(SiteSpec.model_validate_json(known))
                slot.opened = OpenedSite(reference, site, robot, parts)
        return slot.opened


def _keep(
    reference: str | None, robot: RobotSpec, parts: Parts, made: "Site | Navigator"
) -> OpenedSite:
    """A new site, with what its making has found, kept on disk."""
    cache.evict()
    site = made if isinstance(made, Site) else made.site
    parts.store_text("site", site.spec.model_dump_json())
    opened = OpenedSite(reference, site, robot, parts)
    if not isinstance(made, Site):
        opened.navigator.adopt_results(made)
    return opened


def _draw(family: Family, robot: RobotSpec) -> "Navigator":
    from argo_env.planning.generated import generate

    return generate(family, robot)


def _open_again(reference: str, robot: RobotSpec, digest: str) -> OpenedSite:
    opened = open_site(reference, robot)
    if opened.digest != digest:
        raise Conflict(
            f"site {reference} has changed since it was opened where this comes from; open it "
            "again there"
        )
    return opened


def _make_again(spec: SiteSpec, robot: RobotSpec) -> OpenedSite:
    return _open(None, spec.model_dump_json(), robot, partial(make_site, spec))
