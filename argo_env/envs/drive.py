"""`argo/Drive-v0`: drive the tracked robot to a goal, over stairs if necessary."""

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
from argo_env.envs.batch import ProcessVectorEnv
from argo_env.envs.drive_site import MIN_TRAVEL_TIME, DriveOptions, DriveSite, DriveSites
from argo_env.envs.episode import (
    Copyable,
    Rendering,
    StateTypes,
    check_render_mode,
    check_state,
    invalid_state_error,
    require_episode_begun,
    require_episode_under_way,
)
from argo_env.envs.observations import Observation, dict_space
from argo_env.envs.options import (
    MAX_DURATION,
    check_positive,
    check_scenario_is_string,
    options_from_dict,
)
from argo_env.navigation.path import wrap
from argo_env.pictures.drive import draw_drive
from argo_env.robot.pose import BodyPose

Position = tuple[float, float, float]
Start = tuple[float, float, float, float]
Action = tuple[float, float, float]

SPEED = 0.5  # m/s, with action 1
TURN_RATE = 0.6  # rad/s
SUBSTEPS = 24  # of the physics for each action
PERIOD = SUBSTEPS * TIME_STEP  # s: 0.1
GOAL_RADIUS = 0.3  # m from the goal, within which it is reached
MAX_TILT = math.radians(60.0)
PROGRESS, GOAL, TIPPING, CONTACT, TIME = 0.1, 10.0, -10.0, -0.05, -0.01
"""terms of the reward: see the docstring of `DriveEnv`"""
_GOAL_SCALE = (20.0, 20.0, 10.0)  # m, by which the observation divides the goal's x, y and z
_TIME_SCALE = 300.0  # s, by which it divides the travel time to the goal
_STATE: StateTypes = {
    "scenario": str, "options": dict, "start": (tuple, list), "goal": (tuple, list),
    "actions": (tuple, list), "generator": dict,
}  # fmt: skip


class DriveEnv(Copyable, Rendering, gym.Env[Observation, NDArray[np.float32]]):
    """Environment in which a tracked robot drives to a goal, over stairs if necessary.

    ## Description
    A tracked robot of about 60 kg must reach a goal somewhere on a site with several floors. Its
    dynamics are those of the drive `tracked`: rigid bodies at 240 Hz, belts by contact-surface
    motion, real steps. Stairs are climbed backwards and descended forwards, with the flippers
    raised at the first step and flat on the flight.

    ## Observation Space
    A `Dict` of `float32` boxes. The robot's frame is level, with x ahead and y to the left.

    | key | shape | range | meaning |
    |---|---|---|---|
    | `lidar` | (32,) | 0 to 1 | distance to the nearest obstacle in each direction, divided by 5 m: counter-clockwise from straight ahead, in a level plane 0.45 m above the ground |
    | `ground` | (22,) | -1 to 1 | height of the ground (m) relative to the robot's point on the ground, from 1.25 m behind it to 1.25 m ahead, alternately below the right and the left track |
    | `body` | (7,) | -1 to 1 | pitch and roll (divided by 90°), speed (by 1 m/s), turn rate (by 1.2 rad/s), flipper angle (by 50°), speeds of the left and the right belt (by 1 m/s) |
    | `goal` | (4,) | -1 to 1 | goal in the robot's frame (x and y divided by 20 m, z by 10 m), and travel time to it at planning speeds (by 300 s) |
    | `way` | (5,) | -1 to 1 | next point of the planned path in the robot's frame (divided by 1 m), and sine and cosine of the turn to the heading that the path has there |

    Argo's navigator plans the path. With `waypoint=False` the observation does not have `way`, and
    the agent must find a path itself.

    ## Action Space
    `Box(-1, 1, (3,))`, held for 0.1 s. Numbers outside are clipped.

    | | meaning | at -1 | at 1 |
    |---|---|---|---|
    | 0 | speed ahead | -0.5 m/s | 0.5 m/s |
    | 1 | turn rate, counter-clockwise | -0.6 rad/s | 0.6 rad/s |
    | 2 | angle of the flippers, positive with the tips up | -30° | 50° |

    ## Rewards
    The reward is the sum of these terms, which are in `info["terms"]`:

    | term | value |
    |---|---|
    | `progress` | 0.1 for each second by which the navigator's travel time to the goal has decreased |
    | `goal` | 10 when the goal is reached and the robot has not tipped over |
    | `tipped` | -10 when the robot has tipped over or fallen |
    | `contact` | -0.05 for each step in which the robot presses against anything that it must not touch |
    | `time` | -0.01 for each step |

    ## Starting State
    The robot is at rest on level ground with flat flippers and a random heading, at a position where
    it has room to turn. The travel time to the goal at planning speeds is between 5 s and `max_way`,
    or the shortest one above 5 s if no start has such a time.

    ## Episode End
    Terminated when the robot is within 0.3 m of its goal (`info["success"]`), horizontally and
    vertically, or is tilted by more than 60°, or has fallen. Truncated after `time_limit`.

    ## Randomisation
    The start position, the heading and the goal (one of six positions on each floor); with several
    scenarios also the site. By convention, seeds from 1,000,000 on are for tests: train with lower
    ones.

    ## Arguments
    - `scenario` ("umad"): name or file of a site, or `generated:floors=3,seed=7`, or several of them.
    - `max_way` (120): longest travel time (s) to the goal at planning speeds, 5 or more; more than
      about 60 leads to other floors.
    - `time_limit` (300): simulated time (s) after which an episode is truncated.
    - `waypoint` (True): whether the observation has `way`.

    Options of `reset(options=...)` apply until others are given (`{}` removes them):
    - `scenario`, `max_way`: as above.
    - `floor`: number, or list of numbers, of the floors for start and goal.
    - `faults`: list as in a file of faults, of the kinds `brick`, `missing_plate`, `blocked_stairs`
      and `drive_dysfunction`. What a fault leaves open is drawn with its own `seed` (0 if it has
      none), so that the site stays the same from episode to episode.

    A reset restores the physics to a saved state; the site is built again only for other scenarios
    or faults. `get_state()` returns a state from which `set_state(state)` continues, with the same
    random generator. `set_state` repeats the actions since the reset, as PyBullet's own states do
    not continue bit for bit while the robot touches the ground.

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
        """Create the environment; the docstring of the class describes the arguments.

        Raises ArgoError if an argument is invalid, or if there is no such scenario or render mode.
        """
        check_render_mode(render_mode, self.metadata["render_modes"])
        names = tuple(scenario) if isinstance(scenario, tuple | list) else (scenario,)
        for name in names:
            check_scenario_is_string(self._title, name)
        check_positive(self._title, MAX_DURATION, time_limit=time_limit, max_way=max_way)
        if max_way < MIN_TRAVEL_TIME:
            raise Invalid(
                f"{self._title}: `max_way` is {max_way:g}, and has to be at least "
                f"{MIN_TRAVEL_TIME:g} (s)"
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
        self._site = self._sites.get_site(self._sites.requested_site_names[0])
        self._over: bool | None = None

    # -- the environment

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        if options is not None:
            self._sites.apply_options(options_from_dict(DriveOptions, options, self._title))
        # There is no episode until the new one has begun.
        self._over = None
        rng, chosen = self.np_random, self._sites.options
        names = self._sites.requested_site_names
        name = names[int(rng.integers(len(names)))]
        guide = self._sites.get_site(name).guide
        floors = chosen.given_floors or guide.floors
        goals = guide.goal_positions(floors)
        x, y, z = goals[int(rng.integers(len(goals)))].tolist()
        goal = (x, y, z)
        longest = chosen.max_way or self._max_way
        starts = guide.start_positions_or_nearest(goal, floors, MIN_TRAVEL_TIME, longest)
        x, y, z = starts[int(rng.integers(len(starts)))].tolist()
        self._start_episode(name, (x, y, z, float(rng.uniform(-math.pi, math.pi))), goal)
        observation = self._observe()
        self._over = False
        self._update_window()
        return observation, {"goal": self._goal, "scenario": self._site.site.name}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        require_episode_under_way(self._over, self._title)
        body = self._site.body
        self._apply_action(self._parse_action(action))
        before = self._time_to_goal
        observation = self._observe()
        success, tipped = self._success, self._tipped
        touches = body.pop_deepest_touches()
        terms = {
            "progress": PROGRESS * (before - self._time_to_goal),
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
        self._update_window()
        return observation, math.fsum(terms.values()), terminated, truncated, info

    def close(self) -> None:
        self._sites.close()
        self._over = None
        super().close()

    @property
    def pose(self) -> BodyPose:
        """True pose of the robot."""
        require_episode_begun(self._over, self._title)
        return self._pose

    @property
    def goal(self) -> Position:
        """Position (x, y, z in m) of this episode's goal."""
        require_episode_begun(self._over, self._title)
        return self._goal

    @property
    def site(self) -> DriveSite:
        """Site of this episode, with its navigator and the robot's body."""
        return self._site

    # -- states

    def get_state(self) -> dict[str, Any]:
        """Return the state of the episode, from which `set_state` continues.

        It is plain data that can be pickled.
        """
        require_episode_begun(self._over, self._title)
        return {
            "scenario": self._name,
            "options": self._sites.options.model_dump(mode="json", exclude_unset=True),
            "start": self._start,
            "goal": self._goal,
            "actions": tuple(self._actions),
            "generator": self.np_random.bit_generator.state,
        }

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Continue from a state that `get_state` returned, and return its observation.

        Raises ArgoError if it is not a state of this environment.
        """
        check_state(state, _STATE, self._title)
        if len(state["start"]) != 4 or len(state["goal"]) != 3:
            raise invalid_state_error(self._title)
        actions = [self._parse_action(action) for action in state["actions"]]
        self._sites.apply_options(options_from_dict(DriveOptions, state["options"], self._title))
        self._over = None
        self._start_episode(state["scenario"], state["start"], state["goal"])
        for action in actions:
            self._apply_action(action)
        self._site.body.pop_deepest_touches()
        self.np_random.bit_generator.state = state["generator"]
        observation = self._observe()
        self._over = self._success or self._tipped or len(self._actions) >= self._limit
        return observation

    def _state_for_copy(self) -> tuple[DriveOptions, dict[str, Any] | None]:
        return self._sites.options, None if self._over is None else self.get_state()

    def _restore_copy(self, state: tuple[DriveOptions, dict[str, Any] | None]) -> None:
        options, episode = state
        if episode is not None:
            self.set_state(episode)
        elif options != self._sites.options:
            self._sites.apply_options(options)

    # -- inside

    @property
    def _time(self) -> float:
        return len(self._actions) * PERIOD

    def _start_episode(self, name: str, start: Start, goal: Position) -> None:
        """Place the robot at its start (x, y, z, yaw) on the site of this scenario."""
        self._name, self._start, self._goal = name, start, goal
        self._site = self._sites.get_site(name)
        self._site.body.reset(BodyPose(*start))
        self._site.body.pop_deepest_touches()
        self._site.forget_camera_position()
        self._actions: list[Action] = []

    def _parse_action(self, action: Any) -> Action:
        """Return the action, clipped to -1 and 1; raise ArgoError if it is not an action."""
        try:
            values = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError):
            values = np.empty(0)
        if values.shape != (3,) or not np.isfinite(values).all():
            raise Invalid(
                f"{self._title}: the action is {action!r}, and has to be three numbers from -1 to 1"
            )
        ahead, turn, flipper = np.clip(values, -1.0, 1.0).tolist()
        return ahead, turn, flipper

    @property
    def _success(self) -> bool:
        """True if the robot was at its goal at the last observation."""
        pose, (x, y, z) = self._pose, self._goal
        return math.hypot(pose.x - x, pose.y - y) <= GOAL_RADIUS and abs(pose.z - z) <= GOAL_RADIUS

    @property
    def _tipped(self) -> bool:
        """True if the robot had tipped over or fallen at the last observation."""
        pose, site = self._pose, self._site
        upright = math.cos(pose.pitch) * math.cos(site.body.roll)
        return upright < math.cos(MAX_TILT) or pose.z < site.site.spec.ground_z - 1.0

    def _apply_action(self, action: Action) -> None:
        """Apply an action for 0.1 s."""
        ahead, turn, flipper = action
        body, share = self._site.body, self._site.speed_factor_from_faults(self._time)
        low, high = FLIPPER_LIMITS
        body.command(
            share * SPEED * ahead, share * TURN_RATE * turn, low + (flipper + 1) / 2 * (high - low)
        )
        body.advance(SUBSTEPS)
        self._actions.append(action)

    def _observe(self) -> Observation:
        site, body = self._site, self._site.body
        self._pose = pose = body.pose
        waypoint = site.guide.next_waypoint(self._goal, pose)
        self._time_to_goal = waypoint.seconds
        speed, turn = body.velocity
        left, right = body.belt_speeds
        goal = self._to_robot_frame(*self._goal)
        observation = {
            "lidar": lidar.ray_distances(site.world, pose) / lidar.RANGE,
            "ground": lidar.relative_heights_along_tracks(site.world, pose) / lidar.DEPTH,
            "body": (
                pose.pitch / (math.pi / 2), body.roll / (math.pi / 2), speed, turn / 1.2,
                body.flipper / FLIPPER_LIMITS[1], left, right,
            ),
            "goal": (
                *(v / scale for v, scale in zip(goal, _GOAL_SCALE, strict=True)),
                self._time_to_goal / _TIME_SCALE,
            ),
        }  # fmt: skip
        if self._waypoint:
            turn = wrap(waypoint.yaw - pose.yaw)
            point = self._to_robot_frame(waypoint.x, waypoint.y, waypoint.z)
            observation["way"] = (*point, math.sin(turn), math.cos(turn))
        return {
            name: np.clip(np.array(values), -1.0, 1.0).astype(np.float32)
            for name, values in observation.items()
        }

    def _to_robot_frame(self, x: float, y: float, z: float) -> tuple[float, float, float]:
        """Return a position of the site in the robot's level frame: ahead, to the left, up (m)."""
        pose = self._pose
        dx, dy = x - pose.x, y - pose.y
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        return cos * dx + sin * dy, cos * dy - sin * dx, z - pose.z

    def _draw_picture(self) -> NDArray[np.uint8]:
        """Return a picture of the robot from behind, with the goal and the travel time to it."""
        require_episode_begun(self._over, self._title)
        pose, goal, site = self._pose, self._goal, self._site
        view, camera = site.render_from_behind(pose, math.degrees(site.body.flipper))
        floors = site.site.floor_at(pose.z), site.site.floor_at(goal[2])
        return draw_drive(view, camera, goal, self._time, floors, self._time_to_goal)


class DriveVectorEnv(ProcessVectorEnv):
    """Vector environment of many robots, each on a site of its own.

    `gymnasium.make_vec("argo/Drive-v0", num_envs=8)` makes one. Arguments and options are those of
    `DriveEnv`, and `processes`.
    """

    env_class = DriveEnv
    _title = "argo/Drive-v0"
