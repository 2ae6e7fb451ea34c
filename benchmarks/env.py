"""Steps per second of Argo's environments beside their peers, in one run.

    python benchmarks/env.py            # everything that is installed
    python benchmarks/env.py route      # or only: route, drive, inspect
    python benchmarks/env.py resets     # memory over 1,000 resets of each environment
    python benchmarks/env.py expert     # how often the expert of Drive-v0 gets to its goal
    python benchmarks/env.py batches    # what spreading a batch over processes gains

Peers that are not installed are named as such. A step is a transition: the steps in which a batch
begins episodes anew are not counted. What is timed is `step` of the
environment without wrappers, called from Python, with random legal actions that are drawn outside
the timing; Jumanji's compiled loops include the drawing. Each
figure is the best of some windows of time, since other work on the machine only ever slows.
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
"""Yields how many transitions were made and how long (s) that took."""


def best(stepper: Stepper, window: float) -> float:
    """Transitions per second in the best window of time."""
    next(stepper)
    rates = []
    for _ in range(WINDOWS):
        count, spent, end = 0, 0.0, time.perf_counter() + window
        while time.perf_counter() < end:
            steps, seconds = next(stepper)
            count, spent = count + steps, spent + seconds
        rates.append(count / spent)
    return max(rates)


def single(env: gym.Env, choose: Callable) -> Stepper:
    """Steps of one Gymnasium environment."""
    observation, _ = env.reset(seed=0)
    while True:
        action = choose(observation)
        begun = time.perf_counter()
        observation, _, terminated, truncated, _ = env.step(action)
        yield 1, time.perf_counter() - begun
        if terminated or truncated:
            observation, _ = env.reset()


def legal(seed: int = 0) -> Callable:
    """Chooses a legal action at random."""
    rng = np.random.default_rng(seed)

    def choose(observation: dict) -> int:
        return int((rng.random(observation["mask"].shape) * observation["mask"]).argmax(-1))

    return choose


def argo_batch(count: int) -> Stepper:
    """Steps of the vector environment."""
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


def rl4co_batch(count: int) -> Stepper:
    """RL4CO's orienteering environment; it is reset when all its episodes have ended."""
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


def jumanji_batch(name: str, count: int) -> Stepper:
    """A Jumanji environment, compiled and mapped over the batch; reset when all have ended."""
    import jax
    import jax.numpy as jnp
    import jumanji

    env = jumanji.make(name)
    key = jax.random.PRNGKey(0)
    one = count == 1
    reset = jax.jit(env.reset if one else jax.vmap(env.reset))
    step = jax.jit(env.step if one else jax.vmap(env.step))

    @jax.jit
    def choose(key, mask):
        drawn = jax.random.uniform(key, mask.shape) * mask
        return jnp.argmax(drawn, axis=-1).astype(jnp.int32)

    state, timestep = reset(key if one else jax.random.split(key, count))
    # Compiled before anything is timed.
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
            state, timestep = reset(key if one else jax.random.split(key, count))


def jumanji_rollout(name: str) -> Stepper:
    """One Jumanji environment with random legal actions in a loop that is compiled as a whole: what
    a policy in JAX may have, without a call from Python for each step. An episode that has ended
    begins anew."""
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


def sampled(env: gym.Env) -> Stepper:
    """Return steps of one Gymnasium environment with actions from all of its action space."""
    env.action_space.seed(0)
    return single(env, lambda _: env.action_space.sample())


def report(
    given: argparse.Namespace,
    name: str,
    stepper: Callable[..., Stepper],
    *arguments: Any,
    needs: str | None = None,
) -> None:
    """Print one figure, or that the peer is not installed."""
    if needs is not None:
        try:
            importlib.import_module(needs)
        except ImportError:
            print(f"{name:48s} not installed", flush=True)
            return
    print(f"{name:48s} {best(stepper(*arguments), given.window):14,.0f} steps/s", flush=True)


def route(given: argparse.Namespace) -> None:
    """Route-v0 beside RL4CO and Jumanji."""
    for count in (1, 64, 1024):
        print(f"-- routes, {NODES} nodes, batch {count}")
        if count == 1:
            env = gym.make("argo/Route-v0", checkpoints=NODES, disable_env_checker=True).unwrapped
            report(given, "argo/Route-v0 (single)", single, env, legal())
        else:
            report(given, "argo/Route-v0 (vector)", argo_batch, count)
        report(given, "RL4CO OP", rl4co_batch, count, needs="rl4co")
        for name in ("TSP-v1", "CVRP-v1"):
            title = f"Jumanji {name}"
            report(given, title, jumanji_batch, name, count, needs="jumanji")
            if count == 1:
                report(given, f"{title}, a compiled loop", jumanji_rollout, name, needs="jumanji")


def peers(given: argparse.Namespace) -> None:
    """The PyBullet environments of others."""

    def panda(name: str) -> Stepper:
        importlib.import_module("panda_gym")
        return sampled(gym.make(name, disable_env_checker=True).unwrapped)

    def drones() -> Stepper:
        from gym_pybullet_drones.envs.HoverAviary import HoverAviary

        return sampled(HoverAviary())

    for name in ("PandaReach-v3", "PandaPickAndPlace-v3"):
        report(given, f"panda-gym {name}", panda, name, needs="panda_gym")
    report(given, "gym-pybullet-drones HoverAviary", drones, needs="gym_pybullet_drones")


def drive(given: argparse.Namespace) -> None:
    """Drive-v0 beside other PyBullet environments."""
    print("-- driving: 24 steps of physics at 240 Hz and 54 rays in each step of Drive-v0")
    env = gym.make("argo/Drive-v0", disable_env_checker=True).unwrapped
    report(given, "argo/Drive-v0", sampled, env)
    peers(given)


def inspect(given: argparse.Namespace) -> None:
    """Inspect-v0, whose step is a whole drive and a measurement."""
    print("-- inspecting: a step is a drive and a measurement, about a minute of simulated time")
    env = gym.make("argo/Inspect-v0", disable_env_checker=True).unwrapped
    for seed in range(4):  # the navigator keeps what it has searched
        env.reset(seed=seed)
    times: list[float] = []

    def timed() -> Stepper:
        for steps, seconds in single(env, legal()):
            times.append(env._run.now)
            yield steps, seconds

    report(given, "argo/Inspect-v0", timed)
    gains = np.diff(times)
    print(f"{'':48s} {np.mean(gains[gains > 0]):14,.0f} s simulated in a step")
    peers(given)


def resets(given: argparse.Namespace) -> None:
    """Print what each environment's memory grows by over many resets."""
    count = given.count or 1000
    for id in ENVIRONMENTS:
        env = gym.make(id, disable_env_checker=True).unwrapped

        def resident() -> float:
            gc.collect()
            return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6

        # Caches of the ways fill up first.
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


def expert(given: argparse.Namespace) -> None:
    """Print how often the expert gets to its goal on UMAD, by where the goal is."""
    made = gym.make("argo/Drive-v0", max_way=given.max_way, disable_env_checker=True)
    env: Any = made.unwrapped
    ways: dict[str, list[tuple[bool, float, float, bool]]] = {}
    begun, steps = time.perf_counter(), 0
    for seed in range(1_000_000, 1_000_000 + (given.count or 16)):
        env.reset(seed=seed)
        rise = env.goal[2] - env.pose.z
        way = "same floor" if abs(rise) < 1.0 else "upwards" if rise > 0 else "downwards"
        driver, total, over, touched = Expert(env), 0.0, False, False
        while not over:
            _, reward, terminated, truncated, info = env.step(driver.act())
            total, over, steps = total + reward, terminated or truncated, steps + 1
            touched = touched or bool(info["touched"])
        ways.setdefault(way, []).append((info["success"], info["time"], total, touched))
        if not info["success"]:
            print(f"seed {seed}: {way}, {info['terms']}, at {env.pose}", flush=True)
    for way, ends in sorted(ways.items()):
        reached, times, returns, touches = zip(*ends, strict=True)
        print(
            f"{way:12s} {sum(reached)} of {len(ends)} reached, {np.mean(times):.0f} s simulated, "
            f"return {np.mean(returns):.1f}, {sum(touches)} with a contact"
        )
    print(f"{steps / (time.perf_counter() - begun):.0f} steps/s")
    env.close()


def batches(given: argparse.Namespace) -> None:
    """Print what spreading a batch over processes gains: steps a second with one and with several.

    The numbers of processes take turns. Each line tells what processor time other work took
    meanwhile: where that is much, there was no free core to gain from. Linux only.
    """
    processes = usable_processors()
    for id, steps in BATCH_STEPS.items():
        ratios = []
        for seed in range(given.rounds):
            one, many = (batch_rate(id, given.count or 8, n, seed, steps) for n in (1, processes))
            ratios.append(many / one)
        print(f"{id}: {median(ratios):.2f} times as many with {processes} processes")


def batch_rate(id: str, count: int, processes: int, seed: int, steps: int) -> float:
    """Return the steps per second of a batch with random legal actions."""
    batch: Any = gym.make_vec(id, count, processes=processes).unwrapped
    rng = np.random.default_rng(seed)
    observation, _ = batch.reset(seed=100 * seed)
    begun, all_before, own_before = time.perf_counter(), used_by_all(), own()
    for _ in range(steps):
        if "mask" in observation:
            mask = observation["mask"]
            actions = (rng.random(mask.shape) * mask).argmax(axis=1)
        else:
            actions = rng.uniform(-1.0, 1.0, batch.action_space.shape).astype(np.float32)
        observation, *_ = batch.step(actions)
    wall = time.perf_counter() - begun
    mine = own() - own_before
    others = max(0.0, used_by_all() - all_before - mine)
    batch.close()
    rate = count * steps / wall
    print(
        f"{id}, {processes} processes: {rate:.1f} steps/s, {wall:.1f} s; CPU {mine:.1f} s, that of "
        f"others {others:.1f} s",
        flush=True,
    )
    return rate


def own() -> float:
    """Return the processor time (s) of this process and its children that are alive."""
    pids = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    stats = [Path(f"/proc/{pid}/stat").read_text() for pid in [str(os.getpid()), *pids]]
    return sum(sum(map(int, stat.rsplit(")", 1)[1].split()[11:13])) for stat in stats) / _TICK


def used_by_all() -> float:
    """Return the processor time (s) of everything on the machine."""
    fields = [int(field) for field in Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return (sum(fields) - fields[3] - fields[4]) / _TICK


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the parts that the command line names."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="part", help=", ".join(PARTS))
    parser.add_argument("--window", type=float, default=1.0, help="s of each window of time")
    parser.add_argument("--count", type=int, help="of resets, episodes or environments of a batch")
    parser.add_argument("--max-way", type=float, default=120.0, help="s that the expert drives")
    parser.add_argument("--rounds", type=int, default=5, help="of batches")
    given = parser.parse_args(arguments)
    for name in given.parts or ("route", "drive", "inspect"):
        if name not in PARTS:
            parser.error(f"no part `{name}`; there are: {', '.join(PARTS)}")
        PARTS[name](given)


PARTS: dict[str, Callable[[argparse.Namespace], None]] = {
    part.__name__: part for part in (route, drive, inspect, resets, expert, batches)
}

if __name__ == "__main__":
    main()
