"""Whether runs and episodes come out byte for byte as with the code of another checkout.

    git worktree add ../before COMMIT
    python -m benchmarks.same_results ../before               # route, kinematic, tracked, drive
    python -m benchmarks.same_results ../before kinematic     # or only some of them

`route`, `kinematic` and `tracked` run the shipped missions and each shipped file of faults with the
drive of that name, and compare the records; `drive` takes random actions in Drive-v0, and compares
all that it returns, and its states. Each checkout computes in a process of its own, which prints a
digest of each result; what differs is named, and the command then fails.
"""

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
UMAD = ROOT / "scenarios" / "umad"
GROUPS = ("route", "kinematic", "tracked", "drive")
SEEDS = {"route": 4, "kinematic": 4, "tracked": 1}


def records(drive: str) -> Iterator[tuple[str, bytes]]:
    """The name of each run with a drive, and its record."""
    from argo_compiler.hfsm import Resume
    from argo_env.faults.reading import read_faults
    from argo_env.planning import open_site
    from argo_env.run.session import simulate
    from argo_env.run.spec import RunSpec, logged
    from argo_planner.use_cases.importing import Upload, import_mission

    site = open_site("umad").prepare()

    def mission(path: Path, *areas: int):
        return import_mission(Upload(path.name, path.read_bytes()), site, *areas).mission

    missions = UMAD / "missions"
    first = mission(missions / "mission_1.txt", 1, 2)
    cases = [("mission_1", first, (), "ideal"), ("mission_1", first, (), "camera")]
    cases.append(("protocol_3", mission(missions / "protocol_3.txt"), (), "ideal"))
    folder = UMAD / "faults"
    on_ground, upstairs = mission(folder / "ground.txt"), mission(folder / "upstairs.txt")
    for path in sorted(folder.glob("*.yaml")):
        faults = read_faults(path)
        cases.append((f"ground, {path.stem}", on_ground, faults, "ideal"))
        cases.append((f"upstairs, {path.stem}", upstairs, faults, "ideal"))
    for name, asked, faults, sensor in cases:
        if drive == "route" and (sensor != "ideal" or any(f.needs_world for f in faults)):
            continue
        for seed in range(SEEDS[drive]):
            spec = RunSpec(
                mission=asked,
                drive=drive,
                sensor=sensor,
                seed=seed,
                faults=faults,
                events=logged((300.0, Resume())),
            )
            record = simulate(spec, site)
            said = f"{len(record.contacts)} contacts, {len(record.anomalies)} anomalies"
            yield (
                f"{drive}: {name}, {sensor}, seed {seed}: {said}",
                record.model_dump_json().encode(),
            )


def episodes() -> Iterator[tuple[str, bytes]]:
    """The name of each episode of Drive-v0, and all that it returned."""
    import gymnasium as gym
    import numpy as np

    import argo_env  # noqa: F401

    env = gym.make("argo/Drive-v0", disable_env_checker=True).unwrapped
    faults = [{"kind": "brick"}, {"kind": "missing_plate"}]
    for seed in range(8):
        observation, info = env.reset(
            seed=seed, options={"faults": faults} if seed % 4 == 3 else {}
        )
        told: list[object] = [observation, info]
        rng = np.random.default_rng(seed)
        lean = rng.uniform(-1.0, 1.0, 3)
        for _ in range(250):
            action = np.clip(lean + rng.uniform(-0.5, 0.5, 3), -1.0, 1.0).astype(np.float32)
            *returned, terminated, truncated, info = env.step(action)
            told += [*returned, terminated, truncated, info, env.pose, env.site.body.velocity]
            if terminated or truncated:
                break
        told.append(env.get_state())
        told.append(env.set_state(env.get_state()))
        with np.printoptions(floatmode="unique", threshold=sys.maxsize):
            yield f"drive: seed {seed}, {len(told)} values", repr(told).encode()


def digests(groups: list[str]) -> None:
    """Prints a line for each result: its digest, and its name."""
    for group in groups:
        for name, content in episodes() if group == "drive" else records(group):
            print(hashlib.sha256(content).hexdigest()[:16], name, flush=True)


def asked(root: Path, groups: list[str], cache: str) -> list[str]:
    """The lines of the digests with the code of a checkout; they are shown as they come."""
    environment = os.environ | {"PYTHONPATH": str(root), "ARGO_CACHE_DIR": cache}
    command = (sys.executable, __file__, "--digests", *groups)
    lines = []
    with subprocess.Popen(
        command, cwd=root, env=environment, stdout=subprocess.PIPE, text=True
    ) as p:
        assert p.stdout
        for line in p.stdout:
            lines.append(line.strip())
            print(lines[-1], flush=True)
    if p.returncode:
        raise SystemExit(f"the process with the code of {root} has failed")
    return lines


def main() -> None:
    """Names what differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path, help="folder with the code to compare with")
    parser.add_argument("groups", nargs="*", metavar="group", help=", ".join(GROUPS))
    options = parser.parse_args()
    groups = options.groups or list(GROUPS)
    if unknown := set(groups) - set(GROUPS):
        parser.error(f"there is no {sorted(unknown)[0]}; there are: {', '.join(GROUPS)}")
    before = options.checkout.resolve()
    with tempfile.TemporaryDirectory() as old, tempfile.TemporaryDirectory() as new:
        different = [
            f"before {a}\n today {b}"
            for a, b in zip(asked(before, groups, old), asked(ROOT, groups, new), strict=True)
            if a != b
        ]
    print("\n".join(different) or "all are the same")
    raise SystemExit(bool(different))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--digests"]:
        digests(sys.argv[2:])
    else:
        main()
