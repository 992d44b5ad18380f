"""Topics between our DDS carrier and real implementations: rclpy on Fast DDS, and Cyclone DDS."""

import random

import pytest

from tests.peers.ros2.peer_messages import GRID, STRING, grid, string, text_of
from tests.peers.ros2.peer_process import DOMAIN, joined, needs_ros2, peer, until, with_timeout
from thbridge.ros2.qos import DEFAULT, LATCHED, SENSOR_DATA
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import NodeName

pytestmark = needs_ros2

OURS = NodeName("/robot1", "ours")
QUALITIES = {"reliable": (DEFAULT, [10, True, False]), "best effort": (SENSOR_DATA, [5, False, False])}


@pytest.mark.parametrize("quality", QUALITIES)
@with_timeout
async def test_rclpy_hears_us_and_we_hear_rclpy(quality: str) -> None:
    ours, theirs = QUALITIES[quality]
    heard: list[tuple[bytes, str]] = []
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/chatter", STRING, ours)
    carrier.subscribe(OURS, "/back", STRING, ours, lambda data, gid: heard.append((data, carrier.node_of(gid))))
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        other.do("subscribe", topic="/chatter", type_name=STRING.name, qos=theirs)
        other.do("advertise", topic="/back", type_name=STRING.name, qos=theirs)
        await until(lambda: writer.readers == 1 and len(carrier.endpoints()) >= 2, "both endpoints are known")
        # The peer may know our writer a moment later; best effort has no second attempt.
        await until(lambda: NodeName("/peer", "theirs") in carrier.nodes(), "the node is known")
        number = 0

        def say() -> bool:
            nonlocal number
            number += 1
            writer.write(string(f"hello {number}"))
            other.do("publish", topic="/back", data=string(f"back {number}").hex())
            return len(heard) >= 20

        await until(say, "20 messages came")
        first = text_of(bytes.fromhex((await other.event("message", topic="/chatter"))["data"]))
        for at in range(int(first.split()[1]) + 1, int(first.split()[1]) + 11):
            message = await other.event("message", topic="/chatter")
            assert text_of(bytes.fromhex(message["data"])) == f"hello {at}"
        assert {node for _, node in heard} == {"/peer/theirs"}
        numbers = [int(text_of(data).split()[1]) for data, _ in heard]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@with_timeout
async def test_late_subscribers_get_the_last_message_of_a_latched_topic() -> None:
    heard: list[bytes] = []
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/map_name", STRING, LATCHED)
    for text in ("old", "new"):
        writer.write(string(text))
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        other.do("subscribe", topic="/map_name", type_name=STRING.name, qos=[1, True, True])
        assert text_of(bytes.fromhex((await other.event("message"))["data"])) == "new"
        other.do("advertise", topic="/their_name", type_name=STRING.name, qos=[1, True, True])
        for text in ("old", "new"):
            other.do("publish", topic="/their_name", data=string(text).hex())
        # Commands are executed in order, so both messages are published.
        other.do("graph", node="", namespace="/", topics=[])
        await other.event("graph")
        carrier.subscribe(OURS, "/their_name", STRING, LATCHED, lambda data, gid: heard.append(data))
        await until(lambda: heard, "the latched message came")
        assert [text_of(data) for data in heard] == ["new"]


@with_timeout
async def test_a_map_arrives_in_both_directions() -> None:
    sent, heard = grid(400, 400), []
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/map", GRID, LATCHED)
    carrier.subscribe(OURS, "/their_map", GRID, LATCHED, lambda data, gid: heard.append(data))
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        writer.write(sent)
        other.do("subscribe", topic="/map", type_name=GRID.name, qos=[1, True, True])
        assert bytes.fromhex((await other.event("message"))["data"]) == sent
        other.do("advertise", topic="/their_map", type_name=GRID.name, qos=[1, True, True])
        other.do("publish", topic="/their_map", data=sent.hex())
        await until(lambda: heard, "the map came")
        assert heard == [sent]


@with_timeout
async def test_programs_of_the_default_discovery_range_are_found() -> None:
    """By default, ROS 2 announces itself by multicast, which we do not hear on loopback."""
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/chatter", STRING, LATCHED)
    writer.write(string("hello"))
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer", discovery="SUBNET") as other:
        other.do("subscribe", topic="/chatter", type_name=STRING.name, qos=[1, True, True])
        assert text_of(bytes.fromhex((await other.event("message"))["data"])) == "hello"


@pytest.mark.parametrize("quality", QUALITIES)
@with_timeout
async def test_cyclone_hears_us_and_we_hear_cyclone(quality: str) -> None:
    ours, theirs = QUALITIES[quality]
    heard: list[bytes] = []
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/chatter", STRING, ours)
    carrier.publish(OURS, "/name", STRING, LATCHED).write(string("latched"))
    carrier.subscribe(OURS, "/back", STRING, ours, lambda data, gid: heard.append(data))
    async with joined(carrier), peer("cyclone_peer.py") as other:
        other.do("subscribe", topic="/name", qos=[1, True, True])
        assert (await other.event("message"))["text"] == "latched"
        other.do("subscribe", topic="/chatter", qos=theirs)
        other.do("advertise", topic="/back", qos=theirs)
        await until(lambda: writer.readers == 1, "the reader is known")
        number = 0

        def say() -> bool:
            nonlocal number
            number += 1
            writer.write(string(f"hello {number}"))
            other.do("publish", topic="/back", text=f"back {number}")
            return len(heard) >= 20

        await until(say, "20 messages came")
        first = (await other.event("message", topic="/chatter"))["text"]
        for at in range(int(first.split()[1]) + 1, int(first.split()[1]) + 11):
            assert (await other.event("message", topic="/chatter"))["text"] == f"hello {at}"


@pytest.mark.parametrize("loss", [0.0, pytest.param(0.1, marks=pytest.mark.slow)])
@with_timeout
async def test_large_messages_go_to_cyclone_and_back_in_fragments(loss: float) -> None:
    """Cyclone DDS sends fragments of 1344 bytes."""
    dice, large, heard = random.Random(1), "0123456789" * 16_000, []
    carrier = DdsCarrier(DOMAIN, drops=lambda: dice.random() < loss)
    carrier.publish(OURS, "/large", STRING, LATCHED).write(string(large))
    carrier.subscribe(OURS, "/their_large", STRING, LATCHED, lambda data, gid: heard.append(text_of(data)))
    async with joined(carrier), peer("cyclone_peer.py") as other:
        other.do("subscribe", topic="/large", qos=[1, True, True])
        assert (await other.event("message"))["text"] == large
        other.do("advertise", topic="/their_large", qos=[1, True, True])
        other.do("publish", topic="/their_large", text=large)
        await until(lambda: heard, "the message came")
        assert heard == [large]
