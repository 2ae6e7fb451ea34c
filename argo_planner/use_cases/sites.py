"""Which sites there are, whether one can be driven, and their descriptions."""

from dataclasses import dataclass

from argo_compiler.base.errors import Conflict
from argo_env.planning.flaws import Flaw, Standing, look_over
from argo_env.planning.opening import OpenedSite
from argo_env.site import load_site, site_names
from argo_env.site.family import PREFIX, is_family
from argo_env.site.norms import violations
from argo_env.site.site_file import to_yaml


@dataclass(frozen=True)
class SiteSummary:
    """What there is to know of a site before it is opened."""

    name: str
    title: str
    floors: int
    checkpoints: int


@dataclass(frozen=True)
class SiteReport:
    """Whether a site can be driven."""

    notes: tuple[str, ...]
    """what is unlike real sites, but does no harm"""
    flaws: tuple[Flaw, ...]
    """what can't be reached, and what to do about it"""
    standing: Standing | None = None
    """where the robot can stand, if there are flaws"""

    @property
    def errors(self) -> tuple[str, ...]:
        """The flaws in words."""
        return tuple(flaw.message for flaw in self.flaws)


def list_sites() -> tuple[SiteSummary, ...]:
    """The sites that Argo ships."""
    return tuple(
        SiteSummary(
            name, spec.title, len(spec.floors), sum(len(floor.checkpoints) for floor in spec.floors)
        )
        for name in site_names()
        for spec in (load_site(name).spec,)
    )


def check_site(site: OpenedSite) -> SiteReport:
    """Looks for what the robot can't reach."""
    found = look_over(site.navigator)
    return SiteReport(tuple(violations(site.site.spec)), found.flaws, found.standing)


def draw_report(site: OpenedSite, report: SiteReport) -> bytes:
    """The site as a PNG, with the places of what is wrong with it."""
    from argo_env.pictures.site_plan import draw_site  # few ask for it, and it takes long to import

    return draw_site(site.site, report.flaws, report.standing)


def describe_site(site: OpenedSite, name: str) -> str:
    """The YAML that describes the site, under another name: its own stands for another site, and
    this one is there to be changed. Raises Conflict as `require_free_name`."""
    require_free_name(name)
    return to_yaml(site.site.spec.model_copy(update={"name": name}))


def require_free_name(name: str) -> None:
    """Raises Conflict if a site of that name would be taken for another one."""
    if is_family(name):
        raise Conflict(f"{PREFIX}… is no file to Argo but a site; choose another name")
    if name in site_names():
        raise Conflict(
            f"the site would be called {name}, as the one that Argo ships; choose another name"
        )
