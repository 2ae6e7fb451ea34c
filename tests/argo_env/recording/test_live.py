"""A run live in Foxglove: what a recording has, for who looks on, and nothing from them."""

import json
import struct
from contextlib import ExitStack, contextmanager

import pytest
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from websockets.sync.client import connect

from argo_compiler.base.errors import Unavailable
from argo_env.recording.live import served_live
from argo_env.recording.run_recorder import RunRecorder
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from tests.yard import measure, mission, simulation_of, waypoint

SPEC = RunSpec(
    mission=mission(measure(1), waypoint("A", 4.05, 2.05), measure(2)), site="yard", drive="route"
)


@contextmanager
def looking(port: int, **options):
    usual = {"subprotocols": ["foxglove.sdk.v1"], "max_size": None, "proxy": None}
    with connect(f"ws://127.0.0.1:{port}", **usual, **options) as socket:
        yield socket


class Viewer:
    """Looks at all topics, as Foxglove would."""

    def __init__(self, socket) -> None:
        self._socket = socket
        self.topics: dict[int, str] = {}
        self.messages: list[tuple[str, int, bytes]] = []
        self.info: dict = {}

    def look(self, wanted: int) -> None:
        """Until so many messages have come."""
        while len(self.messages) < wanted:
            message = self._socket.recv(timeout=20)
            if isinstance(message, bytes):
                kind, number, at = struct.unpack_from("<BIQ", message)
                if kind == 1:
                    self.messages.append((self.topics[number], at, message[13:]))
                continue
            told = json.loads(message)
            if told["op"] == "serverInfo":
                self.info = told
            elif told["op"] == "advertise":
                new = {channel["id"]: channel["topic"] for channel in told["channels"]}
                self.topics |= new
                wishes = [{"id": id, "channelId": id} for id in new]
                self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wishes}))


def observed(simulation: Simulation, recorder: RunRecorder) -> Simulation:
    simulation._observers = (*simulation._observers, recorder)
    recorder.on_begin(simulation.setup, simulation.spec)
    return simulation


def test_who_looks_on_sees_the_run(site) -> None:
    with served_live(port=0) as writer:
        port = writer.server.port
        recorder = RunRecorder(writer)
        with observed(simulation_of(SPEC, site), recorder) as simulation, looking(port) as socket:
            viewer = Viewer(socket)
            viewer.look(3)
            while not simulation.ended:
                simulation.step()
            viewer.look(15)
        topics = {topic for topic, _, _ in viewer.messages}
        assert {"/robot", "/tf", "/mission", "/checkpoints", "/readings"} <= topics
        states = [json.loads(data) for topic, _, data in viewer.messages if topic == "/mission"]
        assert states[-1]["outcome"] == "completed"
        scene = next(data for topic, _, data in viewer.messages if topic == "/robot")
        assert SceneUpdate.FromString(scene).entities
        assert viewer.info["capabilities"] == []
        with looking(port) as late:
            again = Viewer(late)
            again.look(3)  # what stays the same is told to who comes late


def test_nothing_comes_from_who_looks_on(site) -> None:
    with served_live(port=0) as writer:
        recorder = RunRecorder(writer)
        with (
            observed(simulation_of(SPEC, site), recorder) as simulation,
            looking(writer.server.port) as socket,
            looking(writer.server.port),  # reads nothing
        ):
            viewer = Viewer(socket)
            viewer.look(1)
            advertised = [{"id": 1, "topic": "/mission", "encoding": "json", "schemaName": "x"}]
            socket.send(json.dumps({"op": "advertise", "channels": advertised}))
            socket.send(b"\x01" + struct.pack("<I", 1) + b'{"task": "evil"}')
            record = simulation.run()
            assert record.result.success
            viewer.look(12)
            assert not any(b"evil" in data for _, _, data in viewer.messages)


def test_a_port_that_is_taken_is_said() -> None:
    with (
        served_live(port=0) as writer,
        pytest.raises(Unavailable, match="no live view"),
        served_live(port=writer.server.port),
    ):
        pass


def test_a_client_that_stays_and_reads_nothing_is_not_waited_for() -> None:
    with ExitStack() as view:
        writer = view.enter_context(served_live(0))
        writer.put("/log", Log(message="first"), 0.0)
        # Without pings, or it would break off by itself.
        with looking(writer.server.port, close_timeout=0.1, ping_interval=None) as client:
            while (told := json.loads(client.recv(timeout=5)))["op"] != "advertise":
                pass
            wanted = [{"id": c["id"], "channelId": c["id"]} for c in told["channels"]]
            client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
            client.recv(timeout=5)  # so it is subscribed
            for number in range(1000):
                writer.put("/log", Log(message="x" * 20_000), float(number))
            view.close()  # the client is still there, so this would not end if it were waited for
