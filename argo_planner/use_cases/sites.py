"""List, check and description of sites."""

from dataclasses import dataclass

from argo_compiler.base.errors import Conflict
from argo_compiler.base.message import Message
from argo_env.planning.flaws import Flaw, SafeStates, find_flaws
from argo_env.planning.opening import OpenedSite
from argo_env.site import load_site, site_names
from argo_env.site.family import PREFIX, is_generated_name
from argo_env.site.norms import violations
from argo_env.site.site_file import to_yaml


@dataclass(frozen=True)
class SiteSummary:
    """Summary of a site, known before it is opened."""

    name: str
    title: str
    floors: int
    checkpoints: int


@dataclass(frozen=True)
class SiteReport:
    """Result of the check of a site."""

    notes: tuple[str, ...]
    """features that are unlike real sites, but do no harm"""
    flaws: tuple[Flaw, ...]
    """parts that the robot can't reach or read, with remedies; empty: the site is in order"""
    safe_states: SafeStates | None = None
    """poses at which the robot can stand; None: there are no flaws"""

    @property
    def errors(self) -> tuple[str, ...]:
        """Messages of the flaws."""
        return tuple(flaw.message for flaw in self.flaws)


def list_shipped_sites() -> tuple[SiteSummary, ...]:
    """Return summaries of the sites that Argo ships."""
    return tuple(
        SiteSummary(
            name, spec.title, len(spec.floors), sum(len(floor.checkpoints) for floor in spec.floors)
        )
        for name in site_names()
        for spec in (load_site(name).spec,)
    )


def make_site_report(site: OpenedSite) -> SiteReport:
    """Return the flaws of a site, and notes on features that are unlike real sites."""
    found = find_flaws(site.navigator)
    return SiteReport(tuple(violations(site.site.spec)), found.flaws, found.states)


def draw_site_report_png(site: OpenedSite, report: SiteReport) -> bytes:
    """Return a PNG picture of the site's floors in which the flaws of the report are marked."""
    # The import is slow, and few commands need the picture.
    from argo_env.pictures.site_plan import draw_site_plan

    return draw_site_plan(site.site, report.flaws, report.safe_states)


def site_yaml_with_name(site: OpenedSite, name: str) -> str:
    """Return the site's description as YAML, with `name` in place of the site's own name.

    The copy is meant to be changed, and the old name stands for the site itself.

    Raises:
        Conflict: It is the name of a shipped site, or begins as those of generated sites do.
    """
    require_free_name(name)
    return to_yaml(site.site.spec.model_copy(update={"name": name}))


def require_free_name(name: str) -> None:
    """Raise Conflict if it is the name of a shipped site or one for generated sites."""
    if is_generated_name(name):
        raise Conflict(
            Message(
                "{prefix}… names a generated site, not a file; choose another name", prefix=PREFIX
            )
        )
    if name in site_names():
        raise Conflict(
            Message(
                "the site would be called {name}, like the one that Argo ships; choose "
                "another name",
                name=name,
            )
        )
