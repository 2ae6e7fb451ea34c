"""Rollouts of any environment, and digests to compare them bit for bit.

As a program, it prints the digests of the given environments, to compare them with another process.
"""

import hashlib
import json
import sys

import gymnasium as gym
import numpy as np


def choose(env, observation, rng):
    """Return a random action; if there is a mask, one of the last three legal ones.

    So action 0 is chosen only if there are at most two others.
    """
    if "mask" in observation:
        return int(rng.choice(np.flatnonzero(observation["mask"])[-3:]))
    low, high = env.action_space.low, env.action_space.high
    return rng.uniform(low, high).astype(env.action_space.dtype)


def rollout(env, seed, steps, observation=None):
    """Return the outcomes of `steps` random actions, after a reset if there is no observation."""
    rng = np.random.default_rng(seed)
    outcomes = []
    if observation is None:
        observation, info = env.reset(seed=seed)
        outcomes.append((observation, info))
    for _ in range(steps):
        observation, *rest = env.step(choose(env, observation, rng))
        outcomes.append((observation, *rest))
        if rest[1] or rest[2]:
            observation, info = env.reset()
            outcomes.append((observation, info))
    return outcomes


def digest(value):
    """Return a digest of nested data, which is equal for equal bits only."""
    sink = hashlib.sha256()
    _feed(sink, value)
    return sink.hexdigest()


def _feed(sink, value):
    if isinstance(value, dict):
        for key in sorted(value):
            sink.update(f"<{key}>".encode())
            _feed(sink, value[key])
    elif isinstance(value, list | tuple):
        sink.update(f"[{len(value)}]".encode())
        for part in value:
            _feed(sink, part)
    elif isinstance(value, np.ndarray):
        sink.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
    else:
        sink.update(f"{type(value).__name__}{value!r}".encode())


def digests(ids, seed, steps):
    """Return the digest of a rollout for each id."""
    import argo_env  # noqa: F401

    results = {}
    for id in ids:
        env = gym.make(id).unwrapped
        results[id] = digest(rollout(env, seed, steps))
        env.close()
    return results


if __name__ == "__main__":
    print(json.dumps(digests(sys.argv[3:], int(sys.argv[1]), int(sys.argv[2]))))
