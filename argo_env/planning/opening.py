"""Opened sites, which have the geometry, paths, names and travel times for planning and driving."""

import hashlib
import logging
import os
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.memoization import thread_safe_cached_property
from argo_compiler.base.message import Message
from argo_compiler.base.stages import stage
from argo_compiler.files.loading import read_text
from argo_env.files import cache
from argo_env.files.parts import NO_CACHE, Parts
from argo_env.planning.catalog import load_catalog, make_catalog
from argo_env.planning.code import code_digest
from argo_env.robot.spec import RobotSpec, load_robot, revalidated_robot
from argo_env.site import Site, make_site
from argo_env.site.family import Family, is_generated_name, parse_family
from argo_env.site.site import site_file
from argo_env.site.spec import MAX_BYTES, SiteSpec

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.planning.travel import SiteTravel

_log = logging.getLogger(__name__)

_MAX_SITES = 8  # sites that are kept in memory; each takes some 100 MB
_MAX_PATHS = 4096  # paths that are kept in memory for a site, as simulations drive them repeatedly


class OpenedSite:
    """A site with everything that planning and driving on it need; computed parts are kept.

    Calls that open the same site share one object, and copies are the same object. It is pickled as
    its reference, or as its description if it was made in memory; unpickling opens it again.
    """

    def __init__(
        self, reference: str | None, site: Site, robot: RobotSpec, parts: Parts = NO_CACHE
    ) -> None:
        """Wrap a site.

        Args:
            reference: Reference with which `open_site` opens it again; None: it was made in memory.
            site: Geometry of the site.
            robot: Robot that drives on the site.
            parts: Cache on disk for results that take long to compute.
        """
        self._reference = reference
        self.site = site
        self.robot = robot
        self.parts = parts

    @staticmethod
    def from_site(site: Site, robot: RobotSpec | None = None) -> "OpenedSite":
        """Return an opened site for a site that was made in memory.

        Equal sites share one object, unless their elements were replaced (`Site.altered`). `robot`
        None: the tracker.
        """
        robot = robot or load_robot()
        if site.altered is None:
            return _open_spec(site.spec, robot)
        return OpenedSite(None, site, robot)

    @staticmethod
    def from_navigator(navigator: "Navigator") -> "OpenedSite":
        """Return an opened site for the site of this navigator, which it uses."""
        opened = OpenedSite(None, navigator.site, navigator.robot, navigator.parts)
        opened.navigator = navigator
        return opened

    @property
    def reference(self) -> str:
        """Reference that opens the site again: its name, its file's full path, or its parameters.

        For a site that was made in memory it is only the name.
        """
        return self._reference or self.name

    @property
    def name(self) -> str:
        return self.site.name

    # A mission that was checked before is checked without these modules: imported when needed.

    @thread_safe_cached_property
    def navigator(self) -> "Navigator":
        """Path planner of the site; it keeps the paths that it planned last."""
        from argo_env.navigation import Navigator

        return Navigator(self.site, self.robot, self.parts, cached_paths=_MAX_PATHS)

    @thread_safe_cached_property
    def catalog(self) -> Catalog:
        """Catalogue of the site, for the compiler."""
        return load_catalog(self.site, self.parts) or make_catalog(self.navigator)

    @thread_safe_cached_property
    def travel(self) -> "SiteTravel":
        """Travel times and energy on the site, for the analysis and for routes."""
        from argo_env.planning.travel import SiteTravel

        return SiteTravel(self)

    @thread_safe_cached_property
    def digest(self) -> str:
        """Digest of the descriptions of the site and the robot."""
        text = self.site.spec.model_dump_json() + self.robot.model_dump_json()
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()

    def prepare(self) -> "OpenedSite":
        """Compute now what all paths share, so that no later call takes the time for it.

        Returns this object. Raises ArgoError if the robot can't drive on the site.
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
                Message(
                    "site {site} is not as its description says, and can't be sent to another "
                    "process; send the faults that have changed it, and apply them there",
                    site=self.name,
                )
            )
        return _open_spec, (self.site.spec, self.robot)


def open_site(reference: str = "umad", robot: RobotSpec | None = None) -> OpenedSite:
    """Open a site for planning and driving.

    Equal calls return the same object, also from several threads at once, and however the
    parameters of a generated site are written. A file that has changed is opened again. Results
    that take long to compute are cached on disk.

    The robot is not yet checked: if it can't drive on the site, the first path raises an error,
    or `prepare`.

    Args:
        reference: Name of a shipped site, path of a site file, or parameters of a generated site
            such as `generated:floors=3,seed=7`.
        robot: Robot that drives on the site; None: the tracker.

    Raises:
        NotFound: There is no such site.
        ArgoError: The file is not valid; the message names the place in it.
    """
    if not isinstance(reference, str):
        raise Invalid(
            Message(
                "{reference} is not text: a site is opened by its name or its file's path",
                reference=repr(reference),
            )
        )
    robot = revalidated_robot(robot) if robot else load_robot()
    if is_generated_name(reference):
        family = parse_family(reference)
        if parse_family(str(family)) == family:  # the text may have too few digits
            reference = str(family)
        return _open(reference, family.model_dump_json(), robot, partial(_generate, family, robot))
    path = site_file(reference)
    text = read_text(path, "site", MAX_BYTES)
    if path == Path(reference):
        reference = os.path.realpath(path)

    def make_from_file() -> Site:
        from argo_env.site.site_file import parse_site_spec

        return make_site(parse_site_spec(text, str(path)))

    return _open(reference, text, robot, make_from_file)


def forget_sites() -> None:
    """Empty the cache of opened sites in memory; those that are in use remain usable.

    The next `open_site` makes a new object. The cache on disk stays.
    """
    with _lock:
        _slots.clear()


@dataclass
class _Slot:
    """A place in memory for an opened site, which the first thread that asks for the site fills."""

    lock: Lock = field(default_factory=Lock)
    opened: OpenedSite | None = None


_lock = Lock()
_slots: OrderedDict[tuple[str | None, ...], _Slot] = OrderedDict()


def _open(
    reference: str | None, text: str, robot: RobotSpec, make: Callable[[], "Site | Navigator"]
) -> OpenedSite:
    """Return an opened site from memory or from the cache on disk, or make it.

    Args:
        reference: Reference of the site; None: it was made in memory.
        text: Text that determines the site.
        robot: Robot that drives on the site.
        make: Function that makes the site if it is new.
    """
    key = reference, text, robot.model_dump_json()
    with _lock:
        slot = _slots.setdefault(key, _Slot())
        _slots.move_to_end(key)
        while len(_slots) > _MAX_SITES:
            _slots.popitem(last=False)
    with slot.lock:
        if slot.opened is None:
            parts = cache.entry_for((code_digest(), text, robot.model_dump_json()))
            cached = parts.load_text("site")
            _log.info(
                "the site is %s",
                "made" if cached is None else "taken from the cache on disk",
            )
            if cached is None:
                with stage(f"making the site {reference or ''}".rstrip()):
                    slot.opened = _open_new(reference, robot, parts, make())
            else:
                site = make_site(SiteSpec.model_validate_json(cached))
                slot.opened = OpenedSite(reference, site, robot, parts)
        return slot.opened


def _open_new(
    reference: str | None, robot: RobotSpec, parts: Parts, made: "Site | Navigator"
) -> OpenedSite:
    """Store a new site in the cache on disk, with all that was computed to make it, and open it."""
    cache.evict()
    site = made if isinstance(made, Site) else made.site
    parts.store_text("site", site.spec.model_dump_json())
    opened = OpenedSite(reference, site, robot, parts)
    if not isinstance(made, Site):
        opened.navigator.adopt_surface_and_lattice(made)
    return opened


def _generate(family: Family, robot: RobotSpec) -> "Navigator":
    from argo_env.planning.generated import generate_navigator

    return generate_navigator(family, robot)


def _open_again(reference: str, robot: RobotSpec, digest: str) -> OpenedSite:
    opened = open_site(reference, robot)
    if opened.digest != digest:
        raise Conflict(
            Message(
                "site {reference} has changed since it was opened where this comes from; "
                "open it again there",
                reference=reference,
            )
        )
    return opened


def _open_spec(spec: SiteSpec, robot: RobotSpec) -> OpenedSite:
    return _open(None, spec.model_dump_json(), robot, partial(make_site, spec))
