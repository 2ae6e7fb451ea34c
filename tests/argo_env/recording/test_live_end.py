"""Who looks on and reads nothing does not keep a live view from its end."""

import json
from contextlib import ExitStack

from foxglove_schemas_protobuf.Log_pb2 import Log
from websockets.sync.client import connect

from argo_env.recording.live import served_live


def test_a_client_that_stays_and_reads_nothing_is_not_waited_for() -> None:
    with ExitStack() as view:
        writer = view.enter_context(served_live(0))
        writer.put("/log", Log(message="first"), 0.0)
        with connect(
            f"ws://127.0.0.1:{writer.server.port}",
            subprotocols=["foxglove.sdk.v1"],
            max_size=None,
            close_timeout=0.1,
            ping_interval=None,  # or it would break off by itself
        ) as client:
            while (told := json.loads(client.recv(timeout=5)))["op"] != "advertise":
                pass
            wanted = [{"id": c["id"], "channelId": c["id"]} for c in told["channels"]]
            client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
            client.recv(timeout=5)  # so it is subscribed
            for number in range(1000):
                writer.put("/log", Log(message="x" * 20_000), float(number))
            view.close()  # the client is still there, so this would not end if it were waited for
