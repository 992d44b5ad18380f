"""The ROS node over real TCP, at our own master."""

import asyncio
import functools
import gc
import logging
import os
import random
import resource
import socket
import struct
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from urllib.parse import urlsplit

import pytest

from tests.support.programs.event_loops import eventually
from tests.support.ros.service_client import call_service
from thbridge.rosgraph.sockets import publications, registrar, subscriptions, tcpros_server
from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.http_server import XmlRpcServer
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.rosgraph.wire.tcpros import decode_header, encode_header, frame
from thbridge.rosgraph.wire.xmlrpc import MethodResponse
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen

PATIENCE = 120.0
STRING = ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n")
TRIGGER = (
    "std_srvs/Trigger",
    "937c9679a518e3a18d831e57125ea522",
    "std_srvs/TriggerRequest",
    "std_srvs/TriggerResponse",
)


def with_patience(test: Callable[..., Awaitable[None]]) -> Callable[..., None]:
    """Run a test's coroutine, but not for ever; afterwards nothing is left running."""

    @functools.wraps(test)
    def run(*args, **kwargs) -> None:
        async def patient() -> None:
            async with asyncio.timeout(PATIENCE):
                await test(*args, **kwargs)
                while len(asyncio.all_tasks()) > 1:
                    await asyncio.sleep(0.01)

        asyncio.run(patient())

    return run


@asynccontextmanager
async def master(port: int = 0) -> AsyncIterator[MasterServer]:
    made = MasterServer(port=port)
    assert isinstance(await made.start(), ListeningAddress)
    try:
        yield made
    finally:
        await made.stop()


def uri_of(ros: MasterServer, node: str = "/us") -> str:
    uri = ros.call("lookupNode", "/test", node).value
    assert isinstance(uri, str)
    return uri


def port_of(ros: MasterServer) -> int:
    port = urlsplit(ros.uri).port
    assert port is not None
    return port


@asynccontextmanager
async def running(*nodes: RosNode) -> AsyncIterator[None]:
    for node in nodes:
        assert isinstance(await node.start(), NodeStarted)
    try:
        for node in nodes:
            await node.registered()
        yield
    finally:
        for node in nodes:
            await node.stop()


async def where(node: RosNode, uri: str) -> tuple[str, int]:
    """Where a node takes subscribers and clients, as anybody may ask it."""
    client = XmlRpcClient()
    topic = next(iter(await published(client, uri)))
    reply = await client.call(uri, "requestTopic", "/them", topic, [["TCPROS"]])
    await client.close()
    assert isinstance(reply, MethodResponse)
    return reply.value[2][1], reply.value[2][2]


async def published(client: XmlRpcClient, uri: str) -> list[str]:
    reply = await client.call(uri, "getPublications", "/them")
    assert isinstance(reply, MethodResponse)
    return [topic for topic, _ in reply.value[2]]


class Peer:
    """A connection to a node's TCPROS port, made by hand."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer

    @classmethod
    async def of(cls, ros: MasterServer, node: RosNode) -> "Peer":
        return cls(*await asyncio.open_connection(*await where(node, uri_of(ros, node.name))))

    async def subscribes(self, topic: str = "/chatter", md5: str = STRING[1]) -> dict[str, str]:
        self.writer.write(encode_header({"callerid": "/them", "md5sum": md5, "topic": topic, "type": "a/B"}))
        fields = decode_header(await self.hears())
        assert isinstance(fields, dict)
        return fields

    async def hears(self) -> bytes:
        (length,) = struct.unpack("<I", await self.reader.readexactly(4))
        return await self.reader.readexactly(length)

    async def is_cut_off(self) -> bool:
        try:
            return await self.reader.read() == b""
        except ConnectionResetError:
            return True
        finally:
            self.goes()

    def goes(self) -> None:
        self.writer.transport.abort()


# -- topics


@with_patience
async def test_messages_pass_between_two_nodes_in_order_and_back_to_oneself():
    async with master() as ros:
        heard, echoed = [], []
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        us.subscribe("/chatter", *STRING[:2], lambda data, caller: echoed.append(data))
        them.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append((data, caller)))
        async with running(us, them):
            await eventually(lambda: chatter.subscribers == 2)
            sent = [bytes([number]) * number * 100 for number in range(100)]
            for data in sent:
                chatter.publish(data)
            await eventually(lambda: len(heard) == len(echoed) == 100)
            assert heard == [(data, "/us") for data in sent]
            assert echoed == sent
            assert chatter.dropped == 0


@with_patience
async def test_a_publisher_that_comes_later_is_found_and_one_that_comes_back_is_found_again():
    async with master() as ros:
        heard = []
        us = RosNode("/us", ros.uri)
        us.subscribe("/chatter", "*", "*", lambda data, caller: heard.append(data))
        async with running(us):
            for word in (b"first", b"second"):
                them = RosNode("/them", ros.uri)
                them.advertise("/chatter", *STRING, latched=True).publish(word)
                async with running(them):
                    await eventually(lambda word=word: word in heard)
        assert heard == [b"first", b"second"]


@with_patience
async def test_a_late_subscriber_gets_the_last_message_of_a_latched_topic():
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        latched = us.advertise("/latched", *STRING, latched=True)
        async with running(us):
            latched.publish(b"old")
            latched.publish(b"new")
            peer = await Peer.of(ros, us)
            assert (await peer.subscribes("/latched"))["latching"] == "1"
            assert await peer.hears() == b"new"
            peer.goes()


@with_patience
async def test_a_broken_connection_is_made_again(monkeypatch):
    monkeypatch.setattr(subscriptions, "_FIRST_PAUSE", 0.01)
    async with master() as ros:
        heard = []
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = them.advertise("/chatter", *STRING)
        us.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append(data))
        async with running(us, them):
            for word in (b"one", b"two"):
                await eventually(lambda: chatter.subscribers == 1)
                chatter.publish(word)
                await eventually(lambda word=word: word in heard)
                for connection in [*them._tcpros._connections]:
                    connection.cut_off()
                await eventually(lambda: chatter.subscribers == 0)


@with_patience
async def test_who_wants_another_type_is_refused_and_complained_of_once(caplog, monkeypatch):
    monkeypatch.setattr(subscriptions, "_FIRST_PAUSE", 0.001)
    async with master() as ros:
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        them.subscribe("/chatter", "std_msgs/Int32", "0" * 32, lambda data, caller: None)
        with caplog.at_level(logging.DEBUG):
            async with running(us, them):
                await eventually(lambda: caplog.text.count("refuses the subscription to /chatter") > 3)
        assert chatter.subscribers == 0
    warnings = [record.getMessage() for record in caplog.records if record.levelno == logging.WARNING]
    assert len(warnings) == 2  # one on each side
    assert all("std_msgs/Int32" in warning for warning in warnings)


@with_patience
async def test_a_subscriber_that_never_reads_loses_messages_alone_and_in_bounded_memory():
    async with master() as ros:
        heard = []
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        them.subscribe("/chatter", "*", "*", lambda data, caller: heard.append(data[:1]))
        async with running(us, them):
            stalled = await Peer.of(ros, us)
            await stalled.subscribes()
            stalled.writer.transport.pause_reading()
            await eventually(lambda: chatter.subscribers == 2)
            for number in range(100):
                chatter.publish(bytes([number]) * 200_000)
                await eventually(lambda number=number: len(heard) > number)
            assert heard == [bytes([number]) for number in range(100)]
            assert 0 < chatter.dropped < 100
            assert max(each._waiting_bytes for each in chatter._outlets) <= publications.WAITING_LIMIT
            stalled.goes()


@with_patience
async def test_what_was_said_last_is_still_heard():
    async with master() as ros:
        heard = []
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        them.subscribe("/chatter", "*", "*", lambda data, caller: heard.append(data[:1]))
        async with running(us, them):
            await eventually(lambda: chatter.subscribers == 1)
            for number in range(20):  # much more than the system buffers, less than may wait
                chatter.publish(bytes([number]) * (3_000_000 if number == 0 else 50_000))
            await us.stop()
            await eventually(lambda: len(heard) == 20)
            assert heard == [bytes([number]) for number in range(20)]


@with_patience
async def test_a_subscriber_that_never_reads_does_not_keep_us(monkeypatch):
    monkeypatch.setattr(tcpros_server, "_FAREWELL_SECONDS", 0.05)
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        async with running(us):
            stalled = await Peer.of(ros, us)
            await stalled.subscribes()
            stalled.writer.transport.pause_reading()
            chatter.publish(bytes(20 * publications.WAITING_LIMIT))
            chatter.publish(b"waits")
            await us.stop()
            await eventually(lambda: not us._tcpros._connections)
            stalled.goes()


@with_patience
async def test_a_message_longer_than_the_limit_gets_through_alone():
    async with master() as ros:
        heard = []
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        them.subscribe("/chatter", "*", "*", lambda data, caller: heard.append(data))
        async with running(us, them):
            await eventually(lambda: chatter.subscribers == 1)
            chatter.publish(os.urandom(20 * publications.WAITING_LIMIT))
            chatter.publish(b"small")
            await eventually(lambda: len(heard) == 2)
            assert [len(data) for data in heard] == [20 * publications.WAITING_LIMIT, 5]


@with_patience
async def test_bus_info_and_stats_tell_what_passed():
    async with master() as ros:
        heard = []
        us = RosNode("/us", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        us.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append(data))
        async with running(us):
            await eventually(lambda: chatter.subscribers == 1)
            chatter.publish(b"12345678")
            chatter.publish(b"12345678")
            await eventually(lambda: len(heard) == 2)
            client = XmlRpcClient()
            info = (await client.call(uri_of(ros), "getBusInfo", "/them")).value[2]
            stats = (await client.call(uri_of(ros), "getBusStats", "/them")).value[2]
            await client.close()
            uri = uri_of(ros)
    assert [entry[1:6] for entry in info] == [
        ["/us", "o", "TCPROS", "/chatter", True],
        [uri, "i", "TCPROS", "/chatter", True],
    ]
    assert info[0][0] != info[1][0]
    sent, received, _ = stats
    assert sent == [["/chatter", 24, [[info[0][0], 24, 2, True]]]]
    assert received == [["/chatter", [[info[1][0], 24, 2, -1, True]]]]


# -- services


@with_patience
async def test_services_answer_at_once_in_time_or_not_at_all(monkeypatch):
    async def later(request: bytes) -> bytes:
        await asyncio.sleep(0)
        return request * 2

    def broken(request: bytes) -> bytes:
        raise RuntimeError("a bug")

    async def broken_later(request: bytes) -> bytes:
        raise RuntimeError("a bug")

    asked = asyncio.Event()

    async def never(request: bytes) -> bytes:
        asked.set()
        await asyncio.Event().wait()
        return b""

    async with master() as ros:
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        us.advertise("/chatter", *STRING)
        for name, handler in {
            "/now": lambda request: request,
            "/later": later,
            "/fails": lambda request: ServiceFailed("no way"),
            "/broken": broken,
            "/broken_later": broken_later,
            "/never": never,
        }.items():
            us.serve(name, *TRIGGER, handler)
        async with running(us, them_with_nothing(them)):
            assert await call_service(ros.uri, "/now", TRIGGER[1], b"x") == b"x"
            assert await call_service(ros.uri, "/later", "*", b"x") == b"xx"
            assert await call_service(ros.uri, "/fails", "*", b"x") == ServiceFailed("no way")
            for name in ("/broken", "/broken_later"):
                assert isinstance(await call_service(ros.uri, name, "*", b""), ServiceFailed)
            unanswered = asyncio.create_task(call_service(ros.uri, "/never", "*", b""))
            await asked.wait()
            monkeypatch.setattr(tcpros_server, "ANSWERING_LIMIT", 1)
            assert "too many" in (await call_service(ros.uri, "/later", "*", b"")).reason
            unanswered.cancel()
            assert isinstance(await call_service(ros.uri, "/now", "0" * 32, b"x"), ServiceFailed)
            assert isinstance(await call_service(ros.uri, "/nobody", "*", b"x"), ServiceFailed)


def them_with_nothing(node: RosNode) -> RosNode:
    node.advertise("/something", *STRING)
    return node


# -- master


@with_patience
async def test_a_master_that_is_late_or_lost_or_restarted_is_told_everything(monkeypatch):
    monkeypatch.setattr(registrar, "_HEARTBEAT", 0.02)
    monkeypatch.setattr(registrar, "_LAST_PAUSE", 0.02)
    log: list[str] = []
    async with master() as ros:
        port = port_of(ros)
    us = RosNode("/us", ros.uri, on_lost=lambda: log.append("lost"), on_found=lambda: log.append("found"))
    us.advertise("/chatter", *STRING)
    us.serve("/now", *TRIGGER, lambda request: request)
    us.subscribe_param("/key", lambda key, value: log.append(f"{key} is {value}"))
    us.declare_param("/use_sim_time", True)
    assert isinstance(await us.start(), NodeStarted)
    async with master(port) as ros:
        await us.registered()
        await eventually(lambda: log == ["found"])
    await eventually(lambda: log == ["found", "lost"])
    log.clear()
    async with master(port) as ros:
        await eventually(lambda: log == ["found"])
        assert ros.call("getPublishedTopics", "/test", "").value == [["/chatter", "std_msgs/String"]]
        assert ros.call("lookupService", "/test", "/now").status == 1
        assert ros.call("getParam", "/test", "/use_sim_time").value is True
        ros.call("setParam", "/test", "/key", 1)
        await eventually(lambda: log == ["found", "/key is 1"])
        log.clear()
        ros.call("unregisterPublisher", "/us", "/chatter", uri := uri_of(ros))
        ros.call("unregisterService", "/us", "/now", ros.call("lookupService", "/test", "/now").value)
        ros.call("unsubscribeParam", "/us", uri, "/key")  # now it is as if restarted between two looks
        await eventually(lambda: log == ["found"])
        us.advertise("/later", *STRING)
        await us.registered()
        assert len(ros.call("getPublishedTopics", "/test", "").value) == 2
        await us.stop()
        assert ros.call("getSystemState", "/test").value == [[], [], []]
        assert ros.call("lookupNode", "/test", "/us").status == -1
        assert ros.call("hasParam", "/test", "/use_sim_time").value is False


@with_patience
async def test_that_the_master_is_gone_and_back_is_told_once_and_not_at_the_first_look(monkeypatch, caplog):
    def told() -> list[str]:
        return [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]

    monkeypatch.setattr(registrar, "_HEARTBEAT", 0.02)
    monkeypatch.setattr(registrar, "_LAST_PAUSE", 0.02)
    looks: list[list[str]] = []
    call = registrar.Registrar._call

    async def look(self, method: str, *params: str) -> object:
        looks.append(told())
        return await call(self, method, *params)

    monkeypatch.setattr(registrar.Registrar, "_call", look)
    async with master() as ros:
        port, uri = port_of(ros), ros.uri
    us = RosNode("/us", uri)
    us.advertise("/chatter", *STRING)
    assert isinstance(await us.start(), NodeStarted)
    await eventually(lambda: len(looks) > 4)
    assert [len(before) for before in looks[:5]] == [0, 0, 1, 1, 1], "it has looked twice before it tells"
    assert told()[0].startswith(f"no ROS master yet: {uri}: ")
    async with master(port):
        await eventually(lambda: told()[1:] == [f"/us is registered with the ROS master at {uri}"])
    await eventually(lambda: len(told()) == 3)
    assert told()[2].startswith(f"the ROS master no longer answers: {uri}: ")
    looks.clear()
    await eventually(lambda: len(looks) > 2)
    async with master(port):
        await eventually(lambda: len(told()) > 3)
        assert told()[3:] == [f"/us is registered with the ROS master at {uri}"]
    await us.stop()


@pytest.mark.parametrize("told", [True, False])
@with_patience
async def test_a_node_that_lost_its_name_says_so_once_and_does_not_take_it_back(told, monkeypatch):
    async def tell_nothing(*_) -> CallFailed:
        return CallFailed("", "not delivered")

    monkeypatch.setattr(registrar, "_HEARTBEAT", 0.02)
    async with master() as ros:
        if not told:
            monkeypatch.setattr(ros, "_notify", tell_nothing)
        reasons: list[str] = []
        us = RosNode("/us", ros.uri, on_shutdown=reasons.append)
        us.advertise("/chatter", *STRING)
        us.declare_param("/use_sim_time", True)
        async with running(us):
            ros.call("registerPublisher", "/us", "/chatter", STRING[0], "http://127.0.0.1:1/")
            await eventually(lambda: reasons)
            us.advertise("/later", *STRING)
            await eventually(us._registering.done)
            assert len(reasons) == 1
        assert ros.call("getSystemState", "/test").value[0] == [["/chatter", ["/us"]]]
        # Its successor has set them as well.
        assert ros.call("getParam", "/test", "/use_sim_time").value is True


@with_patience
async def test_without_a_master_nothing_fails_and_stopping_is_quick():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        nobody = f"http://127.0.0.1:{taken.getsockname()[1]}"
    us = RosNode("/us", nobody)
    us.advertise("/chatter", *STRING, latched=True).publish(b"unheard")
    assert isinstance(await us.start(), NodeStarted)
    assert isinstance(await us.get_param("/key"), CallFailed)
    await us.stop()
    await us.stop()


@pytest.mark.parametrize("host", ["192.0.2.1", "no.such.host.invalid", "." * 100])
@with_patience
async def test_a_host_that_is_not_ours_cannot_be_listened_on(host):
    assert isinstance(await RosNode("/us", "http://127.0.0.1:11311", host).start(), CannotListen)


@with_patience
async def test_who_listens_everywhere_is_known_by_the_machines_name():
    async with master() as ros:
        us = RosNode("/us", ros.uri, host="0.0.0.0")
        us.advertise("/chatter", *STRING)
        us.serve("/now", *TRIGGER, lambda request: request)
        async with running(us):
            await us.registered()
            name = socket.gethostname()
            assert uri_of(ros).startswith(f"http://{name}:")
            assert ros.call("lookupService", "/test", "/now").value.startswith(f"rosrpc://{name}:")


@with_patience
async def test_a_name_with_addresses_of_both_kinds_is_reached_by_nodes_that_know_one():
    async with master() as ros:
        us = RosNode("/us", ros.uri, host="localhost")
        us.advertise("/chatter", *STRING)
        async with running(us):
            host, port = await where(us, uri_of(ros))
            assert host == "localhost"
            with socket.socket(socket.AF_INET) as peer:
                peer.connect((host, port))


@with_patience
async def test_nothing_is_offered_twice():
    us = RosNode("/us", "http://127.0.0.1:11311")
    us.advertise("/chatter", *STRING)
    us.subscribe("/chatter", *STRING[:2], lambda data, caller: None)
    us.serve("/now", *TRIGGER, lambda request: request)
    us.subscribe_param("/key", lambda key, value: None)
    for again in (
        lambda: us.advertise("/chatter", *STRING),
        lambda: us.subscribe("/chatter", *STRING[:2], lambda data, caller: None),
        lambda: us.serve("/now", *TRIGGER, lambda request: request),
        lambda: us.subscribe_param("/key", lambda key, value: None),
    ):
        with pytest.raises(ValueError, match="already"):
            again()


# -- strangers


@with_patience
async def test_silent_peers_are_cut_off_but_patient_clients_are_not(monkeypatch):
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        us.advertise("/chatter", *STRING)
        us.serve("/now", *TRIGGER, lambda request: request)
        async with running(us):
            client = await Peer.of(ros, us)
            client.writer.write(
                encode_header({"callerid": "/them", "md5sum": "*", "service": "/now", "persistent": "1"})
            )
            await client.hears()
            monkeypatch.setattr(tcpros_server, "HANDSHAKE_SECONDS", 0.05)
            silent, slow = [await Peer.of(ros, us) for _ in range(2)]
            slow.writer.write(b"\xff\x00")
            assert await silent.is_cut_off()
            assert await slow.is_cut_off()
            client.writer.write(frame(b"still here"))
            assert await client.reader.readexactly(1) == b"\x01"
            assert await client.hears() == b"still here"
            client.goes()


@with_patience
async def test_a_publisher_that_says_nothing_is_given_up(monkeypatch):
    monkeypatch.setattr(subscriptions, "HANDSHAKE_SECONDS", 0.05)
    monkeypatch.setattr(subscriptions, "_FIRST_PAUSE", 0.01)
    connected = []
    mute = await asyncio.start_server(lambda reader, writer: connected.append(writer), "127.0.0.1", 0)
    liar = XmlRpcServer({"requestTopic"}, lambda call, peer: [1, "", ["TCPROS", *mute.sockets[0].getsockname()]])
    address = await liar.start("127.0.0.1", 0)
    async with master() as ros:
        ros.call("registerPublisher", "/mute", "/chatter", "*", f"http://127.0.0.1:{address.port}/")
        us = RosNode("/us", ros.uri)
        us.subscribe("/chatter", "*", "*", lambda data, caller: None)
        async with running(us):
            await eventually(lambda: len(connected) >= 2)
    for writer in connected:
        writer.transport.abort()
    await liar.stop()
    mute.close()


@pytest.mark.parametrize(
    "offer",
    [
        [],
        0,
        "TCPROS",
        ["UDPROS", "127.0.0.1", 1],
        ["TCPROS", "127.0.0.1", -1],
        ["TCPROS", "127.0.0.1", 10**6],
        ["TCPROS", "\x00", 80],
        ["TCPROS", "." * 100, 80],
        ["TCPROS", "127.0.0.1", 1],
    ],
)
@with_patience
async def test_whatever_a_publisher_offers_does_no_harm(offer, monkeypatch):
    monkeypatch.setattr(subscriptions, "_FIRST_PAUSE", 0.001)
    asked = []
    liar = XmlRpcServer({"requestTopic"}, lambda call, peer: asked.append(call) or [1, "", offer])
    address = await liar.start("127.0.0.1", 0)
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        us.subscribe("/chatter", "*", "*", lambda data, caller: None)
        async with running(us):
            client = XmlRpcClient()
            uris = [f"http://127.0.0.1:{address.port}/", "nonsense", "http://[", ""]
            await client.call(uri_of(ros), "publisherUpdate", "/master", "/chatter", uris)
            await client.close()
            await eventually(lambda: len(asked) >= 2)
            assert len(us._subscriptions["/chatter"]._followed) == 4
    await liar.stop()


@with_patience
async def test_there_are_only_so_many_connections(monkeypatch):
    monkeypatch.setattr(tcpros_server, "CONNECTION_LIMIT", 4)
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        async with running(us):
            peers = [await Peer.of(ros, us) for _ in range(3)]
            for peer in peers:
                await peer.subscribes()
            assert await (await Peer.of(ros, us)).is_cut_off()
            peers[0].goes()
            await eventually(lambda: chatter.subscribers == 2)
            again = await Peer.of(ros, us)
            await again.subscribes()
            for peer in (*peers, again):
                peer.goes()


@with_patience
async def test_one_address_has_three_quarters_of_the_connections_and_subscribers_stay(monkeypatch):
    monkeypatch.setattr(tcpros_server, "CONNECTION_LIMIT", 4)
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        us.advertise("/chatter", *STRING)
        async with running(us):
            at = await where(us, uri_of(ros))
            subscriber = await Peer.of(ros, us)
            await subscriber.subscribes()
            flood = [Peer(*await asyncio.open_connection(*at)) for _ in range(10)]
            other = Peer(*await asyncio.open_connection(*at, local_addr=("127.0.0.2", 0)))
            await other.subscribes()
            for silent in flood[:-2]:
                assert await silent.is_cut_off()
            us._tcpros.publications["/chatter"].publish(b"both")
            assert (await subscriber.hears(), await other.hears()) == (b"both", b"both")
            for peer in (subscriber, other, *flood):
                peer.goes()


@with_patience
async def test_one_address_subscribes_to_one_topic_only_so_often(monkeypatch, caplog):
    monkeypatch.setattr(tcpros_server, "TOPIC_LIMIT", 2)
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        us.advertise("/other", *STRING)
        async with running(us):
            peers = [await Peer.of(ros, us) for _ in range(4)]
            for peer in peers[:3]:
                await peer.subscribes()
            assert await peers[2].is_cut_off()
            await peers[3].subscribes("/other")
            assert chatter.subscribers == 2
            assert "127.0.0.1 subscribes to /chatter more than 2 times" in caplog.text
            for peer in peers:
                peer.goes()


@with_patience
async def test_requests_and_messages_by_the_thousand_leave_time_for_other_work():
    rounds = 0

    async def count() -> None:
        nonlocal rounds
        while True:
            rounds += 1
            await asyncio.sleep(0)

    async with master() as ros:
        us, them = RosNode("/us", ros.uri), RosNode("/them", ros.uri)
        asked: list[int] = []
        heard: list[int] = []
        us.advertise("/any", *STRING)
        us.serve("/now", *TRIGGER, lambda request: asked.append(rounds) or b"")
        us.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append(rounds))
        chatter = them.advertise("/chatter", *STRING)
        async with running(us, them):
            await eventually(lambda: chatter.subscribers == 1)
            client = await Peer.of(ros, us)
            fields = {"callerid": "/c", "md5sum": "*", "service": "/now", "persistent": "1"}
            counting = asyncio.ensure_future(count())
            client.writer.write(encode_header(fields) + frame(b"") * 1000)
            await eventually(lambda: len(asked) == 1000)
            assert max(asked.count(one) for one in set(asked)) <= 8
            them._tcpros.publications["/chatter"]._outlets[0]._transport.write(frame(b"") * 50_000)
            await eventually(lambda: len(heard) == 50_000)
            assert max(Counter(heard).values()) <= 16 * 1024
            counting.cancel()
            client.goes()


@with_patience
async def test_invented_publishers_have_a_bound_however_often_they_are_named_anew(monkeypatch):
    monkeypatch.setattr(subscriptions, "PUBLISHER_LIMIT", 10)
    monkeypatch.setattr(subscriptions, "_CONNECTING_LIMIT", 3)
    asking: set[asyncio.StreamWriter] = set()

    async def never_answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        asking.add(writer)
        with suppress(OSError):
            await reader.read()
        asking.discard(writer)
        writer.close()

    mute = await asyncio.start_server(never_answer, "127.0.0.1", 0)
    port = mute.sockets[0].getsockname()[1]
    async with master() as ros:
        us, them, heard = RosNode("/us", ros.uri), RosNode("/them", ros.uri), []
        us.subscribe("/chatter", *STRING[:2], lambda data, caller: heard.append(data))
        chatter = them.advertise("/chatter", *STRING)
        async with running(us, them):
            await eventually(lambda: chatter.subscribers == 1)
            client = XmlRpcClient()
            for number in range(30):
                uris = [f"http://127.0.0.1:{port}/{number}/{each}" for each in range(20)]
                await client.call(uri_of(ros), "publisherUpdate", "/master", "/chatter", uris)
                assert len(us._subscriptions["/chatter"]._followed) <= 10
            await eventually(lambda: len(asking) == 3)
            chatter.publish(b"still there")  # a connection that is open stays
            await eventually(lambda: heard == [b"still there"])
            await client.call(uri_of(ros), "publisherUpdate", "/master", "/chatter", [uri_of(ros, "/them")])
            await client.close()
    mute.close()


def test_a_process_may_open_the_files_that_so_many_connections_take():
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (1024, before[1]))
    try:
        RosNode("/us", "http://127.0.0.1:1")
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        assert soft == min(12_288, hard) if hard != resource.RLIM_INFINITY else soft == 12_288
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


@with_patience
async def test_a_client_that_asks_and_does_not_read_is_cut_off():
    async with master() as ros:
        us, asked = RosNode("/us", ros.uri), []
        us.advertise("/chatter", *STRING)
        us.serve("/map", *TRIGGER, lambda request: asked.append(1) or bytes(publications.WAITING_LIMIT))
        async with running(us):
            client = await Peer.of(ros, us)
            client.writer.transport.pause_reading()
            client.writer.write(
                encode_header({"callerid": "/them", "md5sum": "*", "service": "/map", "persistent": "1"})
            )
            client.writer.write(frame(b"") * 1000)
            await eventually(lambda: not us._tcpros._connections)
            assert 1 < len(asked) < 50
            client.goes()


@pytest.mark.parametrize("rounds", [200, pytest.param(5000, marks=pytest.mark.slow)])
@with_patience
async def test_mutated_traffic_harms_nobody_and_leaves_nothing_behind(rounds):
    dice = random.Random(4)
    openings = [
        encode_header({"callerid": "/them", "md5sum": "*", "topic": "/chatter"}),
        encode_header({"callerid": "/them", "md5sum": "*", "service": "/now", "persistent": "1"}) + frame(b"x") * 3,
    ]
    async with master() as ros:
        us = RosNode("/us", ros.uri)
        chatter = us.advertise("/chatter", *STRING)
        us.serve("/now", *TRIGGER, lambda request: request)
        async with running(us):
            address = await where(us, uri_of(ros))
            for _ in range(rounds):
                data = bytearray(dice.choice(openings))
                for _ in range(dice.randint(1, 4)):
                    data[dice.randrange(len(data))] = dice.randrange(256)
                _, writer = await asyncio.open_connection(*address)
                writer.write(bytes(data))
                chatter.publish(b"to whom it may concern")
                await asyncio.sleep(0)
                writer.transport.abort() if dice.random() < 0.5 else writer.close()
            await eventually(lambda: not us._tcpros._connections)
            assert chatter.subscribers == 0
            del writer
            gc.collect()
            assert sum(isinstance(each, tcpros_server._Inbound) for each in gc.get_objects()) == 0
            witness = await Peer.of(ros, us)
            await witness.subscribes()
            chatter.publish(b"all is well")
            assert await witness.hears() == b"all is well"
            witness.goes()
