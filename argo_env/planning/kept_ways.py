"""Ways that were planned, kept on disk: the same missions are checked again and again."""

import hashlib
import json
from collections.abc import Callable

import numpy as np

from argo_compiler.analysis import NoWay
from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_env.files.parts import Arrays, Parts
from argo_env.navigation.path import Motion, Path

_PLACES = 1 << 14  # files at most, a few kB each; a new way takes the place of an older one

Way = Path | NoWay


def kept_way(parts: Parts, asked: object, plan: Callable[[], Path]) -> Way:
    """What `plan` gives, or why it gives nothing; from `parts` if the same was `asked` before.

    `asked` is what the way depends on, as data that JSON can say exactly.
    """
    question = json.dumps(asked).encode()
    place = int.from_bytes(hashlib.blake2b(question, digest_size=8).digest()) % _PLACES
    name = f"way-{place:04x}"
    found = parts.find(name)
    if found is not None and found["asked"].tobytes() == question:
        return _to_way(found)
    try:
        way: Way = plan()
    except ArgoError as error:
        way = NoWay(str(error))
    parts.keep(name, {"asked": np.frombuffer(question, np.uint8), **_to_arrays(way)})
    return way


def as_data(pose: Pose) -> tuple[float, float, float, float]:
    """A pose to ask with."""
    return pose.x, pose.y, pose.z, pose.yaw


def _to_arrays(way: Way) -> Arrays:
    if isinstance(way, NoWay):
        return {"reason": np.frombuffer(way.reason.encode(), np.uint8)}
    rows = [(*as_data(m.start), *as_data(m.end), m.turn, m.gear, m.on_stairs) for m in way.motions]
    return {
        "start": np.array(as_data(way.start)),
        "motions": np.array(rows, dtype=np.float64).reshape(len(rows), 11),
    }


def _to_way(arrays: Arrays) -> Way:
    if "reason" in arrays:
        return NoWay(arrays["reason"].tobytes().decode())
    motions = [
        Motion(_pose(row[:4]), _pose(row[4:8]), row[8], int(row[9]), bool(row[10]))
        for row in arrays["motions"].tolist()
    ]
    return Path(_pose(arrays["start"].tolist()), tuple(motions))


def _pose(row: list[float]) -> Pose:
    x, y, z, yaw = row
    return Pose(x=x, y=y, z=z, yaw=yaw)
