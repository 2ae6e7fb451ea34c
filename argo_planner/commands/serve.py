"""`argo serve`: the planning service."""

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


def serve_plans(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="where the missions are kept")
    ] = Path("missions"),
    site: SiteOption = "umad",
    host: Annotated[
        str,
        typer.Option(
            "--host",
            help="address to listen at; others than this machine's own "
            "need a token that you choose",
        ),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option("--port", min=0, max=65535, help="0: a free one")] = 8310,
    token: Annotated[
        str | None,
        typer.Option("--token", envvar="ARGO_TOKEN", help="who has it may do everything"),
    ] = None,
    token_file: Annotated[
        Path | None,
        typer.Option(
            "--token-file",
            metavar="FILE",
            help="a token a line, with its role (view, plan, operate) and who has it",
        ),
    ] = None,
    after_restart: Annotated[
        str,
        typer.Option(
            "--after-restart",
            metavar="go-on|wait",
            help="what becomes of a run that was under way when the service was killed",
        ),
    ] = "wait",
    foxglove: Annotated[
        int | None,
        typer.Option(
            "--foxglove",
            metavar="PORT",
            min=1,
            max=65535,
            help="show runs live in Foxglove, on this machine; it looks at 8765 by itself",
        ),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option("--allow-host", metavar="NAME", help="a name under which it is asked for"),
    ] = None,
    origin: Annotated[
        list[str] | None,
        typer.Option(
            "--origin", metavar="URL", help="address of a proxy in front: https://argo.example.org"
        ),
    ] = None,
) -> None:
    """Serve the planner page with a folder of missions to several people at once."""
    try:
        from argo_planner.service.runs.host import AfterRestart
        from argo_planner.service.web.access import (
            AccessToken,
            TokenBook,
            checked_secret,
            kept_secret,
            read_tokens,
        )
        from argo_planner.service.web.guard import LOOPBACK, Doors
        from argo_planner.service.web.serving import ServiceOrder, listen, open_folder, serve
    except ImportError as error:
        raise Unavailable(f"the service needs {error.name}: {install_line('planner')}") from None
    if after_restart not in list(AfterRestart):
        raise Invalid(f"--after-restart {after_restart}: choose from {', '.join(AfterRestart)}")
    if foxglove is not None:
        require_foxglove()
    own = _is_own(host)
    if token is None and token_file is None and not own:
        raise Invalid(f"--host {host}: others can reach this address: give --token or --token-file")
    if token is not None and token_file is not None:
        raise Invalid("give --token or --token-file, not both")
    if token_file is not None:
        tokens = read_tokens(token_file)
    else:
        secret = checked_secret(token, "--token") if token else kept_secret(folder)
        tokens = (AccessToken(secret),)
    names = {*LOOPBACK, *(allow_host or ()), *([] if _is_any(host) else [_in_address(host)])}
    listening = listen(host, port)
    port = listening.getsockname()[1]
    doors = Doors(frozenset(n.lower() for n in names), frozenset(origin or ()), f"argo-{port}")
    plans = open_folder(folder)
    opened = open_site(site).prepare()
    console = Console(stderr=True, highlight=False, quiet=is_quiet(), soft_wrap=True)
    shown = "127.0.0.1" if _is_any(host) else _in_address(host)
    address = f"http://{shown}:{port}/"
    if token_file is None and token is None:
        address += f"?token={tokens[0].secret}"
    console.print(f"Site {opened.name}, missions in {folder}. Open {address}")
    console.print("Ctrl-C ends the service; what was acknowledged is kept.")
    with suppress(KeyboardInterrupt):
        order = ServiceOrder(
            plans, opened, TokenBook(tokens), doors, AfterRestart(after_restart), foxglove
        )
        serve(order, listening)


def _is_own(host: str) -> bool:
    """Whether only this machine reaches the address."""
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
