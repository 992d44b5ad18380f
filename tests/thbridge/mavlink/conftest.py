"""One vehicle, as most tests of its parts want it."""

import pytest

from tests.thbridge.mavlink.rig import Rig


@pytest.fixture
def rig():
    return Rig()


@pytest.fixture
def armed(rig):
    rig.arm()
    rig.run(1)
    return rig
