"""All formats that `argo export` writes: the compiler's, and isar's, which needs the site."""

from argo_compiler.export import EXPORTERS, Exporter
from argo_compiler.isar import to_isar
from argo_env.navigation import Navigator
from argo_env.planning.reading_places import inspection_views


def exporters(navigator: Navigator) -> dict[str, Exporter]:
    """By the name that `argo export --to` takes."""
    isar = Exporter(
        "isar mission definition",
        (".json",),
        lambda mission, hfsm: to_isar(mission, hfsm, inspection_views(mission, navigator)),
    )
    return EXPORTERS | {"isar": isar}
