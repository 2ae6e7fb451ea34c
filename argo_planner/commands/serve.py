"""`argo serve`: run the planning service."""

import ipaddress
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from argo_compiler.base.errors import Invalid, Unavailable
from argo_compiler.base.extras import install_line
from argo_env.planning.opening import open_site
from argo_env.recording.live import require_foxglove
from argo_planner.terminal.options import SiteOption
from argo_planner.terminal.verbosity import is_quiet


def serve_command(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="folder of the missions")] = Path(
        "missions"
    ),
    site: SiteOption = "umad",
    host: Annotated[
        str,
        typer.Option(
            "--host",
            help="address to listen on; one that other machines can reach needs --token or "
            "--token-file",
        ),
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="port to listen on; 0: a free one")
    ] = 8310,
    token: Annotated[
        str | None,
        typer.Option(
            "--token", envvar="ARGO_TOKEN", help="secret with which people may do everything"
        ),
    ] = None,
    token_file: Annotated[
        Path | None,
        typer.Option(
            "--token-file",
            metavar="FILE",
            help="file with a token per line: its secret, role (view, plan, operate) and owner",
        ),
    ] = None,
    after_restart: Annotated[
        str,
        typer.Option(
            "--after-restart",
            metavar="go-on|wait",
            help="what to do with a run that was in progress when the service was killed",
        ),
    ] = "wait",
    foxglove: Annotated[
        int | None,
        typer.Option(
            "--foxglove",
            metavar="PORT",
            min=1,
            max=65535,
            help="port on this machine for runs live in Foxglove, which tries 8765 by default",
        ),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option("--allow-host", metavar="NAME", help="further host name of this service"),
    ] = None,
    origin: Annotated[
        list[str] | None,
        typer.Option(
            "--origin",
            metavar="URL",
            help="address of a proxy in front, such as https://argo.example.org",
        ),
    ] = None,
) -> None:
    """Serve the planner page with a folder of missions to several people at once."""
    try:
        from argo_planner.service.runs.host import AfterRestart
        from argo_planner.service.web.access import (
            AccessToken,
            TokenBook,
            load_or_make_secret,
            read_tokens,
            validate_secret,
        )
        from argo_planner.service.web.guard import LOOPBACK, GuardSettings
        from argo_planner.service.web.serving import ServiceSpec, listen, open_plan_folder, serve
        from argo_planner.service.world.obstacle_store import ObstacleStore
    except ImportError as error:
        raise Unavailable(f"the service needs {error.name}: {install_line('planner')}") from None
    if after_restart not in list(AfterRestart):
        raise Invalid(f"--after-restart {after_restart}: choose from {', '.join(AfterRestart)}")
    if foxglove is not None:
        require_foxglove()
    is_local = _is_loopback(host)
    if token is None and token_file is None and not is_local:
        raise Invalid(f"--host {host}: others can reach this address: give --token or --token-file")
    if token is not None and token_file is not None:
        raise Invalid("give --token or --token-file, not both")
    if token_file is not None:
        tokens = read_tokens(token_file)
    else:
        secret = validate_secret(token, "--token") if token else load_or_make_secret(folder)
        tokens = (AccessToken(secret),)
    names = {*LOOPBACK, *(allow_host or ()), *([] if _is_any(host) else [_in_address(host)])}
    listening = listen(host, port)
    port = listening.getsockname()[1]
    settings = GuardSettings(
        frozenset(n.lower() for n in names), frozenset(origin or ()), f"argo-{port}"
    )
    plans, obstacles = open_plan_folder(folder), ObstacleStore(folder)
    opened = open_site(site).prepare()
    console = Console(stderr=True, highlight=False, quiet=is_quiet(), soft_wrap=True)
    shown = "127.0.0.1" if _is_any(host) else _in_address(host)
    address = f"http://{shown}:{port}/"
    if token_file is None and token is None:
        address += f"?token={tokens[0].secret}"
    console.print(f"Site {opened.name}, missions in {folder}. Open {address}")
    console.print("Press Ctrl-C to stop the service; all confirmed changes are saved.")
    with suppress(KeyboardInterrupt):
        spec = ServiceSpec(
            plans,
            obstacles,
            opened,
            TokenBook(tokens),
            settings,
            AfterRestart(after_restart),
            foxglove,
        )
        serve(spec, listening)


def _is_loopback(host: str) -> bool:
    """Return True if only this machine reaches the address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _is_any(host: str) -> bool:
    return host in ("0.0.0.0", "::", "")


def _in_address(host: str) -> str:
    return f"[{host}]" if ":" in host else host
