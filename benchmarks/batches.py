"""What spreading a batch over processes gains: steps per second with one process and with several.

    python -m benchmarks.batches                       # both, 8 environments, all cores
    python -m benchmarks.batches argo/Drive-v0 --rounds 6

The numbers of processes take turns. Each line tells what processor time other work took meanwhile:
where that is much, there was no free core to gain from, and the round says little. Linux only.
"""

import argparse
import os
import time
from pathlib import Path
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np

import argo_env  # noqa: F401
from argo_env.envs.workers import core_count

STEPS = {"argo/Drive-v0": 100, "argo/Inspect-v0": 25}
_TICK = os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Prints a line for each measurement, and the median of the ratios."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("ids", nargs="*", metavar="id", help=", ".join(STEPS))
    parser.add_argument("--envs", type=int, default=8)
    parser.add_argument("--processes", type=int, default=core_count())
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    for id in options.ids or STEPS:
        ratios = []
        for seed in range(options.rounds):
            one, many = (measure(id, options.envs, n, seed) for n in (1, options.processes))
            ratios.append(many / one)
        print(f"{id}: {median(ratios):.2f} times as many with {options.processes} processes")


def measure(id: str, count: int, processes: int, seed: int) -> float:
    """Steps per second of a batch with random legal actions."""
    batch: Any = gym.make_vec(id, count, processes=processes).unwrapped
    rng = np.random.default_rng(seed)
    observation, _ = batch.reset(seed=100 * seed)
    begun, all_before, own_before = time.perf_counter(), used_by_all(), own()
    for _ in range(STEPS[id]):
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
    rate = count * STEPS[id] / wall
    print(
        f"{id}, {processes} processes: {rate:.1f} steps/s, {wall:.1f} s; CPU {mine:.1f} s, that of "
        f"others {others:.1f} s",
        flush=True,
    )
    return rate


def own() -> float:
    """Processor time (s) of this process and its children that are alive."""
    pids = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    stats = [Path(f"/proc/{pid}/stat").read_text() for pid in [str(os.getpid()), *pids]]
    return sum(sum(map(int, stat.rsplit(")", 1)[1].split()[11:13])) for stat in stats) / _TICK


def used_by_all() -> float:
    """Processor time (s) of everything on the machine."""
    fields = [int(field) for field in Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return (sum(fields) - fields[3] - fields[4]) / _TICK


if __name__ == "__main__":
    main()
