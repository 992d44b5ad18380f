import asyncio
import json
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator

import pytest
from tornado.httpclient import HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages import pack
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.topics import CLOCK, GAME_EVENTS, RosMessage, Topic
from thbridge.sockets.addresses import LOCALHOST, ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.foxglove import FoxgloveServer

MAP = Topic("/map_name", "std_msgs/String", latched=True)


def said(topic: Topic, text: str, tick: int) -> RosMessage:
    return RosMessage(topic, stamp_ns(tick), pack.string(text))


@pytest.fixture
def server() -> Iterator[FoxgloveServer]:
    made = FoxgloveServer([MAP, CLOCK], Definitions())
    yield made
    made.stop()


async def connected(server: FoxgloveServer) -> WebSocketClientConnection:
    where = server.start(LOCALHOST, 0)
    assert isinstance(where, ListeningAddress)
    request = HTTPRequest(f"ws://{where.host}:{where.port}")
    return await websocket_connect(request, subprotocols=["foxglove.sdk.v1"])


async def told(client: WebSocketClientConnection, op: str) -> dict:
    while True:
        text = await client.read_message()
        if isinstance(text, str) and json.loads(text)["op"] == op:
            return json.loads(text)


async def message(client: WebSocketClientConnection) -> tuple[int, int, bytes]:
    """Return the subscription, the time and the bytes of the next message."""
    while True:
        frame = await client.read_message()
        if isinstance(frame, bytes) and frame[0] == 1:
            return *struct.unpack_from("<IQ", frame, 1), frame[13:]


def test_the_last_message_of_a_latched_topic_comes_to_whoever_subscribes_later(server: FoxgloveServer) -> None:
    async def look() -> None:
        client = await connected(server)
        server.take(3, [said(MAP, "first", 2), said(MAP, "arena8", 3)])
        channels = {each["topic"]: each for each in (await told(client, "advertise"))["channels"]}
        assert channels["/map_name"]["schema"] == "string data\n"
        assert (channels["/map_name"]["encoding"], channels["/map_name"]["schemaEncoding"]) == ("ros1", "ros1msg")
        wanted = {"op": "subscribe", "subscriptions": [{"id": 9, "channelId": channels["/map_name"]["id"]}]}
        await client.write_message(json.dumps(wanted))
        # No tick comes any more: a session that is paused is shown, too.
        assert await message(client) == (9, stamp_ns(3), pack.string("arena8"))
        client.close()

    asyncio.run(look())


def test_a_topic_is_advertised_with_its_first_message(server: FoxgloveServer) -> None:
    async def look() -> None:
        client = await connected(server)
        assert len((await told(client, "advertise"))["channels"]) == 2
        server.take(0, [RosMessage(GAME_EVENTS, stamp_ns(0), b"")])
        (channel,) = (await told(client, "advertise"))["channels"]
        assert (channel["topic"], channel["schemaName"]) == (GAME_EVENTS.name, GAME_EVENTS.msgtype)
        client.close()

    asyncio.run(look())


def test_a_port_that_is_taken_is_told_in_a_sentence(server: FoxgloveServer) -> None:
    with socket.create_server((LOCALHOST, 0)) as taken:
        failure = server.start(LOCALHOST, taken.getsockname()[1])
    assert isinstance(failure, CannotListen)
    assert "Address already in use" in str(failure)
    assert "choose another host or port" in str(failure)


HELD = """
import socket
from thbridge.files.ros.definitions import Definitions
from thbridge.sockets.foxglove import FoxgloveServer
server = FoxgloveServer([], Definitions(()))
where = server.start("127.0.0.1", 0)
clients = [socket.create_connection((where.host, where.port)) for _ in range(50)]
with socket.create_connection((where.host, where.port)) as last:  # whoever it hears comes after those it accepted
    last.sendall(b"GET / HTTP/1.1\\r\\n\\r\\n")
    last.recv(1000)
server.stop()
print("ended")
"""


def test_connections_that_are_left_do_not_keep_a_session_from_its_end() -> None:
    # In a program of its own: what holds the library cannot be ended from outside.
    done = subprocess.run([sys.executable, "-c", HELD], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout) == (0, "ended\n"), done.stderr
    assert "Foxglove's connections did not close in time" in done.stderr
