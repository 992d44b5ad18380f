"""One vehicle, as most tests of its parts want it."""

import pytest

from tests.support.mavlink.vehicle_with_stations import VehicleWithStations


@pytest.fixture
def rig():
    """A vehicle with a model of a robot at its helm, and stations that send it one message at a time."""
    return VehicleWithStations()


@pytest.fixture
def armed(rig):
    rig.arm()
    rig.run(1)
    return rig
