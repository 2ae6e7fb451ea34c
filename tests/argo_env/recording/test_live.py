"""A live view of a run in Foxglove: it has the topics of a recording and accepts no input."""

import json
import struct
from contextlib import ExitStack, contextmanager

import pytest
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from websockets.sync.client import connect

from argo_compiler.base.errors import Unavailable
from argo_env.recording.live import serve_live
from argo_env.recording.run_recorder import RunRecorder
from argo_env.run.simulation import Simulation
from argo_env.run.spec import RunSpec
from tests.yard import measure, mission, simulation_of, waypoint

SPEC = RunSpec(
    mission=mission(measure(1), waypoint("A", 4.05, 2.05), measure(2)), site="yard", drive="route"
)


@contextmanager
def connect_viewer(port: int, **options):
    defaults = {"subprotocols": ["foxglove.sdk.v1"], "max_size": None, "proxy": None}
    with connect(f"ws://127.0.0.1:{port}", **defaults, **options) as socket:
        yield socket


class Viewer:
    """Client that subscribes to all topics, as Foxglove does."""

    def __init__(self, socket) -> None:
        self._socket = socket
        self.topics: dict[int, str] = {}
        self.messages: list[tuple[str, int, bytes]] = []
        self.info: dict = {}

    def receive(self, count: int) -> None:
        """Receive until there are `count` messages."""
        while len(self.messages) < count:
            message = self._socket.recv(timeout=20)
            if isinstance(message, bytes):
                kind, number, time = struct.unpack_from("<BIQ", message)
                if kind == 1:
                    self.messages.append((self.topics[number], time, message[13:]))
                continue
            data = json.loads(message)
            if data["op"] == "serverInfo":
                self.info = data
            elif data["op"] == "advertise":
                new = {channel["id"]: channel["topic"] for channel in data["channels"]}
                self.topics |= new
                subscriptions = [{"id": id, "channelId": id} for id in new]
                self._socket.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))


def observe(simulation: Simulation, recorder: RunRecorder) -> Simulation:
    """Add the recorder to the observers of the simulation, and return the simulation."""
    simulation._observers = (*simulation._observers, recorder)
    recorder.on_begin(simulation.setup, simulation.spec)
    return simulation


def test_a_viewer_receives_the_run(site) -> None:
    with serve_live(port=0) as writer:
        port = writer.server.port
        recorder = RunRecorder(writer)
        with (
            observe(simulation_of(SPEC, site), recorder) as simulation,
            connect_viewer(port) as socket,
        ):
            viewer = Viewer(socket)
            viewer.receive(3)
            while not simulation.ended:
                simulation.step()
            viewer.receive(15)
        topics = {topic for topic, _, _ in viewer.messages}
        assert {"/robot", "/tf", "/mission", "/checkpoints", "/readings"} <= topics
        states = [json.loads(data) for topic, _, data in viewer.messages if topic == "/mission"]
        assert states[-1]["outcome"] == "completed"
        scene = next(data for topic, _, data in viewer.messages if topic == "/robot")
        assert SceneUpdate.FromString(scene).entities
        assert viewer.info["capabilities"] == []
        with connect_viewer(port) as socket:
            late_viewer = Viewer(socket)
            late_viewer.receive(3)  # a late viewer gets the last messages


def test_input_of_viewers_is_ignored(site) -> None:
    with serve_live(port=0) as writer:
        recorder = RunRecorder(writer)
        with (
            observe(simulation_of(SPEC, site), recorder) as simulation,
            connect_viewer(writer.server.port) as socket,
            connect_viewer(writer.server.port),  # reads nothing
        ):
            viewer = Viewer(socket)
            viewer.receive(1)
            advertised = [{"id": 1, "topic": "/mission", "encoding": "json", "schemaName": "x"}]
            socket.send(json.dumps({"op": "advertise", "channels": advertised}))
            socket.send(b"\x01" + struct.pack("<I", 1) + b'{"task": "evil"}')
            record = simulation.run()
            assert record.result.success
            viewer.receive(12)
            assert not any(b"evil" in data for _, _, data in viewer.messages)


def test_a_port_that_is_taken_is_an_error() -> None:
    with (
        serve_live(port=0) as writer,
        pytest.raises(Unavailable, match="no live view"),
        serve_live(port=writer.server.port),
    ):
        pass


def test_the_server_does_not_wait_for_a_client_that_reads_nothing() -> None:
    with ExitStack() as view:
        writer = view.enter_context(serve_live(0))
        writer.put("/log", Log(message="first"), 0.0)
        # With pings the client would disconnect by itself.
        with connect_viewer(writer.server.port, close_timeout=0.1, ping_interval=None) as client:
            while (message := json.loads(client.recv(timeout=5)))["op"] != "advertise":
                pass
            subscriptions = [{"id": c["id"], "channelId": c["id"]} for c in message["channels"]]
            client.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))
            client.recv(timeout=5)  # now the client is subscribed
            for number in range(1000):
                writer.put("/log", Log(message="x" * 20_000), float(number))
            view.close()  # would not end if it waited for the client, which is still connected
