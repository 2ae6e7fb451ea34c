"""One call from a mission to its record: the site, robot, world, drive and sensor put together."""

import time
from collections.abc import Callable, Mapping

import numpy as np

from argo_compiler.diagnostics import Diagnostic
from argo_compiler.errors import ArgoError
from argo_compiler.il import Mission, Task
from argo_env.navigation import Navigator
from argo_env.record import RunRecord
from argo_env.robot.kinematic import KinematicDrive
from argo_env.runner import MissionRunner, Observer
from argo_env.sensing.ideal import IdealSensor, draw_values
from argo_env.site import Site
from argo_env.world import World

DRIVES = {"kinematic": KinematicDrive}
"""The drives by name."""


def simulate(
    mission: Mission,
    navigator: Navigator,
    *,
    seed: int = 0,
    drive: str = "kinematic",
    values: Mapping[int, float] | None = None,
    diagnostics: tuple[Diagnostic, ...] = (),
    observe: Observer | None = None,
    gui: bool = False,
    pace: float | None = None,
) -> RunRecord:
    """Runs the mission on the navigator's site and returns its record.

    The seed draws the checkpoints' true values; `values` replaces some of them. With `pace` a
    second of wall time shows at most that many seconds of simulated time. Equal arguments give
    equal records.

    Raises:
        ArgoError: the mission makes no sense on this site, or there is no such drive.
    """
    if drive not in DRIVES:
        raise ArgoError(f"no drive `{drive}`; there are: {', '.join(DRIVES)}")
    truth = true_values(navigator.site, seed, values or {})
    with World(navigator.site, navigator.robot, gui) as world:
        for id, value in truth.items():
            world.show_value(id, value)
        runner = MissionRunner(
            mission,
            world,
            navigator,
            DRIVES[drive](world, navigator.robot),
            IdealSensor(world, navigator.robot, truth),
            seed,
            diagnostics,
        )
        return runner.run(_paced(observe, pace) if pace else observe)


def true_values(site: Site, seed: int, given: Mapping[int, float]) -> dict[int, float]:
    """What each checkpoint shows, in its unit: drawn by the seed, or as given.

    Raises ArgoError for a checkpoint that the site does not have or a value beyond its scale.
    """
    truth = draw_values(site, np.random.default_rng(seed))
    for id, value in given.items():
        if id not in truth:
            raise ArgoError(f"site {site.name} has no checkpoint {id} to give a value to")
        checkpoint = site.checkpoint(id)
        if not checkpoint.range.contains(value):
            raise ArgoError(
                f"checkpoint {id} ({checkpoint.name}) shows {checkpoint.range.low:g} to "
                f"{checkpoint.range.high:g} {checkpoint.unit}, not {value:g}"
            )
        truth[id] = value
    return truth


def _paced(
    observe: Observer | None, pace: float, sleep: Callable[[float], None] = time.sleep
) -> Observer:
    """The observer, called no faster than `pace` simulated seconds a second."""
    started = time.monotonic()

    def wait(now: float, task: Task | None) -> None:
        sleep(max(0.0, started + now / pace - time.monotonic()))
        if observe:
            observe(now, task)

    return wait
