"""`argo/Inspect-v0`: choose the next checkpoint; the simulator drives there and reads it."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, cast

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pydantic import Field, StrictInt

from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.drives.timed_drive import RouteDrive
from argo_env.envs.batch import SpreadVectorEnv
from argo_env.envs.episode import (
    Copying,
    Parts,
    Rendering,
    check_begun,
    check_render_mode,
    check_state,
    check_under_way,
    read_choice,
)
from argo_env.envs.inspection_drawing import draw_inspection
from argo_env.envs.inspection_run import Deed, Inspection, beginning, travel_times
from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.options import (
    LONGEST,
    check_floors,
    check_positive,
    check_scenario,
    check_whole,
    read_options,
)
from argo_env.faults.kinds import KINDS, AnyFault, resolve_faults
from argo_env.faults.robot import EmergencyStop
from argo_env.planning import open_site
from argo_env.run.drives_and_sensors import DRIVES, ROUTE
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec
from argo_env.run.validation import check_run
from argo_env.seeding import draw
from argo_env.site import Site

MOST_FAULTS = 8
_Count = Annotated[int, Field(ge=0, le=MOST_FAULTS, strict=True)]


class InspectOptions(Model):
    """What `reset(options=...)` of Inspect-v0 may say."""

    scenario: str | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: _Count | tuple[AnyFault, ...] | None = None
    seed: int | None = Field(default=None, ge=0, strict=True)

    @property
    def floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


def draw_faults(
    count: int, drive: str, site: Site, rng: np.random.Generator
) -> tuple[AnyFault, ...]:
    """Up to `count` faults of different kinds, of those that the drive can find and the site
    can have."""
    paper = drive == RouteDrive.name
    kinds = [
        kind
        for kind, model in KINDS.items()
        if not (model.needs_world and paper) and _fits(kind, site)
    ]
    drawn = [kinds[k] for k in rng.permutation(len(kinds))[:count]]
    return tuple(_fault(kind, rng) for kind in drawn)


def _fits(kind: str, site: Site) -> bool:
    """Whether the site has what such a fault needs, such as a pump or stairs."""
    try:
        resolve_faults([cast("AnyFault", KINDS[kind].model_validate({}))], site, 0)
    except ArgoError:
        return False
    return True


def _fault(kind: str, rng: np.random.Generator) -> AnyFault:
    """A fault of that kind, what matters drawn by the run's seed; someone releases an emergency
    stop after a minute."""
    if kind == "emergency_stop":
        at = draw(rng, 0.0, 600.0, 1)
        return EmergencyStop(at=at, until=at + 60.0)
    return cast("AnyFault", KINDS[kind].model_validate({}))


READING, ABNORMAL, FINDING, CONTACT, DOCKED, DEAD = 10.0, 10.0, 5.0, -1.0, 20.0, -20.0
"""points: see the description of the environment"""
_TRIES = 2  # readings of a checkpoint that may fail before it is given up
_PATIENCE = 10.0  # s that an illegal action costs, and a stay in a dock takes at least
_MOST_PLACES = 1000  # of a kind that there may be room for
_FPS = 2
_EVENTS = tuple(EventKind)
_STATE: Parts = {"begun": dict, "options": dict, "actions": (tuple, list), "generator": dict}


class InspectEnv(Copying, Rendering, gym.Env[Observation, np.int64]):
    """## Description
    A robot reads the checkpoints of a site and has to be docked in time. The agent chooses where to
    go next; the robot plans its path, drives and measures as it does in a mission, and on the way
    notices what its watches notice. Things go wrong: see Randomisation.

    ## Observation Space
    A `Dict`. With n slots for checkpoints (in the order of their numbers) and d for docks there are
    n + d places. All are `float32` from 0 to 1 but for the last two.

    | key | shape | meaning |
    |---|---|---|
    | `travel` | (n + d,) | estimated way to each place from here, as a share of the time limit; 1 also where there is no way |
    | `points` | (n + d,) | points to be had there for sure, of 20 |
    | `failed` | (n + d,) | how often it failed, of 2 |
    | `left` | (1,) | time that is left, as a share of the limit |
    | `battery` | (1,) | charge that the voltage speaks for |
    | `floor` | (1,) | floor where the robot is, of all |
    | `noticed` | (k,) | `int8`, 1 for each `EventKind` that was noticed so far |
    | `mask` | (n + d,) | `int8`, 1 where the action is legal |

    ## Action Space
    `Discrete(n + d)`: read checkpoint k; or go to dock k - n. The end dock ends the episode; in any
    other one the robot stays until its battery is full. Docks are always legal. A checkpoint is
    legal until it was read, or failed twice, as long as a way there is known; none is after the
    platform alarm. `action_masks()` gives the mask as booleans, as MaskablePPO of sb3-contrib asks
    for. An illegal action makes the robot wait for 10 s, and `info["illegal"]` is true.

    ## Rewards
    Points of Argo's own (those of the competition are not public), as terms in `info["terms"]`:

    | term | points |
    |---|---|
    | `reading` | 10 for each checkpoint read |
    | `abnormal` | 10 more if its value is outside the nominal range |
    | `finding` | 5 for each thing noticed on the way |
    | `contact` | -1 for each contact with the site (drive `kinematic`) |
    | `docked` | 20 for the end dock |
    | `dead` | -20 if the battery is empty |

    `info` also tells `time` (s), `failure` (in words, or empty), the kinds of what was `found`, what
    `trouble` the drive had (in words), and the value of the `reading` if there is one.

    ## Starting State
    In one of the docks, drawn, with a full battery and all checkpoints to be read. The end dock is
    drawn as well.

    ## Episode End
    Terminated when the robot is in its end dock, or its battery is empty. Truncated when the time
    limit is reached.

    ## Randomisation
    What the checkpoints show, within their nominal ranges; start and end dock; and `faults`: so
    many, drawn from the kinds that the drive can find, with random times and places. The drive
    `route` has no world, so faults that are found by gas, heat, sound or sight need `kinematic`.
    Seeds from 1,000,000 on are for tests by convention: train with lower ones.

    ## Arguments
    - `scenario` ("umad"): name or file of a site, or `generated:floors=3,seed=7`.
    - `drive` ("route"): `route` goes by travel times; `kinematic` drives in PyBullet, with contacts
      and all watches, at a small part of the speed.
    - `time_limit` (1800): s of simulated time.
    - `faults` (1): how many are drawn for each episode.
    - `checkpoints` (None): n; None: as many as the site has. `docks` (None): d, likewise.

    `reset(options=...)`, which hold until others are given (`{}`: none):
    - `scenario`: another site, with no more checkpoints and docks than n and d.
    - `floor`: number, or list of numbers: only checkpoints on these floors are to be read.
    - `faults`: how many, or a list as in a file of faults, such as `[{"kind": "low_battery"}]`.
    - `seed`: of the simulation, in place of a drawn one.

    `get_state()` gives what `set_state(state)` goes on from, the generator included. It does the
    actions since the reset again.

    ## Version History
    - v0: first version
    """  # noqa: E501

    _title = "argo/Inspect-v0"
    metadata = {  # noqa: RUF012
        "render_modes": ["human", "rgb_array"],
        "render_fps": _FPS,
    }

    def __init__(
        self,
        scenario: str = "umad",
        drive: str = ROUTE,
        time_limit: float = 1800.0,
        faults: int = 1,
        checkpoints: int | None = None,
        docks: int | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Raises ArgoError if there is no such scenario, drive or render mode."""
        check_render_mode(render_mode, self.metadata["render_modes"])
        if drive not in DRIVES:
            raise NotFound(f"no drive `{drive}`; there are: {', '.join(DRIVES)}")
        check_scenario(self._title, scenario)
        check_positive(self._title, LONGEST, time_limit=time_limit)
        check_whole(self._title, 0, MOST_FAULTS, faults=faults)
        self.render_mode = render_mode
        self._scenario, self._drive, self._limit = scenario, drive, time_limit
        self._default_faults = faults
        site = open_site(scenario).prepare().site
        self._slots = self._room("checkpoints", checkpoints, len(site.checkpoints), site.name)
        self._docks = self._room("docks", docks, len(site.docks), site.name)
        places = self._slots + self._docks
        share, one = spaces.Box(0.0, 1.0, (places,)), spaces.Box(0.0, 1.0, (1,))
        parts: dict[str, spaces.Space[Any]] = {
            "travel": share,
            "points": share,
            "failed": share,
            "left": one,
            "battery": one,
            "floor": one,
            "noticed": spaces.MultiBinary(len(_EVENTS)),
            "mask": spaces.MultiBinary(places),
        }
        self.observation_space = dict_space(parts)
        self.action_space = spaces.Discrete(places)
        self._prepare(InspectOptions())
        self._run: Inspection | None = None
        self._over: bool | None = None

    # -- the environment

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._prepare(read_options(InspectOptions, options, self._title))
        # Until the new episode has begun there is none.
        self._over = None
        self._begun = self.np_random.bit_generator.state
        rng, site = self.np_random, self._site.site
        drawn = int(rng.integers(2**31))
        docks = sorted(site.docks)
        start, self._end = (int(rng.choice(len(docks))) for _ in range(2))
        spec = RunSpec(
            mission=beginning(self._site, site.docks[docks[start]]),
            site=self._site.reference,
            drive=self._drive,
            seed=drawn if self._options.seed is None else self._options.seed,
            faults=self._faults(rng),
        )
        run = check_run(spec, self._site)
        if self._run:
            self._run.close()
        self._run = Inspection(run, self._limit)
        self._read = np.zeros(self._slots, np.bool_)
        self._abnormal = np.zeros(self._slots, np.bool_)
        self._failed = np.zeros(self._slots + self._docks, np.int64)
        self._actions: list[int] = []
        self._over = False
        observation = self._observe()
        self._show()
        return observation, {"settings": spec.settings}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        check_under_way(self._over, self._title)
        run, place = self._running, read_choice(action, self._slots + self._docks, self._title)
        illegal = not self._mask[place]
        if illegal:
            deed, docked = run.stand(_PATIENCE), False
        else:
            deed, docked = self._go(place)
        terms = {
            "reading": READING if deed.reading else 0.0,
            "abnormal": ABNORMAL if deed.reading and not deed.reading.normal else 0.0,
            "finding": FINDING * len(deed.found),
            "contact": CONTACT * deed.contacts,
            "docked": DOCKED if docked else 0.0,
            "dead": DEAD if run.dead and not docked else 0.0,
        }
        self._actions.append(place)
        terminated = docked or run.dead
        if terminated:
            run.finish()
        info: dict[str, Any] = {
            "terms": terms,
            "time": run.now,
            "illegal": illegal,
            "failure": deed.failure or "",
            "found": tuple(anomaly.kind.value for anomaly in deed.found),
            "trouble": tuple(f"{m.trouble}: {m.detail}" for m in deed.trouble),
        }
        if deed.reading:
            info["reading"] = deed.reading.value
        observation = self._observe()
        self._show()
        truncated = run.time_up and not terminated
        self._over = terminated or truncated
        return observation, sum(terms.values()), terminated, truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions are legal now, shape (n + d,)."""
        check_begun(self._over, self._title)
        return self._mask.copy()

    def record(self) -> RunRecord:
        """The record of the episode as it stands, as of a run whose mission were these actions."""
        return self._running.record()

    def close(self) -> None:
        if self._run:
            self._run.close()
            self._run = None
        self._over = None
        super().close()

    # -- states

    def get_state(self) -> dict[str, Any]:
        """All that the future depends on, as plain data that can be pickled."""
        check_begun(self._over, self._title)
        return {
            "begun": self._begun,
            "options": self._options.model_dump(mode="json", exclude_unset=True),
            "actions": tuple(self._actions),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Goes on from what `get_state` gave; returns the observation of that moment. Raises
        ArgoError if it is no state of this environment."""
        check_state(state, _STATE, self._title)
        with self._repeating():
            self.np_random.bit_generator.state = state["begun"]
            observation, _ = self.reset(options=dict(state["options"]))
            for action in state["actions"]:
                observation = self.step(action)[0]
            self.np_random.bit_generator.state = state["generator"]
        return observation

    def _copied_state(self) -> tuple[InspectOptions, dict[str, Any] | None]:
        return self._options, None if self._over is None else self.get_state()

    def _go_on_from(self, state: tuple[InspectOptions, dict[str, Any] | None]) -> None:
        options, episode = state
        if episode is not None:
            self.set_state(episode)
        else:
            self._prepare(options)

    # -- inside

    @property
    def _running(self) -> Inspection:
        check_begun(self._over, self._title)
        assert self._run is not None
        return self._run

    def _prepare(self, options: InspectOptions) -> None:
        """Takes the options on, and makes the site ready that they ask for; ArgoError if it does
        not fit, and then nothing has changed."""
        scenario = options.scenario or self._scenario
        opened = open_site(scenario).prepare()
        site = opened.site
        if len(site.checkpoints) > self._slots or len(site.docks) > self._docks:
            raise Invalid(
                f"site {site.name} has {len(site.checkpoints)} checkpoints and {len(site.docks)} "
                f"docks, and there is room for {self._slots} and {self._docks}: make the "
                "environment with larger `checkpoints` and `docks`"
            )
        floors = [floor.number for floor in site.spec.floors]
        check_floors(scenario, floors, options.floors)
        if isinstance(options.faults, tuple):
            dock = site.docks[min(site.docks)]
            mission = beginning(opened, dock)
            check_spec(RunSpec(mission=mission, drive=self._drive, faults=options.faults), site)
        asked = options.floors or floors
        self._options, self._site = options, opened
        self._travel_times = travel_times(opened.navigator)
        self._asked = np.zeros(self._slots, np.bool_)
        self._asked[: len(site.checkpoints)] = [c.floor in asked for c in site.checkpoints]

    def _room(self, name: str, wanted: int | None, there: int, site: str) -> int:
        """How many places of a kind there is room for: all of the site's unless more are wanted."""
        if wanted is None:
            return there
        why = f", as site {site} has {there} {name}; leave it out to have room for just these"
        check_whole(self._title, there, max(there, _MOST_PLACES), why, **{name: wanted})
        return int(wanted)

    def _faults(self, rng: np.random.Generator) -> tuple[AnyFault, ...]:
        given = self._options.faults
        if isinstance(given, tuple):
            return given
        count = self._default_faults if given is None else given
        return draw_faults(count, self._drive, self._site.site, rng)

    def _go(self, place: int) -> tuple[Deed, bool]:
        """Carries the action out; whether the robot is in its end dock then."""
        run, site = self._running, self._site.site
        if place < self._slots:
            deed = run.read(site.checkpoints[place].id)
            if deed.reading:
                self._read[place] = True
                self._abnormal[place] = not deed.reading.normal
        else:
            dock = site.docks[sorted(site.docks)[place - self._slots]]
            deed = run.drive(dock)
        if deed.failure is not None:
            self._failed[place] += 1
        arrived = place >= self._slots and deed.failure is None and not (run.time_up or run.dead)
        if arrived and place != self._slots + self._end:
            stay = run.stand(_PATIENCE, charging=True)
            return replace(deed, found=deed.found + stay.found), False
        return deed, arrived

    def _observe(self) -> Observation:
        run, site, n = self._running, self._site.site, self._slots
        travel = self._travel()
        alarm = EventKind.PLATFORM_ALARM in run.noticed
        mask = np.zeros(n + self._docks, np.bool_)
        mask[:n] = self._asked & ~self._read & (self._failed[:n] < _TRIES) & np.isfinite(travel[:n])
        if alarm:
            mask[:n] = False
        mask[n : n + len(site.docks)] = True
        self._mask = mask
        points = np.where(mask, READING, 0.0)
        points[n:] = 0.0
        points[n + self._end] = DOCKED
        one = np.float32
        floor = site.floor_at(run.pose.z) / len(site.spec.floors)
        noticed = set(run.noticed)
        return {
            "travel": np.minimum(travel / self._limit, 1.0).astype(one),
            "points": (points / DOCKED).astype(one),
            "failed": np.minimum(self._failed / _TRIES, 1.0).astype(one),
            "left": np.array([max(0.0, 1.0 - run.now / self._limit)], dtype=one),
            "battery": np.array([run.charge], dtype=one),
            "floor": np.array([floor], dtype=one),
            "noticed": np.array([kind in noticed for kind in _EVENTS], dtype=np.int8),
            "mask": mask.astype(np.int8),
        }

    def _travel(self) -> NDArray[np.float64]:
        """Estimated s to each place, infinite for empty slots and where there is no way."""
        run, site, n = self._running, self._site.site, self._slots
        docks = len(site.docks)
        times = self._travel_times.row(run.pose, run.navigator)
        travel = np.full(n + self._docks, np.inf)
        travel[: len(times) - docks] = times[docks:]
        travel[n : n + docks] = times[:docks]
        return travel

    def _picture(self) -> NDArray[np.uint8]:
        """The site's floors with what was read and the way driven."""
        run = self._running
        last = self._actions[-1] if self._actions else None
        return draw_inspection(
            self._options.scenario or self._scenario,
            run,
            [self._state_of(k) for k in range(len(self._site.site.checkpoints))],
            last,
            self._end,
            f"{run.now:.0f} s of {self._limit:.0f} s    battery {run.charge:.0%}    "
            f"read {self._read.sum()} of {self._asked.sum()}",
        )

    def _state_of(self, slot: int) -> str:
        """What a picture shows of a checkpoint."""
        if self._read[slot]:
            return "abnormal" if self._abnormal[slot] else "done"
        if not self._asked[slot]:
            return "outside"
        return "open" if self._mask[slot] else "closed"


class InspectVectorEnv(SpreadVectorEnv):
    """Many inspections at once, as `gymnasium.make_vec("argo/Inspect-v0", num_envs=8)` makes them.
    Arguments and options are those of `InspectEnv`, and `processes`."""

    single = InspectEnv
    _title = "argo/Inspect-v0"

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions are legal now, shape (num_envs, n + d)."""
        return np.stack(self.call("action_masks"))
