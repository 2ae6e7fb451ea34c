"""`argo/Inspect-v0`: choose the next checkpoint; the simulated robot drives there and reads it."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pydantic import Field, StrictInt

from argo_compiler.base.errors import ArgoError, Invalid, NotFound
from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.drives.timed_drive import RouteDrive
from argo_env.envs.batch import ProcessVectorEnv
from argo_env.envs.episode import (
    Copyable,
    Rendering,
    StateTypes,
    check_render_mode,
    check_state,
    parse_discrete_action,
    require_episode_begun,
    require_episode_under_way,
)
from argo_env.envs.inspection_drawing import draw_inspection
from argo_env.envs.inspection_run import (
    ActionResult,
    Inspection,
    cached_travel_times,
    initial_mission,
)
from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.options import (
    MAX_DURATION,
    check_floors,
    check_integer,
    check_positive,
    check_scenario_is_string,
    options_from_dict,
)
from argo_env.faults.kinds import KINDS, AnyFault, resolve_faults
from argo_env.faults.robot import EmergencyStop
from argo_env.planning import open_site
from argo_env.run.drives_and_sensors import ROUTE, drive_names
from argo_env.run.record import RunRecord
from argo_env.run.run_setup import check_spec
from argo_env.run.spec import RunSpec
from argo_env.run.validation import check_run
from argo_env.seeding import draw
from argo_env.site import Site

MAX_FAULTS = 8
_Count = Annotated[int, Field(ge=0, le=MAX_FAULTS, strict=True)]


class InspectOptions(Model):
    """Options for `reset(options=...)` of Inspect-v0."""

    scenario: str | None = None
    floor: StrictInt | tuple[StrictInt, ...] = ()
    faults: _Count | tuple[AnyFault, ...] | None = None
    seed: int | None = Field(default=None, ge=0, strict=True)

    @property
    def given_floors(self) -> tuple[int, ...]:
        return (self.floor,) if isinstance(self.floor, int) else self.floor


def draw_faults(
    count: int, drive: str, site: Site, rng: np.random.Generator
) -> tuple[AnyFault, ...]:
    """Draw faults of different kinds that suit the drive and the site.

    There are `count`, or one of each such kind if there are fewer kinds.
    """
    without_physics = drive == RouteDrive.name
    kinds = [
        kind
        for kind, model in KINDS.items()
        if not (model.needs_world and without_physics) and _suits_site(kind, site)
    ]
    drawn = [kinds[k] for k in rng.permutation(len(kinds))[:count]]
    return tuple(_draw_fault(kind, rng) for kind in drawn)


def _suits_site(kind: str, site: Site) -> bool:
    """Return True if the site has what such a fault needs, such as a pump or stairs."""
    try:
        resolve_faults([KINDS[kind].model_validate({})], site, 0)
    except ArgoError:
        return False
    return True


def _draw_fault(kind: str, rng: np.random.Generator) -> AnyFault:
    """Return a fault of this kind; the run's seed draws what it leaves open.

    The times of an emergency stop are drawn here: a person releases it after a minute.
    """
    if kind == "emergency_stop":
        at = draw(rng, 0.0, 600.0, 1)
        return EmergencyStop(at=at, until=at + 60.0)
    return KINDS[kind].model_validate({})


READING, ABNORMAL, FINDING, CONTACT, DOCKED, DEAD = 10.0, 10.0, 5.0, -1.0, 20.0, -20.0
"""terms of the reward: see the docstring of `InspectEnv`"""
_MAX_FAILURES = 2  # failed readings after which a checkpoint is given up
_WAIT = 10.0  # s that an illegal action takes, and the shortest stay in a dock
_MAX_SLOTS = 1000  # of checkpoints, and of docks
_FPS = 2
_EVENTS = tuple(EventKind)
_STATE: StateTypes = {"begun": dict, "options": dict, "actions": (tuple, list), "generator": dict}


class InspectEnv(Copyable, Rendering, gym.Env[Observation, np.int64]):
    """Environment in which a robot reads the checkpoints of a site and docks in time.

    ## Description
    The agent chooses where to go next. The robot plans its path, drives and measures as in a mission,
    and its watches notice what happens on the way. Things go wrong: see Randomisation.

    ## Observation Space
    A `Dict`. With n slots for checkpoints (in the order of their numbers) and d slots for docks there
    are n + d slots. All parts are `float32` from 0 to 1 except the last two.

    | key | shape | meaning |
    |---|---|---|
    | `travel` | (n + d,) | estimated travel time from here to each slot, as a share of the time limit; 1 also if there is no path |
    | `points` | (n + d,) | points that are certain there, divided by 20 |
    | `failed` | (n + d,) | number of failures there, divided by 2 |
    | `left` | (1,) | time left, as a share of the time limit |
    | `battery` | (1,) | charge, as estimated from the battery's voltage and current |
    | `floor` | (1,) | floor of the robot, divided by the number of floors |
    | `noticed` | (k,) | `int8`, 1 for each `EventKind` that was noticed so far |
    | `mask` | (n + d,) | `int8`, 1 where the action is legal |

    ## Action Space
    `Discrete(n + d)`: read checkpoint k, or go to dock k - n. The end dock ends the episode; in any
    other dock the robot stays until its battery is full. Docks are always legal. A checkpoint is
    legal until it was read or has failed twice, as long as a path to it is known; after the platform
    alarm none is. `action_masks()` returns the mask as booleans, as MaskablePPO of sb3-contrib
    requires. An illegal action makes the robot wait for 10 s, and `info["illegal"]` is true.

    ## Rewards
    Argo's own points (those of the competition are not public); the terms are in `info["terms"]`:

    | term | points |
    |---|---|
    | `reading` | 10 for each checkpoint read |
    | `abnormal` | 10 more if its value is outside the nominal range |
    | `finding` | 5 for each thing noticed on the way |
    | `contact` | -1 for each contact with the site (drive `kinematic`) |
    | `docked` | 20 for the end dock |
    | `dead` | -20 if the battery is empty |

    `info` also has `time` (s), `failure` (in words, or empty), `found` (the kinds of what was noticed),
    `trouble` (what happened to the drive, in words) and, if there is one, the value of the `reading`.

    ## Starting State
    The robot is in a random dock with a full battery, and all checkpoints are to be read. The end
    dock is random too.

    ## Episode End
    Terminated when the robot is in its end dock, or its battery is empty. Truncated when the time
    limit is reached.

    ## Randomisation
    The values of the checkpoints, within their nominal ranges; start and end dock; and as many faults
    as `faults` says, drawn from the kinds that the drive can find, with random times and positions.
    The drive `route` has no world, so faults that are found by gas, heat, sound or sight need
    `kinematic`. By convention, seeds from 1,000,000 on are for tests: train with lower ones.

    ## Arguments
    - `scenario` ("umad"): name or file of a site, or `generated:floors=3,seed=7`.
    - `drive` ("route"): `route` computes travel times only; `kinematic` drives in PyBullet, with
      contacts and all watches, and is much slower.
    - `time_limit` (1800): s of simulated time.
    - `faults` (1): number of faults that are drawn for each episode.
    - `checkpoints` (None): n; None for as many as the site has. `docks` (None): d, likewise.

    Options of `reset(options=...)` apply until others are given (`{}` removes them):
    - `scenario`: another site, with no more checkpoints and docks than n and d.
    - `floor`: number, or list of numbers, of the floors whose checkpoints are to be read.
    - `faults`: a number, or a list as in a file of faults, such as `[{"kind": "low_battery"}]`.
    - `seed`: seed of the simulation, instead of a random one.

    `get_state()` returns a state from which `set_state(state)` continues, with the same random
    generator. `set_state` repeats the actions since the reset.

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
        """Create the environment; the docstring of the class describes the arguments.

        Raises ArgoError if an argument is invalid, or if there is no such scenario, drive or render
        mode.
        """
        check_render_mode(render_mode, self.metadata["render_modes"])
        if drive not in drive_names():
            raise NotFound(
                f"there is no drive `{drive}`; choose one of: {', '.join(drive_names())}"
            )
        check_scenario_is_string(self._title, scenario)
        check_positive(self._title, MAX_DURATION, time_limit=time_limit)
        check_integer(self._title, 0, MAX_FAULTS, faults=faults)
        self.render_mode = render_mode
        self._scenario, self._drive, self._limit = scenario, drive, time_limit
        self._default_faults = faults
        site = open_site(scenario).prepare().site
        self._slots = self._count_slots(
            "checkpoints", checkpoints, len(site.checkpoints), site.name
        )
        self._docks = self._count_slots("docks", docks, len(site.docks), site.name)
        slots = self._slots + self._docks
        share, one = spaces.Box(0.0, 1.0, (slots,)), spaces.Box(0.0, 1.0, (1,))
        parts: dict[str, spaces.Space[Any]] = {
            "travel": share,
            "points": share,
            "failed": share,
            "left": one,
            "battery": one,
            "floor": one,
            "noticed": spaces.MultiBinary(len(_EVENTS)),
            "mask": spaces.MultiBinary(slots),
        }
        self.observation_space = dict_space(parts)
        self.action_space = spaces.Discrete(slots)
        self._apply_options(InspectOptions())
        self._run: Inspection | None = None
        self._over: bool | None = None

    # -- the environment

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._apply_options(options_from_dict(InspectOptions, options, self._title))
        # There is no episode until the new one has begun.
        self._over = None
        self._state_at_reset = self.np_random.bit_generator.state
        rng, site = self.np_random, self._site.site
        drawn = int(rng.integers(2**31))
        docks = sorted(site.docks)
        start, self._end = (int(rng.choice(len(docks))) for _ in range(2))
        spec = RunSpec(
            mission=initial_mission(self._site, site.docks[docks[start]]),
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
        self._update_window()
        return observation, {"settings": spec.settings}

    def step(self, action: np.int64 | int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        require_episode_under_way(self._over, self._title)
        run, chosen = (
            self._current_run,
            parse_discrete_action(action, self._slots + self._docks, self._title),
        )
        illegal = not self._mask[chosen]
        if illegal:
            result, docked = run.stay(_WAIT), False
        else:
            result, docked = self._execute(chosen)
        terms = {
            "reading": READING if result.reading else 0.0,
            "abnormal": ABNORMAL if result.reading and not result.reading.normal else 0.0,
            "finding": FINDING * len(result.anomalies),
            "contact": CONTACT * result.contacts,
            "docked": DOCKED if docked else 0.0,
            "dead": DEAD if run.is_battery_empty and not docked else 0.0,
        }
        self._actions.append(chosen)
        terminated = docked or run.is_battery_empty
        if terminated:
            run.end_mission()
        info: dict[str, Any] = {
            "terms": terms,
            "time": run.now,
            "illegal": illegal,
            "failure": result.failure or "",
            "found": tuple(anomaly.kind.value for anomaly in result.anomalies),
            "trouble": tuple(f"{m.trouble}: {m.detail}" for m in result.mishaps),
        }
        if result.reading:
            info["reading"] = result.reading.value
        observation = self._observe()
        self._update_window()
        truncated = run.is_time_up and not terminated
        self._over = terminated or truncated
        return observation, math.fsum(terms.values()), terminated, truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Return a mask of the actions that are legal now, shape (n + d,)."""
        require_episode_begun(self._over, self._title)
        return self._mask.copy()

    def record(self) -> RunRecord:
        """Return the episode so far as the record of a run, whose tasks are the actions so far."""
        return self._current_run.record()

    def close(self) -> None:
        if self._run:
            self._run.close()
            self._run = None
        self._over = None
        super().close()

    # -- states

    def get_state(self) -> dict[str, Any]:
        """Return the state of the episode, from which `set_state` continues.

        It is plain data that can be pickled.
        """
        require_episode_begun(self._over, self._title)
        return {
            "begun": self._state_at_reset,
            "options": self._options.model_dump(mode="json", exclude_unset=True),
            "actions": tuple(self._actions),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Continue from a state that `get_state` returned, and return its observation.

        Raises ArgoError if it is not a state of this environment.
        """
        check_state(state, _STATE, self._title)
        with self._replaying():
            self.np_random.bit_generator.state = state["begun"]
            observation, _ = self.reset(options=dict(state["options"]))
            for action in state["actions"]:
                observation = self.step(action)[0]
            self.np_random.bit_generator.state = state["generator"]
        return observation

    def _state_for_copy(self) -> tuple[InspectOptions, dict[str, Any] | None]:
        return self._options, None if self._over is None else self.get_state()

    def _restore_copy(self, state: tuple[InspectOptions, dict[str, Any] | None]) -> None:
        options, episode = state
        if episode is not None:
            self.set_state(episode)
        else:
            self._apply_options(options)

    # -- inside

    @property
    def _current_run(self) -> Inspection:
        require_episode_begun(self._over, self._title)
        assert self._run is not None
        return self._run

    def _apply_options(self, options: InspectOptions) -> None:
        """Apply the options, and open the site that they name.

        Raises ArgoError if they are not possible there; then nothing changes.
        """
        scenario = options.scenario or self._scenario
        opened = open_site(scenario).prepare()
        site = opened.site
        if len(site.checkpoints) > self._slots or len(site.docks) > self._docks:
            raise Invalid(
                f"site {site.name} has {len(site.checkpoints)} checkpoints and {len(site.docks)} "
                f"docks, and the environment has room for {self._slots} and {self._docks}: make it "
                "with larger `checkpoints` and `docks`"
            )
        floors = [floor.number for floor in site.spec.floors]
        check_floors(scenario, floors, options.given_floors)
        if isinstance(options.faults, tuple):
            dock = site.docks[min(site.docks)]
            mission = initial_mission(opened, dock)
            check_spec(RunSpec(mission=mission, drive=self._drive, faults=options.faults), site)
        floors_to_read = options.given_floors or floors
        self._options, self._site = options, opened
        self._travel_times = cached_travel_times(opened.navigator)
        self._requested = np.zeros(self._slots, np.bool_)
        self._requested[: len(site.checkpoints)] = [
            c.floor in floors_to_read for c in site.checkpoints
        ]

    def _count_slots(self, name: str, requested: int | None, existing: int, site: str) -> int:
        """Return the number of slots: `existing`, which the site has, or the requested number.

        Raises ArgoError if the requested number is below `existing`, or above both it and
        `_MAX_SLOTS`.
        """
        if requested is None:
            return existing
        reason = (
            f", as site {site} has {existing} {name}; leave it out to have room for exactly these"
        )
        check_integer(self._title, existing, max(existing, _MAX_SLOTS), reason, **{name: requested})
        return int(requested)

    def _faults(self, rng: np.random.Generator) -> tuple[AnyFault, ...]:
        given = self._options.faults
        if isinstance(given, tuple):
            return given
        count = self._default_faults if given is None else given
        return draw_faults(count, self._drive, self._site.site, rng)

    def _execute(self, slot: int) -> tuple[ActionResult, bool]:
        """Execute the action with this number, and return its result.

        The second value is True if the robot is in its end dock then.
        """
        run, site = self._current_run, self._site.site
        if slot < self._slots:
            result = run.measure_checkpoint(site.checkpoints[slot].id)
            if result.reading:
                self._read[slot] = True
                self._abnormal[slot] = not result.reading.normal
        else:
            dock = site.docks[sorted(site.docks)[slot - self._slots]]
            result = run.drive_to(dock)
        if result.failure is not None:
            self._failed[slot] += 1
        arrived = (
            slot >= self._slots
            and result.failure is None
            and not (run.is_time_up or run.is_battery_empty)
        )
        if arrived and slot != self._slots + self._end:
            stay = run.stay(_WAIT, longer_until_full=True)
            return replace(result, anomalies=result.anomalies + stay.anomalies), False
        return result, arrived

    def _observe(self) -> Observation:
        run, site, n = self._current_run, self._site.site, self._slots
        travel = self._estimate_travel_times()
        alarm = EventKind.PLATFORM_ALARM in run.kinds_noticed_so_far
        mask = np.zeros(n + self._docks, np.bool_)
        mask[:n] = (
            self._requested
            & ~self._read
            & (self._failed[:n] < _MAX_FAILURES)
            & np.isfinite(travel[:n])
        )
        if alarm:
            mask[:n] = False
        mask[n : n + len(site.docks)] = True
        self._mask = mask
        points = np.where(mask, READING, 0.0)
        points[n:] = 0.0
        points[n + self._end] = DOCKED
        float32 = np.float32
        floor = site.floor_at(run.pose.z) / len(site.spec.floors)
        noticed = set(run.kinds_noticed_so_far)
        return {
            "travel": np.minimum(travel / self._limit, 1.0).astype(float32),
            "points": (points / DOCKED).astype(float32),
            "failed": np.minimum(self._failed / _MAX_FAILURES, 1.0).astype(float32),
            "left": np.array([max(0.0, 1.0 - run.now / self._limit)], dtype=float32),
            "battery": np.array([run.charge], dtype=float32),
            "floor": np.array([floor], dtype=float32),
            "noticed": np.array([kind in noticed for kind in _EVENTS], dtype=np.int8),
            "mask": mask.astype(np.int8),
        }

    def _estimate_travel_times(self) -> NDArray[np.float64]:
        """Return estimated times (s) to the slots, infinite for empty or unreachable ones."""
        run, site, n = self._current_run, self._site.site, self._slots
        docks = len(site.docks)
        times = self._travel_times.times_to_docks_and_checkpoints(run.pose, run.navigator)
        travel = np.full(n + self._docks, np.inf)
        travel[: len(times) - docks] = times[docks:]
        travel[n : n + docks] = times[:docks]
        return travel

    def _draw_picture(self) -> NDArray[np.uint8]:
        """Return a picture of the floors with what was read and the driven path."""
        run = self._current_run
        last = self._actions[-1] if self._actions else None
        return draw_inspection(
            self._options.scenario or self._scenario,
            run,
            [self._marker_state(k) for k in range(len(self._site.site.checkpoints))],
            last,
            self._end,
            f"{run.now:.0f} s of {self._limit:.0f} s    battery {run.charge:.0%}    "
            f"read {self._read.sum()} of {self._requested.sum()}",
        )

    def _marker_state(self, slot: int) -> str:
        """Return the state of a checkpoint that a picture shows."""
        if self._read[slot]:
            return "abnormal" if self._abnormal[slot] else "done"
        if not self._requested[slot]:
            return "outside"
        return "open" if self._mask[slot] else "closed"


class InspectVectorEnv(ProcessVectorEnv):
    """Vector environment of many inspections.

    `gymnasium.make_vec("argo/Inspect-v0", num_envs=8)` makes one. Arguments and options are those
    of `InspectEnv`, and `processes`.
    """

    env_class = InspectEnv
    _title = "argo/Inspect-v0"

    def action_masks(self) -> NDArray[np.bool_]:
        """Return a mask of the actions that are legal now, shape (num_envs, n + d)."""
        return np.stack(self.call("action_masks"))
