"""`argo/Drive-v0`: drive the tracked robot to a goal, over stairs where it has to."""

import math
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_env.drives.tracked.body import FLIPPER_LIMITS, TIME_STEP
from argo_env.envs import lidar
from argo_env.envs.batch import SpreadVectorEnv
from argo_env.envs.drive_site import NEAREST, DriveOptions, DriveSite, DriveSites
from argo_env.envs.episode import (
    Copying,
    Parts,
    Rendering,
    check_begun,
    check_render_mode,
    check_state,
    check_under_way,
    no_state,
)
from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.options import LONGEST, check_positive, check_scenario, read_options
from argo_env.navigation.path import wrap
from argo_env.pictures.drive import draw_drive
from argo_env.robot.pose import BodyPose

Place = tuple[float, float, float]
Start = tuple[float, float, float, float]
Action = tuple[float, float, float]

SPEED = 0.5  # m/s, with action 1
TURN_RATE = 0.6  # rad/s
SUBSTEPS = 24  # of the physics for each action
PERIOD = SUBSTEPS * TIME_STEP  # s: 0.1
REACHED = 0.3  # m from the goal
TIPPED = math.radians(60.0)
PROGRESS, GOAL, TIPPING, CONTACT, TIME = 0.1, 10.0, -10.0, -0.05, -0.01
"""rewards: see the description of the environment"""
_FAR = (20.0, 20.0, 10.0)  # m that are 1 in the observation of the goal
_LONG = 300.0  # s, likewise
_STATE: Parts = {
    "scenario": str, "options": dict, "start": (tuple, list), "goal": (tuple, list),
    "actions": (tuple, list), "generator": dict,
}  # fmt: skip


class DriveEnv(Copying, Rendering, gym.Env[Observation, NDArray[np.float32]]):
    """## Description
    A tracked robot of 60 kg or so has to get to a goal somewhere on a site with several floors. Its
    dynamics are those of the drive `tracked`: rigid bodies at 240 Hz, belts by contact-surface
    motion, real steps. The stairs are climbed backwards and descended forwards, with the flippers
    raised at the first step and flat on the flight.

    ## Observation Space
    A `Dict` of `float32` boxes. The robot's frame has x ahead and y to the left, and is level.

    | key | shape | range | meaning |
    |---|---|---|---|
    | `lidar` | (32,) | 0 to 1 | distance to the first thing around, of 5 m, counter-clockwise from straight ahead, in a level plane 0.45 m above the ground |
    | `ground` | (22,) | -1 to 1 | height of the ground (m) from 1.25 m behind to 1.25 m ahead, below the right and the left track in turn |
    | `body` | (7,) | -1 to 1 | pitch and roll (of 90°), speed (of 1 m/s), turn rate (of 1.2 rad/s), flipper angle (of 50°), belt speeds left and right (of 1 m/s) |
    | `goal` | (4,) | -1 to 1 | goal in the robot's frame (x and y of 20 m, z of 10 m), and time to go at planning speeds (of 300 s) |
    | `way` | (5,) | -1 to 1 | next point of the planned way in the robot's frame (of 1 m), and sine and cosine of the turn to the heading that the plan has there |

    The way is that of Argo's navigator; without `way` in the observation (`waypoint=False`) the
    agent has to find it.

    ## Action Space
    `Box(-1, 1, (3,))`, held for 0.1 s:

    | | meaning | at -1 | at 1 |
    |---|---|---|---|
    | 0 | speed ahead | -0.5 m/s | 0.5 m/s |
    | 1 | turn rate, counter-clockwise | -0.6 rad/s | 0.6 rad/s |
    | 2 | angle of the flippers, tips up | -30° | 50° |

    ## Rewards
    Terms, in `info["terms"]`; the reward is their sum:

    | term | value |
    |---|---|
    | `progress` | 0.1 for each second less to go, as the navigator counts them |
    | `goal` | 10 when it is reached |
    | `tipped` | -10 when the robot has tipped over or fallen |
    | `contact` | -0.05 for each step in which it presses against what is not to be touched |
    | `time` | -0.01 for each step |

    ## Starting State
    At rest on the level, flippers flat, turned at random, at a place with room to turn; the way to
    the goal takes between 5 s and `max_way` at planning speeds.

    ## Episode End
    Terminated when the robot is within 0.3 m of its goal (`info["success"]`), or is tilted by more
    than 60° or has fallen. Truncated after `time_limit`.

    ## Randomisation
    Start, heading and goal (one of six places on each floor). With several scenarios, the site. Seeds
    from 1,000,000 on are for tests by convention: train with lower ones.

    ## Arguments
    - `scenario` ("umad"): name or file of a site, or `generated:floors=3,seed=7`, or several.
    - `max_way` (120): s at planning speeds that the goal is away at most, 5 or more; more than
      about 60 leads to other floors.
    - `time_limit` (300): s.
    - `waypoint` (True): whether the observation has `way`.

    `reset(options=...)`, which hold until others are given (`{}`: none):
    - `scenario`, `max_way`: as above.
    - `floor`: number, or list of numbers: start and goal are on these floors.
    - `faults`: a list as in a file of faults; `brick`, `missing_plate`, `blocked_stairs` and
      `drive_dysfunction`. What is left out of them is drawn by their own `seed` (0 if they have
      none), so that the site stays as it is from episode to episode.

    A reset restores the physics to a saved state; the site is built anew only for other scenarios
    or faults. `get_state()` gives what `set_state(state)` goes on from, the generator included. It does
    the actions since the reset again, since PyBullet's own states do not go on bit by bit where the
    robot touches the ground.

    ## Version History
    - v0: first version
    """  # noqa: E501

    _title = "argo/Drive-v0"
    metadata = {  # noqa: RUF012
        "render_modes": ["human", "rgb_array"],
        "render_fps": round(1 / PERIOD),
    }

    def __init__(
        self,
        scenario: str | tuple[str, ...] = "umad",
        max_way: float = 120.0,
        time_limit: float = 300.0,
        waypoint: bool = True,
        render_mode: str | None = None,
    ) -> None:
        """Raises ArgoError if there is no such scenario or render mode."""
        check_render_mode(render_mode, self.metadata["render_modes"])
        names = tuple(scenario) if isinstance(scenario, tuple | list) else (scenario,)
        for name in names:
            check_scenario(self._title, name)
        check_positive(self._title, LONGEST, time_limit=time_limit, max_way=max_way)
        if max_way < NEAREST:
            raise Invalid(
                f"{self._title}: `max_way` is {max_way:g}, and has to be at least {NEAREST:g} (s)"
            )
        self.render_mode = render_mode
        self._max_way = max_way
        self._limit = round(time_limit / PERIOD)
        self._waypoint = waypoint
        parts: dict[str, spaces.Space[Any]] = {
            "lidar": spaces.Box(0.0, 1.0, (lidar.RAYS,)),
            "ground": spaces.Box(-1.0, 1.0, (2 * len(lidar.ALONG),)),
            "body": spaces.Box(-1.0, 1.0, (7,)),
            "goal": spaces.Box(-1.0, 1.0, (4,)),
        }
        if waypoint:
            parts["way"] = spaces.Box(-1.0, 1.0, (5,))
        self.observation_space = dict_space(parts)
        self.action_space = spaces.Box(-1.0, 1.0, (3,), np.float32)
        self._sites = DriveSites(names)
        self._site = self._sites.make(self._sites.names[0])
        self._over: bool | None = None

    # -- the environment

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._sites.choose(read_options(DriveOptions, options, self._title))
        # Until the new episode has begun there is none.
        self._over = None
        rng, chosen = self.np_random, self._sites.options
        names = self._sites.names
        name = names[int(rng.integers(len(names)))]
        guide = self._sites.make(name).guide
        floors = chosen.floors or guide.floors
        goals = guide.goals(floors)
        x, y, z = goals[int(rng.integers(len(goals)))].tolist()
        goal = (x, y, z)
        most = chosen.max_way or self._max_way
        starts = guide.starts(goal, floors, NEAREST, most)
        x, y, z = starts[int(rng.integers(len(starts)))].tolist()
        self._begin(name, (x, y, z, float(rng.uniform(-math.pi, math.pi))), goal)
        observation = self._observe()
        self._over = False
        self._show()
        return observation, {"goal": self._goal, "scenario": self._site.site.name}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        check_under_way(self._over, self._title)
        body = self._site.body
        self._drive(self._read_action(action))
        before = self._togo
        observation = self._observe()
        success, tipped = self._success, self._tipped
        touches = body.touches()
        terms = {
            "progress": PROGRESS * (before - self._togo),
            "goal": GOAL if success and not tipped else 0.0,
            "tipped": TIPPING if tipped else 0.0,
            "contact": CONTACT if touches else 0.0,
            "time": TIME,
        }
        terminated = success or tipped
        info = {
            "terms": terms,
            "success": success and not tipped,
            "touched": ", ".join(sorted({touch.element for touch in touches})),
            "time": self._time,
        }
        truncated = len(self._actions) >= self._limit and not terminated
        self._over = terminated or truncated
        self._show()
        return observation, sum(terms.values()), terminated, truncated, info

    def close(self) -> None:
        self._sites.close()
        self._over = None
        super().close()

    @property
    def pose(self) -> BodyPose:
        """Where the robot is in truth."""
        check_begun(self._over, self._title)
        return self._pose

    @property
    def goal(self) -> Place:
        """x, y, z (m) of this episode's goal."""
        check_begun(self._over, self._title)
        return self._goal

    @property
    def site(self) -> DriveSite:
        """The site of this episode, with its navigator and the robot's body."""
        return self._site

    # -- states

    def get_state(self) -> dict[str, Any]:
        """All that the future depends on, as plain data that can be pickled."""
        check_begun(self._over, self._title)
        return {
            "scenario": self._name,
            "options": self._sites.options.model_dump(mode="json", exclude_unset=True),
            "start": self._start,
            "goal": self._goal,
            "actions": tuple(self._actions),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Goes on from what `get_state` gave; returns the observation of that moment. Raises
        ArgoError if it is no state of this environment."""
        check_state(state, _STATE, self._title)
        if len(state["start"]) != 4 or len(state["goal"]) != 3:
            raise no_state(self._title)
        actions = [self._read_action(action) for action in state["actions"]]
        self._sites.choose(read_options(DriveOptions, state["options"], self._title))
        self._over = None
        self._begin(state["scenario"], state["start"], state["goal"])
        for action in actions:
            self._drive(action)
        self._site.body.touches()
        self.np_random.bit_generator.state = state["generator"]
        observation = self._observe()
        self._over = self._success or self._tipped or len(self._actions) >= self._limit
        return observation

    def _copied_state(self) -> tuple[DriveOptions, dict[str, Any] | None]:
        return self._sites.options, None if self._over is None else self.get_state()

    def _go_on_from(self, state: tuple[DriveOptions, dict[str, Any] | None]) -> None:
        options, episode = state
        if episode is not None:
            self.set_state(episode)
        elif options != self._sites.options:
            self._sites.choose(options)

    # -- inside

    @property
    def _time(self) -> float:
        return len(self._actions) * PERIOD

    def _begin(self, name: str, start: Start, goal: Place) -> None:
        """Puts the robot at its start (x, y, z, yaw) on the site of that name."""
        self._name, self._start, self._goal = name, start, goal
        self._site = self._sites.make(name)
        self._site.body.reset(BodyPose(*start))
        self._site.body.touches()
        self._site.forget_view()
        self._actions: list[Action] = []

    def _read_action(self, action: Any) -> Action:
        """The action, numbers beyond -1 and 1 taken as these; ArgoError if it is none."""
        try:
            values = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError):
            values = np.empty(0)
        if values.shape != (3,) or not np.isfinite(values).all():
            raise Invalid(f"{self._title}: no action {action!r}; it is three numbers, -1 to 1")
        ahead, turn, flipper = np.clip(values, -1.0, 1.0).tolist()
        return ahead, turn, flipper

    @property
    def _success(self) -> bool:
        """Whether the robot was at its goal when it was last observed."""
        pose, (x, y, z) = self._pose, self._goal
        return math.hypot(pose.x - x, pose.y - y) <= REACHED and abs(pose.z - z) <= REACHED

    @property
    def _tipped(self) -> bool:
        """Whether it has tipped over or fallen."""
        pose, site = self._pose, self._site
        upright = math.cos(pose.pitch) * math.cos(site.body.roll)
        return upright < math.cos(TIPPED) or pose.z < site.site.spec.ground_z - 1.0

    def _drive(self, action: Action) -> None:
        """Carries an action out for 0.1 s."""
        ahead, turn, flipper = action
        body, share = self._site.body, self._site.speed_share(self._time)
        low, high = FLIPPER_LIMITS
        body.command(
            share * SPEED * ahead, share * TURN_RATE * turn, low + (flipper + 1) / 2 * (high - low)
        )
        body.advance(SUBSTEPS)
        self._actions.append(action)

    def _observe(self) -> Observation:
        site, body = self._site, self._site.body
        self._pose = pose = body.pose
        waypoint = site.guide.look(self._goal, pose)
        self._togo = waypoint.seconds
        speed, turn = body.velocity
        left, right = body.belt_speeds
        goal = self._in_frame(*self._goal)
        observation = {
            "lidar": lidar.ring(site.world, pose) / lidar.RANGE,
            "ground": lidar.ground(site.world, pose) / lidar.DEPTH,
            "body": (
                pose.pitch / (math.pi / 2), body.roll / (math.pi / 2), speed, turn / 1.2,
                body.flipper / FLIPPER_LIMITS[1], left, right,
            ),
            "goal": (*(v / far for v, far in zip(goal, _FAR, strict=True)), self._togo / _LONG),
        }  # fmt: skip
        if self._waypoint:
            turn = wrap(waypoint.yaw - pose.yaw)
            place = self._in_frame(waypoint.x, waypoint.y, waypoint.z)
            observation["way"] = (*place, math.sin(turn), math.cos(turn))
        return {
            name: np.clip(np.array(values), -1.0, 1.0).astype(np.float32)
            for name, values in observation.items()
        }

    def _in_frame(self, x: float, y: float, z: float) -> tuple[float, float, float]:
        """A place in the robot's level frame."""
        pose = self._pose
        dx, dy = x - pose.x, y - pose.y
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        return cos * dx + sin * dy, cos * dy - sin * dx, z - pose.z

    def _picture(self) -> NDArray[np.uint8]:
        """The robot from behind, the goal and how far it is."""
        check_begun(self._over, self._title)
        pose, goal, site = self._pose, self._goal, self._site
        view, camera = site.look(pose, math.degrees(site.body.flipper))
        floors = site.site.floor_at(pose.z), site.site.floor_at(goal[2])
        return draw_drive(view, camera, goal, self._time, floors, self._togo)


class DriveVectorEnv(SpreadVectorEnv):
    """Many robots at once, as `gymnasium.make_vec("argo/Drive-v0", num_envs=8)` makes them: each on
    a site of its own. Arguments and options are those of `DriveEnv`, and `processes`."""

    single = DriveEnv
    _title = "argo/Drive-v0"
