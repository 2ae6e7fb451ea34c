"""Robot in a process of its own, whose connection to the service sometimes breaks.

python -m tests.argo_planner.service.fake_robot ADDRESS TOKEN SEED X Y Z YAW
"""

import random
import sys
import time
from contextlib import suppress

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from argo_compiler.base.model import Pose
from tests.argo_env.remote.fakes import FakeRobot


class Link:
    """Link over a WebSocket, which connects again after an interruption."""

    def __init__(self, address: str, token: str, rng: random.Random) -> None:
        self._address, self._token, self._rng = address, token, rng
        self._opened = None

    def end(self, _: int) -> "Link":
        return self

    def send(self, message: str) -> None:
        with suppress(OSError, WebSocketException):
            self._connected().send(message)
            return
        self._opened = None

    def receive(self) -> list[str]:
        texts: list[str] = []
        if self._rng.random() < 0.02:
            self._disconnect()
        with suppress(OSError, WebSocketException):
            while True:
                try:
                    texts.append(self._connected().recv(timeout=0.001))
                except TimeoutError:
                    return texts
        self._opened = None
        return texts

    def _disconnect(self) -> None:
        if self._opened is not None:
            self._opened.socket.close()  # without a closing message
            self._opened = None
            time.sleep(self._rng.uniform(0.0, 0.5))

    def _connected(self):
        if self._opened is None:
            opening = connect(
                f"ws://{self._address}/api/robot/link",
                additional_headers={"authorization": f"Bearer {self._token}"},
                proxy=None,
                ping_interval=None,
            )
            self._opened = opening.__enter__()
        return self._opened


def main() -> None:
    address, token, seed, *pose = sys.argv[1:]
    robot = FakeRobot(Link(address, token, random.Random(int(seed))), time.time)
    x, y, z, yaw = map(float, pose)
    robot.pose = Pose(x=x, y=y, z=z, yaw=yaw)
    while True:
        robot.live()
        time.sleep(0.02)


if __name__ == "__main__":
    main()
