"""`argo plan`: open the planner page, with a service of its own."""

import webbrowser
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_compiler.il import Mission
from argo_env.planning.opening import open_site
from argo_planner.terminal.files import read_upload
from argo_planner.terminal.importing import import_and_warn
from argo_planner.terminal.options import EndArea, SiteOption, StartArea
from argo_planner.terminal.verbosity import is_quiet

if TYPE_CHECKING:
    from argo_planner.service.storage.folder import PlanFolder

_PORT = 8310
"""port that is tried first, since a browser stores the data of a page by its address"""


def plan_command(
    source: Annotated[
        Path | None,
        typer.Argument(metavar="[MISSION|SCRIPT]", help="mission to add to the folder and to open"),
    ] = None,
    folder: Annotated[Path, typer.Option("--folder", help="folder of the missions")] = Path(
        "missions"
    ),
    site: SiteOption = "umad",
    port: Annotated[
        int | None,
        typer.Option(
            "--port",
            min=0,
            max=65535,
            help=f"port of the page; if not given: {_PORT}, or a free one",
        ),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="open the page in a browser")
    ] = True,
    start_area: StartArea = None,
    end_area: EndArea = None,
) -> None:
    """Plan a mission in the browser, on a 3D model of the site, and watch it run."""
    try:
        from argo_planner.service.runs.host import AfterRestart
        from argo_planner.service.web.access import AccessToken, TokenBook, load_or_make_secret
        from argo_planner.service.web.guard import LOOPBACK, GuardSettings
        from argo_planner.service.web.serving import ServiceSpec, listen, open_plan_folder, serve
        from argo_planner.service.world.obstacle_store import ObstacleStore
    except ImportError as error:
        raise Unavailable(f"the page needs {error.name}: {install_line('planner')}") from None
    opened = open_site(site).prepare()
    imported = None
    if source is not None:
        imported = import_and_warn(read_upload(source), opened, start_area, end_area).mission
    token = AccessToken(load_or_make_secret(folder))
    try:
        listening = listen("127.0.0.1", _PORT if port is None else port)
    except Unavailable:
        if port is not None:
            raise
        listening = listen("127.0.0.1", 0)
    port = listening.getsockname()[1]
    plans, obstacles = open_plan_folder(folder), ObstacleStore(folder)
    fragment = ""
    if source is not None and imported is not None:
        fragment = f"#/missions/{_add_mission(plans, source.stem, imported)}"
    address = f"http://127.0.0.1:{port}/?token={token.secret}{fragment}"
    console = Console(stderr=True, highlight=False, quiet=is_quiet(), soft_wrap=True)
    shown = browser and webbrowser.open(address)
    console.print(f"Site {opened.name}, missions in {folder}.")
    console.print(f"The page is {'open: ' if shown else 'at '}{address}")
    console.print("Press Ctrl-C to stop; all changes are saved.")
    settings = GuardSettings(frozenset(LOOPBACK), cookie=f"argo-{port}")
    spec = ServiceSpec(plans, obstacles, opened, TokenBook((token,)), settings, AfterRestart.WAIT)
    with suppress(KeyboardInterrupt):
        serve(spec, listening)


def _add_mission(plans: "PlanFolder", name: str, mission: Mission) -> str:
    """Return the id of a plan with an equal mission, whatever its name; add one if there is none.

    A plan that is added has the name `name`, or this name with a number.
    """
    known = plans.list_plans()
    for summary in known:
        if summary.problem is None and summary.tasks == len(mission.tasks):
            with plans.open(summary.id) as file:
                if file.document.plan.mission == mission:
                    return summary.id
    taken = {summary.name for summary in known}
    number = 1
    while (free := name if number == 1 else f"{name} ({number})") in taken:
        number += 1
    with plans.create(free, mission, datetime.now(UTC)) as file:
        return file.document.id
