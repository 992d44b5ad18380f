"""One vehicle, as most tests of its parts want it."""

import pytest

from tests.support.mavlink.vehicle_with_stations import Rig


@pytest.fixture
def rig():
    return Rig()


@pytest.fixture
def armed(rig):
    rig.arm()
    rig.run(1)
    return rig
