"""The carrier that an address names."""

import asyncio
import dataclasses
from collections.abc import Sequence

import pytest

from tests.support.ros.zenoh_graphs import run
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.ros2.qos import DEFAULT
from thbridge.ros2.supports import MessageSupport
from thbridge.ros2graph.sockets import joining
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.sockets.joining import carrier_of, find_nodes
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.values.address import CarrierKind, Ros2Address
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.addresses import Address
from thbridge.sockets.errors import CannotReach


def test_dds_is_the_default():
    assert isinstance(carrier_of(Ros2Address()), DdsCarrier)


def test_zenoh_goes_to_the_named_router():
    async def scenario():
        carrier = carrier_of(Ros2Address(CarrierKind.ZENOH, router="127.0.0.1:9"))
        assert isinstance(carrier, ZenohCarrier)
        problem = await carrier.start()
        assert isinstance(problem, CannotReach)
        assert problem.address == Address("127.0.0.1", 9)

    run(scenario)


def test_an_invalid_router_is_refused():
    with pytest.raises(ValueError, match="'robot' is not an address"):
        carrier_of(dataclasses.replace(Ros2Address(CarrierKind.ZENOH), router="robot"))


def test_programs_that_speak_for_the_robots_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(joining, "_LOOK_SECONDS", 0.0)
    graph = LoopbackGraph()
    ours, theirs = graph.program(), graph.program()

    def found() -> Sequence[str]:
        return asyncio.run(find_nodes(ours, {"/robot1/amcl"}.__contains__, {"/robot1/odom"}))

    support = MessageSupport("nav_msgs/msg/Odometry", "")
    theirs.subscribe(NodeName("/robot1", "screen"), "/robot1/odom", support, DEFAULT, lambda data, gid: None)
    theirs.publish(NodeName("/robot1", "joystick"), "/robot1/cmd_vel", support, DEFAULT)
    assert found() == ()
    theirs.publish(NodeName("/robot1", "driver"), "/robot1/odom", support, DEFAULT)
    assert found() == ["/robot1/driver"]
    theirs.add_node(NodeName("/robot1", "amcl"))
    assert found() == ["/robot1/amcl", "/robot1/driver"]
