"""Rollouts of any environment, and digests to compare them by, bit for bit.

As a program it prints the digests of the environments named: what another process sees.
"""

import hashlib
import json
import sys

import gymnasium as gym
import numpy as np


def choose(env, observation, rng):
    """A random action; a legal one, and the last resort 0 only if there is no other, where the
    environment tells which are."""
    if "mask" in observation:
        return int(rng.choice(np.flatnonzero(observation["mask"])[-3:]))
    low, high = env.action_space.low, env.action_space.high
    return rng.uniform(low, high).astype(env.action_space.dtype)


def rollout(env, seed, steps, observation=None):
    """All that `steps` random actions give; from a reset unless there is an observation."""
    rng = np.random.default_rng(seed)
    heard = []
    if observation is None:
        observation, info = env.reset(seed=seed)
        heard.append((observation, info))
    for _ in range(steps):
        observation, *rest = env.step(choose(env, observation, rng))
        heard.append((observation, *rest))
        if rest[1] or rest[2]:
            observation, info = env.reset()
            heard.append((observation, info))
    return heard


def digest(value):
    """A digest of nested data: equal for equal bits only."""
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
    """The digest of a rollout for each id."""
    import argo_env  # noqa: F401

    found = {}
    for id in ids:
        env = gym.make(id).unwrapped
        found[id] = digest(rollout(env, seed, steps))
        env.close()
    return found


if __name__ == "__main__":
    print(json.dumps(digests(sys.argv[3:], int(sys.argv[1]), int(sys.argv[2]))))
