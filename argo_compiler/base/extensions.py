"""Extension points: objects of one kind by name, those of Argo and those of installed packages.

A package offers an object by an entry point in its metadata, in a group such as `argo.sensors`.
Its name is known without an import; the object is imported when it is used for the first time.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Generic, TypeVar

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable
from argo_compiler.base.extras import PROJECT
from argo_compiler.base.message import Listing, Message, identifier
from argo_compiler.base.model import Model
from argo_compiler.base.nearest_name import nearest_name

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

T = TypeVar("T")

_PREFIX = "argo."
"""beginning of the names of all groups"""
_ARGO = ("argo_compiler", "argo_env", "argo_planner", "baselines")
"""top-level modules of Argo"""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}")


class InstalledExtension(Model):
    """An object that an installed package offers."""

    kind: str
    """such as `sensor`"""
    name: str
    package: str
    """name and version of the package"""
    problem: str | None = None
    """reason why it can't be used; None: it can"""


@dataclass(frozen=True, slots=True)
class _Offer:
    entry: "EntryPoint"
    package: str

    @property
    def is_of_argo(self) -> bool:
        return self.package.split(" ")[0] == PROJECT


class ExtensionPoint(Generic[T]):
    """Objects of one kind by name: those of Argo, then those of installed packages.

    Names of Argo are never replaced. If two packages offer the same name, the package whose name
    comes first in the alphabet has it.
    """

    def __init__(
        self,
        group: str,
        noun: str,
        own: Mapping[str, T],
        find_problem: Callable[[str, object], str | None],
        reserved: Collection[str] = (),
    ) -> None:
        """Take the objects of Argo.

        Args:
            group: group of the entry points.
            noun: word for one of the objects in messages, such as `sensor`.
            own: the objects of Argo that need no entry point, by name.
            find_problem: function that returns the reason why an imported object can't be used
                under a name, such as `is no function`; None if it can.
            reserved: names that are not in `own`, but can't be taken either.
        """
        self.group = group
        self.noun = noun
        self._own = own
        self._reserved = frozenset(reserved)
        self._find_problem = find_problem
        self._registered: dict[str, T] = {}
        self._loaded: dict[str, T | str] = {}  # the object, or the reason why there is none

    def registered(self) -> tuple[T, ...]:
        """Return what `register` has added, in that order."""
        return tuple(self._registered.values())

    def names(self) -> tuple[str, ...]:
        """Return all names: those of Argo, registered ones, those of packages."""
        return (*self._own, *self._registered, *self._usable_offers())

    def __iter__(self) -> Iterator[str]:
        return iter(self.names())

    def __contains__(self, name: object) -> bool:
        return name in self._own or name in self._registered or name in self._usable_offers()

    def __getitem__(self, name: str) -> T:
        """Return the object with this name.

        Raises:
            NotFound: There is none.
            Unavailable: A package offers it, but it can't be used.
        """
        if (registered := self._registered.get(name)) is not None:
            return registered
        if name in self._own:
            return self._own[name]
        offer = self._usable_offers().get(name)
        if offer is None:
            raise NotFound(
                Message(
                    "no {noun} `{name}`; {hint}",
                    noun=identifier(self.noun),
                    name=name,
                    hint=self._hint(name),
                )
            )
        loaded = self._load(name, offer)
        if isinstance(loaded, str):
            raise Unavailable(
                Message(
                    "the {noun} `{name}` of {package} {loaded}",
                    noun=identifier(self.noun),
                    name=name,
                    package=offer.package,
                    loaded=loaded,
                )
            )
        return loaded

    def require(self, name: str) -> None:
        """Raise NotFound or Unavailable if the object with this name can't be used."""
        self[name]

    def package_of(self, name: str) -> str | None:
        """Return the name and version of the package that offers an object; None: no package."""
        offer = self._usable_offers().get(name)
        return None if offer is None or offer.is_of_argo else offer.package

    def register(self, name: str, item: T) -> None:
        """Add an object in this process; raise Conflict if the name is taken."""
        if name in self or name in self._reserved:
            raise Conflict(
                Message(
                    "there is a {noun} `{name}` already; choose another name",
                    noun=identifier(self.noun),
                    name=name,
                )
            )
        self._registered[name] = item

    def discard(self, name: str) -> None:
        """Remove an object that was added by `register`; no-op if there is none of that name."""
        self._registered.pop(name, None)

    def extensions(self) -> tuple[InstalledExtension, ...]:
        """Import all that packages offer, and return it with the problems.

        Among them are offers that are not used, as their name is taken or can't be a name. Those of
        Argo itself are returned only if they have a problem.
        """
        used = self._usable_offers()
        found = []
        for offer in _offers(self.group):
            name, problem = offer.entry.name, None
            if used.get(name) is not offer:
                problem = self._reason_for_refusal(name, used)
            elif isinstance(loaded := self._load(name, offer), str):
                problem = loaded
            if problem or not offer.is_of_argo:
                found.append(
                    InstalledExtension(
                        kind=self.noun, name=name, package=offer.package, problem=problem
                    )
                )
        return tuple(found)

    def _usable_offers(self) -> dict[str, _Offer]:
        """Return the offer of each name that is not one of Argo's."""
        usable: dict[str, _Offer] = {}
        for offer in _offers(self.group):
            name = offer.entry.name
            if _NAME.fullmatch(name) and name not in self._own and name not in self._reserved:
                usable.setdefault(name, offer)
        return usable

    def _reason_for_refusal(self, name: str, used: Mapping[str, _Offer]) -> str:
        if name in used:
            return Message(
                "is not used: {package} has a {noun} of that name",
                package=used[name].package,
                noun=identifier(self.noun),
            )
        if name in self._own or name in self._reserved:
            return Message(
                "is not used: Argo has a {noun} of that name", noun=identifier(self.noun)
            )
        return Message(
            "is not used: a name has at most 40 letters of a to z, digits, and any of `_.-`"
        )

    def _load(self, name: str, offer: _Offer) -> T | str:
        if name not in self._loaded:
            self._loaded[name] = self._import(name, offer)
        return self._loaded[name]

    def _import(self, name: str, offer: _Offer) -> T | str:
        try:
            item: T = offer.entry.load()
        except (Exception, SystemExit) as error:  # a package may do anything when it is imported
            reason = str(error).strip().split("\n")[0]
            kind = type(error).__name__
            return Message(
                "can't be imported: {part}",
                part=Message("{kind}: {reason}", kind=kind, reason=reason) if reason else kind,
            )
        problem = self._find_problem(name, item)
        return item if problem is None else problem

    def _hint(self, name: str) -> str:
        near = nearest_name(name, self.names())
        return (
            Message("did you mean `{near}`?", near=near)
            if near
            else Message("choose one of: {names}", names=Listing(self.names()))
        )


def function_problem(name: str, item: object) -> str | None:  # noqa: ARG001
    """Return the reason why an object can't be called, for points whose objects are functions."""
    return None if callable(item) else Message("is no function")


def package_failure(error: Exception) -> Unavailable | None:
    """Return the error that names the package in whose code another error was raised.

    Returns None if no code of a package that extends Argo was running.
    """
    modules = {module: package for package, module in _top_modules_of_packages()}
    trace, found = error.__traceback__, None
    while trace is not None:
        module = str(trace.tb_frame.f_globals.get("__name__")).partition(".")[0]
        if module not in _ARGO:
            found = modules.get(module, found)
        trace = trace.tb_next
    if found is None:
        return None
    return Unavailable(
        Message(
            "the package {found} has failed: {name}: {error}",
            found=found,
            name=type(error).__name__,
            error=error,
        )
    )


@contextmanager
def naming_packages() -> Iterator[None]:
    """Raise Unavailable, with the package's name, for an error in the code of another package."""
    try:
        yield
    except ArgoError:
        raise
    except Exception as error:
        if (failure := package_failure(error)) is None:
            raise
        raise failure from error


def _top_modules_of_packages() -> Iterator[tuple[str, str]]:
    """Yield the packages that extend Argo, each with its top-level modules that it offers from."""
    from importlib.metadata import entry_points

    for group in entry_points().groups:
        if group.startswith(_PREFIX):
            for offer in _offers(group):
                if not offer.is_of_argo:
                    yield offer.package, re.split(r"[.:\s]", offer.entry.value)[0]


def installed_names(group: str) -> tuple[str, ...]:
    """Return the names that packages other than Argo offer in a group, without any import.

    Whether they can be used is not known.
    """
    return tuple(dict.fromkeys(o.entry.name for o in _offers(group) if not o.is_of_argo))


def installed_packages() -> tuple[str, ...]:
    """Return the names and versions of all packages that extend Argo."""
    return tuple(sorted({package for package, _ in _top_modules_of_packages()}))


@cache
def _offers(group: str) -> tuple[_Offer, ...]:
    """Return what installed packages offer in a group, Argo's first, then by package and name."""
    from importlib.metadata import entry_points  # takes 15 ms, and few commands need it

    offers = [_Offer(entry, _package_of(entry)) for entry in entry_points(group=group)]
    return tuple(
        sorted(offers, key=lambda offer: (not offer.is_of_argo, offer.package, offer.entry.name))
    )


def _package_of(entry: "EntryPoint") -> str:
    """Return the name and version of the package that an entry point belongs to."""
    try:
        return (
            Message("an unknown package")
            if entry.dist is None
            else f"{entry.dist.name} {entry.dist.version}"
        )
    except Exception:  # what remains of a package that was removed in part
        return Message("a damaged package")
