"""How rclpy sees our nodes on DDS and how we see its nodes, and programs that leave, restart, or lose datagrams."""

import random

import pytest

from tests.peers.ros2.peer_messages import GRID, SET_BOOL, STRING, grid, request, response, string, text_of
from tests.peers.ros2.peer_process import DOMAIN, PeerProcess, joined, needs_ros2, peer, until, with_timeout
from thbridge.ros2.qos import DEFAULT, LATCHED, SENSOR_DATA, DeliveryReliability, Durability, QosProfile
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import EndpointRole, NodeName

pytestmark = needs_ros2

OURS = NodeName("/robot1", "ours")
LOSS = 0.2
ROBOTS, NODES, SERVICES = 10, 7, 7
"""A session has 10 robots, each of them 7 nodes, and each of these 7 services: 980 endpoints."""


async def graph_when(other: PeerProcess, node: NodeName, topics: list[str], is_there: str) -> dict:
    """The graph as rclpy sees it, once a part is there."""
    while True:
        other.do("graph", node=node.name, namespace=node.namespace, topics=topics)
        found = await other.event("graph")
        if found.get(is_there):
            return found


@with_timeout
async def test_rclpy_sees_our_nodes_and_their_endpoints() -> None:
    carrier = DdsCarrier(DOMAIN)
    carrier.add_node(NodeName("/", "silent"))
    carrier.publish(OURS, "/robot1/map_name", STRING, LATCHED)
    carrier.publish(OURS, "/robot1/scan_name", STRING, SENSOR_DATA)
    carrier.subscribe(OURS, "/robot1/command", STRING, DEFAULT, lambda data, gid: None)
    carrier.serve(OURS, "/robot1/enable", SET_BOOL, lambda data, gid, reply: None)
    carrier.client(OURS, "/lift/enable", SET_BOOL)
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        topics = ["/robot1/map_name", "/robot1/scan_name", "/robot1/command"]
        found = await graph_when(other, OURS, topics, "clients")
        assert found["nodes"] == ["/peer/theirs", "/robot1/ours", "/silent"]
        assert found["services"] == [["/robot1/enable", [SET_BOOL.name]]]
        assert found["clients"] == [["/lift/enable", [SET_BOOL.name]]]
        assert found["published"] == [[topics[0], [STRING.name]], [topics[1], [STRING.name]]]
        assert found["subscribed"] == [[topics[2], [STRING.name]]]
        common = {"node": "/robot1/ours", "type": STRING.name, "hash": STRING.hash}
        (latched,) = found["publishers"][topics[0]]
        (sensor,) = found["publishers"][topics[1]]
        (command,) = found["subscriptions"][topics[2]]
        assert latched == {**common, "reliable": True, "latched": True, "depth": 1, "gid": latched["gid"]}
        assert sensor == {**common, "reliable": False, "latched": False, "depth": 5, "gid": sensor["gid"]}
        assert command == {**common, "reliable": True, "latched": False, "depth": 10, "gid": command["gid"]}


@with_timeout
async def test_we_see_nodes_and_endpoints_of_rclpy() -> None:
    carrier = DdsCarrier(DOMAIN)
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        other.do("advertise", topic="/map_name", type_name=STRING.name, qos=[1, True, True])
        other.do("subscribe", topic="/scan_name", type_name=STRING.name, qos=[5, False, False])
        other.do("serve", service="/peer/enable")
        other.do("call", service="/lift/enable", data=True)
        wanted = {"/map_name", "/scan_name", "/peer/enable", "/lift/enable"}
        await until(lambda: {e.name for e in carrier.endpoints() if e.node} >= wanted, "the endpoints are known")
        found = {each.name: each for each in carrier.endpoints()}
        assert carrier.nodes() == [NodeName("/peer", "theirs")]
        assert {name: found[name].role for name in wanted} == {
            "/map_name": EndpointRole.PUBLISHER,
            "/scan_name": EndpointRole.SUBSCRIPTION,
            "/peer/enable": EndpointRole.SERVER,
            "/lift/enable": EndpointRole.CLIENT,
        }
        name = found["/map_name"]
        assert (name.node, name.type, name.hash) == (NodeName("/peer", "theirs"), STRING.name, STRING.hash)
        assert (name.qos.reliability, name.qos.durability) == (DeliveryReliability.RELIABLE, Durability.TRANSIENT_LOCAL)
        assert found["/scan_name"].qos.reliability == DeliveryReliability.BEST_EFFORT
        assert found["/peer/enable"].type == SET_BOOL.name
        assert carrier.node_of(name.gid) == "/peer/theirs"
        await other.end()
        await until(lambda: not carrier.nodes() and not carrier.endpoints(), "the peer has left")


@with_timeout
async def test_rclpy_forgets_us_when_we_leave() -> None:
    carrier = DdsCarrier(DOMAIN)
    carrier.add_node(OURS)
    async with peer("rclpy_peer.py", "theirs", "/peer") as other:
        async with joined(carrier):
            nodes = []
            while "/robot1/ours" not in nodes:
                other.do("graph", node="", namespace="/", topics=[])
                nodes = (await other.event("graph"))["nodes"]
        while "/robot1/ours" in nodes:
            other.do("graph", node="", namespace="/", topics=[])
            nodes = (await other.event("graph"))["nodes"]


@with_timeout
async def test_a_restarted_peer_gets_messages_while_the_killed_one_is_not_yet_forgotten() -> None:
    carrier = DdsCarrier(DOMAIN)
    writer = carrier.publish(OURS, "/chatter", STRING, LATCHED)
    writer.write(string("hello"))
    async with joined(carrier):
        async with peer("rclpy_peer.py", "theirs", "/peer") as first:
            first.do("subscribe", topic="/chatter", type_name=STRING.name, qos=[1, True, True])
            await first.event("message")
            first.kill()
        writer.write(string("again"))
        async with peer("rclpy_peer.py", "theirs", "/peer") as second:
            second.do("subscribe", topic="/chatter", type_name=STRING.name, qos=[1, True, True])
            assert text_of(bytes.fromhex((await second.event("message"))["data"])) == "again"


@pytest.mark.slow
@pytest.mark.parametrize("script", [("rclpy_peer.py", "theirs", "/peer"), ("cyclone_peer.py",)])
@with_timeout
async def test_reliable_messages_and_services_survive_loss(script: tuple[str, ...]) -> None:
    """Every fifth datagram is lost, in both directions."""
    dice = random.Random(1)
    heard, answers = [], []
    carrier = DdsCarrier(DOMAIN, drops=lambda: dice.random() < LOSS)
    kept = QosProfile(400)
    writer = carrier.publish(OURS, "/chatter", STRING, kept)
    latched = carrier.publish(OURS, "/map", GRID, LATCHED)
    carrier.subscribe(OURS, "/back", STRING, kept, lambda data, gid: heard.append(text_of(data)))
    carrier.serve(OURS, "/enable", SET_BOOL, lambda data, gid, reply: reply(response(success=True, message="ours")))
    client = carrier.client(OURS, "/peer/enable", SET_BOOL)
    is_rclpy = len(script) > 1
    kind = {"type_name": STRING.name} if is_rclpy else {}
    async with joined(carrier), peer(*script) as other:
        other.do("subscribe", topic="/chatter", qos=[400, True, False], **kind)
        other.do("advertise", topic="/back", qos=[400, True, False], **kind)
        other.do("serve", service="/peer/enable")
        await until(lambda: writer.readers == 1 and client.has_server, "the peer is known")
        for at in range(100):
            writer.write(string(f"{at}"))
            if is_rclpy:
                other.do("publish", topic="/back", data=string(f"{at}").hex())
            else:
                other.do("publish", topic="/back", text=f"{at}")
        for at in range(100):
            message = await other.event("message", topic="/chatter")
            assert (text_of(bytes.fromhex(message["data"])) if is_rclpy else message["text"]) == f"{at}"
        await until(lambda: heard[-1:] == ["99"], "the last message came")
        assert heard == [str(at) for at in range(int(heard[0]), 100)]
        for at in range(10):
            client.call(request(data=True), answers.append)
            await until(lambda at=at: len(answers) == at + 1, "the response came")
        other.do("call", service="/enable", data=True)
        assert (await other.event("response"))["message"] == "ours"
        if is_rclpy:
            latched.write(grid(400, 400))
            other.do("subscribe", topic="/map", type_name=GRID.name, qos=[1, True, True])
            assert bytes.fromhex((await other.event("message", topic="/map"))["data"]) == grid(400, 400)


@with_timeout
async def test_a_thousand_endpoints_are_announced() -> None:
    carrier = DdsCarrier(DOMAIN)
    for robot in range(ROBOTS):
        for number in range(NODES):
            node = NodeName(f"/robot{robot}", f"node{number}")
            for service in range(SERVICES):
                name = f"{node.whole}/service{service}"
                carrier.serve(node, name, SET_BOOL, lambda data, gid, reply: None)
    last = NodeName(f"/robot{ROBOTS - 1}", f"node{NODES - 1}")
    async with joined(carrier), peer("rclpy_peer.py", "theirs", "/peer") as other:
        services = []
        while len(services) < SERVICES:
            found = await graph_when(other, last, [], "services")
            services = found["services"]
        assert len(found["nodes"]) == ROBOTS * NODES + 1
