"""`argo sites`: which sites there are, and whether one can be driven."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from argo_compiler.errors import ArgoError
from argo_env.navigation import Navigator
from argo_env.planning.checking import unseen_checkpoints, unserved_floors
from argo_env.site import load_site, site_names
from argo_env.site.family import PREFIX, is_family
from argo_env.site.norms import breaches, false_ends
from argo_env.site.site_file import to_yaml
from argo_planner.loading import keep_input, load_navigator, write_text


def show_sites(
    site: Annotated[
        str | None,
        typer.Argument(metavar="SITE", help="a site to check: its name, its .yaml, or generated:…"),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="a .yaml to write the site's description to"),
    ] = None,
) -> None:
    """List the sites, or check one; exits with status 2 if it can't be driven."""
    if site is None:
        if output:
            raise ArgoError("--output writes the description of one site: say which")
        for name in site_names():
            spec = load_site(name).spec
            count = sum(len(floor.checkpoints) for floor in spec.floors)
            print(f"{name}: {spec.title}, floors: {len(spec.floors)}, checkpoints: {count}")
        return
    if output:
        keep_input(Path(site), output)
        _check_name(output)
    navigator = load_navigator(site)
    if output:
        # The name that it has stands for another site, and this one is there to be changed.
        spec = navigator.site.spec.model_copy(update={"name": output.stem})
        write_text(output, to_yaml(spec))
        use = f"argo check MISSION --site {shlex.quote(str(output))}"
        print(f"{output}: written, site `{spec.name}`; use it with `{use}`")
    navigator.prepare()  # says what is wrong with its docking stations
    for breach in breaches(navigator.site.spec):
        print(f"{site}: note: {breach}")
    faults = _faults(navigator)
    for fault in faults:
        print(f"{site}: error: {fault}")
    if faults:
        raise typer.Exit(2)
    print(f"{site}: every floor and every checkpoint can be reached from every dock, and back")


def _check_name(output: Path) -> None:
    """Raises ArgoError if no site is found in a file of that name, or another one is by the name
    that it gets."""
    if output.suffix not in {".yaml", ".yml"}:
        raise ArgoError(
            f"{output}: a site is found in a file that ends in .yaml or .yml; name it so"
        )
    if is_family(str(output)) or is_family(output.stem):
        raise ArgoError(f"{output}: {PREFIX}… is no file to Argo but a site; choose another name")
    if output.stem in site_names():
        raise ArgoError(
            f"{output}: the site would be called {output.stem}, as the one that Argo ships; choose "
            "another name"
        )


def _faults(navigator: Navigator) -> list[str]:
    if ends := false_ends(navigator.site.spec):
        return ends  # what can't be reached for that is found again once they are mended
    floors = [
        f"floor {number} can't be reached and patrolled; give its corners 1.4 m by 1.4 m to turn in"
        for number in unserved_floors(navigator)
    ]
    return floors + [
        f"checkpoint {id} ({navigator.site.checkpoint(id).name}) can't be read from anywhere that"
        " the robot can reach; move or turn it"
        for id in unseen_checkpoints(navigator)
    ]
