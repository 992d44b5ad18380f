"""The carrier that an address names."""

import dataclasses

import pytest

from tests.support.ros.zenoh_graphs import run
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.sockets.joining import carrier_of
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.ros2graph.values.address import CarrierKind, Ros2Address
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
