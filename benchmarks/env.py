"""Steps per second of Argo's environments and of other libraries' ones.

    python benchmarks/env.py            # route, drive and inspect
    python benchmarks/env.py route      # only one of them
    python benchmarks/env.py resets     # memory over 1,000 resets of each environment
    python benchmarks/env.py expert     # how often the expert of Drive-v0 reaches its goal
    python benchmarks/env.py batches    # speed-up of a batch by several processes

Libraries that are not installed are named. A step is a transition; steps in which a batch resets an
ended episode are not counted. The time is that of the environment's `step` without wrappers, called
from Python, with random legal actions that are drawn outside the timing; in Jumanji's compiled
loops it includes drawing them. Each figure is the best of some windows of time, as other load on
the machine only makes it slower.
"""

import argparse
import gc
import importlib
import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np

import argo_env  # noqa: F401
from argo_env.envs import ENVIRONMENTS
from argo_env.envs.expert import Expert
from argo_env.worker_processes import usable_processors

WINDOWS = 5
NODES = 20
BATCH_STEPS = {"argo/Drive-v0": 100, "argo/Inspect-v0": 25}
_TICK = os.sysconf("SC_CLK_TCK")
Stepper = Iterator[tuple[int, float]]
"""Iterator that steps environments, and yields the number of steps and their time (s)."""


def best_rate(stepper: Stepper, window: float) -> float:
    """Return the steps per second in the fastest of WINDOWS periods of `window` s each."""
    next(stepper)
    rates = []
    for _ in range(WINDOWS):
        count, spent, end = 0, 0.0, time.perf_counter() + window
        while time.perf_counter() < end:
            steps, seconds = next(stepper)
            count, spent = count + steps, spent + seconds
        rates.append(count / spent)
    return max(rates)


def step_environment(env: gym.Env, choose: Callable) -> Stepper:
    """Yield 1 and the time (s) of each step of an environment.

    `choose` returns an action for an observation. Ended episodes are reset outside the timing.
    """
    observation, _ = env.reset(seed=0)
    while True:
        action = choose(observation)
        begun = time.perf_counter()
        observation, _, terminated, truncated, _ = env.step(action)
        yield 1, time.perf_counter() - begun
        if terminated or truncated:
            observation, _ = env.reset()


def make_random_policy(seed: int = 0) -> Callable:
    """Return a policy that draws a legal action from an observation's mask."""
    rng = np.random.default_rng(seed)

    def choose(observation: dict) -> int:
        return int((rng.random(observation["mask"].shape) * observation["mask"]).argmax(-1))

    return choose


def step_argo_batch(count: int) -> Stepper:
    """Yield the number and the time (s) of the steps of a batch of `count` episodes of Route-v0.

    Each call of `step` gives one pair, whose number is `count` less the episodes that it resets.
    """
    env = gym.make_vec(
        "argo/Route-v0",
        num_envs=count,
        vectorization_mode="vector_entry_point",
        checkpoints=NODES,
    ).unwrapped
    rng = np.random.default_rng(0)
    observation, _ = env.reset(seed=0)
    ended = np.zeros(count, bool)
    while True:
        mask = observation["mask"]
        actions = (rng.random(mask.shape, dtype=np.float32) * mask).argmax(axis=1)
        begun = time.perf_counter()
        observation, _, terminated, _, _ = env.step(actions)
        spent = time.perf_counter() - begun
        yield count - int(ended.sum()), spent
        ended = terminated


def step_rl4co_batch(count: int) -> Stepper:
    """Yield the number of running episodes and the time (s) of each step of a batch in RL4CO.

    The environment is that of orienteering; the batch is reset when all its episodes have ended.
    """
    import torch
    from rl4co.envs import OPEnv

    torch.set_num_threads(1)
    env = OPEnv(generator_params={"num_loc": NODES})
    state = env.reset(batch_size=[count])
    while True:
        mask = state["action_mask"]
        state.set("action", (torch.rand(mask.shape) * mask).argmax(-1))
        alive = int((~state["done"].reshape(-1)).sum())
        begun = time.perf_counter()
        state = env.step(state)["next"]
        spent = time.perf_counter() - begun
        yield alive, spent
        if bool(state["done"].all()):
            state = env.reset(batch_size=[count])


def step_jumanji_batch(name: str, count: int) -> Stepper:
    """Yield the number of running episodes and the time (s) of each step of a batch in Jumanji.

    The environment `name` is compiled and mapped over the batch, which is reset when all its
    episodes have ended.
    """
    import jax
    import jax.numpy as jnp
    import jumanji

    env = jumanji.make(name)
    key = jax.random.PRNGKey(0)
    is_single = count == 1
    reset = jax.jit(env.reset if is_single else jax.vmap(env.reset))
    step = jax.jit(env.step if is_single else jax.vmap(env.step))

    @jax.jit
    def choose(key, mask):
        drawn = jax.random.uniform(key, mask.shape) * mask
        return jnp.argmax(drawn, axis=-1).astype(jnp.int32)

    state, timestep = reset(key if is_single else jax.random.split(key, count))
    # This compiles both before the timing.
    jax.block_until_ready(step(state, choose(key, timestep.observation.action_mask)))
    while True:
        key, drawn = jax.random.split(key)
        actions = jax.block_until_ready(choose(drawn, timestep.observation.action_mask))
        alive = int((~timestep.last()).sum())
        begun = time.perf_counter()
        state, timestep = step(state, actions)
        jax.block_until_ready((state, timestep))
        yield alive, time.perf_counter() - begun
        if bool(timestep.last().all()):
            state, timestep = reset(key if is_single else jax.random.split(key, count))


def step_jumanji_loop(name: str) -> Stepper:
    """Yield the number and the time (s) of steps of one Jumanji environment in a compiled loop.

    Each loop of 1,000 random legal actions gives one pair. A policy in JAX may run like this,
    without a call from Python for each step. Ended episodes are reset.
    """
    import jax
    import jax.numpy as jnp
    import jumanji

    env, length = jumanji.make(name), 1000

    def move(carry, key):
        state, timestep = carry
        drawing, beginning = jax.random.split(key)
        mask = timestep.observation.action_mask
        action = jnp.argmax(jax.random.uniform(drawing, mask.shape) * mask).astype(jnp.int32)
        following = jax.lax.cond(
            timestep.last(), lambda: env.reset(beginning), lambda: env.step(state, action)
        )
        return following, ~timestep.last()

    @jax.jit
    def roll(carry, key):
        carry, moved = jax.lax.scan(move, carry, jax.random.split(key, length))
        return carry, moved.sum()

    key = jax.random.PRNGKey(0)
    carry = env.reset(key)
    jax.block_until_ready(roll(carry, key))
    while True:
        key, drawn = jax.random.split(key)
        begun = time.perf_counter()
        carry, moved = jax.block_until_ready(roll(carry, drawn))
        yield int(moved), time.perf_counter() - begun


def step_with_samples(env: gym.Env) -> Stepper:
    """Yield 1 and the time (s) of each step with actions drawn from the action space."""
    env.action_space.seed(0)
    return step_environment(env, lambda _: env.action_space.sample())


def print_rate(
    options: argparse.Namespace,
    name: str,
    stepper: Callable[..., Stepper],
    *arguments: Any,
    needs: str | None = None,
) -> None:
    """Print the steps per second of a stepper, or that the library it needs is not installed."""
    if needs is not None:
        try:
            importlib.import_module(needs)
        except ImportError:
            print(f"{name:48s} not installed", flush=True)
            return
    print(f"{name:48s} {best_rate(stepper(*arguments), options.window):14,.0f} steps/s", flush=True)


def measure_route(options: argparse.Namespace) -> None:
    """Print the steps per second of Route-v0, RL4CO and Jumanji."""
    for count in (1, 64, 1024):
        print(f"-- routes, {NODES} nodes, batch {count}")
        if count == 1:
            env = gym.make("argo/Route-v0", checkpoints=NODES, disable_env_checker=True).unwrapped
            print_rate(
                options, "argo/Route-v0 (single)", step_environment, env, make_random_policy()
            )
        else:
            print_rate(options, "argo/Route-v0 (vector)", step_argo_batch, count)
        print_rate(options, "RL4CO OP", step_rl4co_batch, count, needs="rl4co")
        for name in ("TSP-v1", "CVRP-v1"):
            title = f"Jumanji {name}"
            print_rate(options, title, step_jumanji_batch, name, count, needs="jumanji")
            if count == 1:
                print_rate(
                    options, f"{title}, a compiled loop", step_jumanji_loop, name, needs="jumanji"
                )


def measure_pybullet_peers(options: argparse.Namespace) -> None:
    """Print the steps per second of other libraries' PyBullet environments."""

    def panda(name: str) -> Stepper:
        importlib.import_module("panda_gym")
        return step_with_samples(gym.make(name, disable_env_checker=True).unwrapped)

    def drones() -> Stepper:
        from gym_pybullet_drones.envs.HoverAviary import HoverAviary

        return step_with_samples(HoverAviary())

    for name in ("PandaReach-v3", "PandaPickAndPlace-v3"):
        print_rate(options, f"panda-gym {name}", panda, name, needs="panda_gym")
    print_rate(options, "gym-pybullet-drones HoverAviary", drones, needs="gym_pybullet_drones")


def measure_drive(options: argparse.Namespace) -> None:
    """Print the steps per second of Drive-v0 and other PyBullet environments."""
    print("-- driving: 24 steps of physics at 240 Hz and 54 rays in each step of Drive-v0")
    env = gym.make("argo/Drive-v0", disable_env_checker=True).unwrapped
    print_rate(options, "argo/Drive-v0", step_with_samples, env)
    measure_pybullet_peers(options)


def measure_inspect(options: argparse.Namespace) -> None:
    """Print the steps per second of Inspect-v0, whose step is a whole drive and a measurement."""
    print("-- inspecting: a step is a drive and a measurement, about a minute of simulated time")
    env = gym.make("argo/Inspect-v0", disable_env_checker=True).unwrapped
    for seed in range(4):  # the navigator caches its searches
        env.reset(seed=seed)
    times: list[float] = []

    def timed() -> Stepper:
        for steps, seconds in step_environment(env, make_random_policy()):
            times.append(env._run.now)
            yield steps, seconds

    print_rate(options, "argo/Inspect-v0", timed)
    differences = np.diff(times)
    print(f"{'':48s} {np.mean(differences[differences > 0]):14,.0f} s simulated in a step")
    measure_pybullet_peers(options)


def measure_memory_over_resets(options: argparse.Namespace) -> None:
    """Print the growth of memory over many resets of each environment."""
    count = options.count or 1000
    for id in ENVIRONMENTS:
        env = gym.make(id, disable_env_checker=True).unwrapped

        def resident() -> float:
            gc.collect()
            return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6

        # The caches of paths fill up first.
        for seed in range(min(150, count)):
            env.reset(seed=seed)
        before, begun = resident(), time.perf_counter()
        for _ in range(count):
            env.reset()
        spent = time.perf_counter() - begun
        print(
            f"{id:20s} {count} resets: {resident() - before:+.1f} MB of {before:.0f} MB, "
            f"{1e3 * spent / count:.2f} ms each",
            flush=True,
        )
        env.close()


def measure_expert_success(options: argparse.Namespace) -> None:
    """Print how often the expert reaches goals on the site UMAD: on the same floor, up and down."""
    wrapped = gym.make("argo/Drive-v0", max_way=options.max_way, disable_env_checker=True)
    env: Any = wrapped.unwrapped
    results: dict[str, list[tuple[bool, float, float, bool]]] = {}
    begun, steps = time.perf_counter(), 0
    for seed in range(1_000_000, 1_000_000 + (options.count or 16)):
        env.reset(seed=seed)
        rise = env.goal[2] - env.pose.z
        direction = "same floor" if abs(rise) < 1.0 else "upwards" if rise > 0 else "downwards"
        driver, total, over, touched = Expert(env), 0.0, False, False
        while not over:
            _, reward, terminated, truncated, info = env.step(driver.act())
            total, over, steps = total + reward, terminated or truncated, steps + 1
            touched = touched or bool(info["touched"])
        results.setdefault(direction, []).append((info["success"], info["time"], total, touched))
        if not info["success"]:
            print(f"seed {seed}: {direction}, {info['terms']}, at {env.pose}", flush=True)
    for direction, ends in sorted(results.items()):
        reached, times, returns, touches = zip(*ends, strict=True)
        print(
            f"{direction:12s} {sum(reached)} of {len(ends)} reached, {np.mean(times):.0f} s "
            f"simulated, return {np.mean(returns):.1f}, {sum(touches)} with a contact"
        )
    print(f"{steps / (time.perf_counter() - begun):.0f} steps/s")
    env.close()


def measure_process_speedup(options: argparse.Namespace) -> None:
    """Print the speed-up of a batch by several processes, relative to one.

    One and several processes alternate. Each line states the processor time of other load in the
    meantime: if that is much, no core was free. Linux only.
    """
    processes = usable_processors()
    for id, steps in BATCH_STEPS.items():
        ratios = []
        for seed in range(options.rounds):
            one, many = (
                print_batch_rate(id, options.count or 8, n, seed, steps) for n in (1, processes)
            )
            ratios.append(many / one)
        print(f"{id}: {median(ratios):.2f} times as many with {processes} processes")


def print_batch_rate(id: str, count: int, processes: int, seed: int, steps: int) -> float:
    """Step a batch `steps` times with random legal actions; print and return steps per second."""
    batch: Any = gym.make_vec(id, count, processes=processes).unwrapped
    rng = np.random.default_rng(seed)
    observation, _ = batch.reset(seed=100 * seed)
    begun, all_before, own_before = (
        time.perf_counter(),
        machine_processor_time(),
        own_and_children_processor_time(),
    )
    for _ in range(steps):
        if "mask" in observation:
            mask = observation["mask"]
            actions = (rng.random(mask.shape) * mask).argmax(axis=1)
        else:
            actions = rng.uniform(-1.0, 1.0, batch.action_space.shape).astype(np.float32)
        observation, *_ = batch.step(actions)
    wall = time.perf_counter() - begun
    own = own_and_children_processor_time() - own_before
    others = max(0.0, machine_processor_time() - all_before - own)
    batch.close()
    rate = count * steps / wall
    print(
        f"{id}, {processes} processes: {rate:.1f} steps/s, {wall:.1f} s; CPU {own:.1f} s, that of "
        f"others {others:.1f} s",
        flush=True,
    )
    return rate


def own_and_children_processor_time() -> float:
    """Return the processor time (s) of this process and its living children."""
    pids = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    stats = [Path(f"/proc/{pid}/stat").read_text() for pid in [str(os.getpid()), *pids]]
    return sum(sum(map(int, stat.rsplit(")", 1)[1].split()[11:13])) for stat in stats) / _TICK


def machine_processor_time() -> float:
    """Return the processor time (s) of all processes on the machine."""
    fields = [int(field) for field in Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return (sum(fields) - fields[3] - fields[4]) / _TICK


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the parts of the benchmark in the arguments, or route, drive and inspect if none is."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="part", help=", ".join(PARTS))
    parser.add_argument("--window", type=float, default=1.0, help="seconds of each window of time")
    parser.add_argument(
        "--count", type=int, help="number of resets, of episodes, or of environments of a batch"
    )
    parser.add_argument(
        "--max-way", type=float, default=120.0, help="longest path of the expert in seconds"
    )
    parser.add_argument(
        "--rounds", type=int, default=5, help="comparisons of one and several processes"
    )
    options = parser.parse_args(arguments)
    for name in options.parts or ("route", "drive", "inspect"):
        if name not in PARTS:
            parser.error(f"there is no part `{name}`; choose from: {', '.join(PARTS)}")
        PARTS[name](options)


PARTS: dict[str, Callable[[argparse.Namespace], None]] = {
    "route": measure_route,
    "drive": measure_drive,
    "inspect": measure_inspect,
    "resets": measure_memory_over_resets,
    "expert": measure_expert_success,
    "batches": measure_process_speedup,
}

if __name__ == "__main__":
    main()
