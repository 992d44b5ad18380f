"""The numbers by which ground stations know modes."""

import pytest
from pymavlink import mavutil

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.mavlink.wire.mode_numbers import Mode, custom_mode, mode_from_standard, requested_mode, standard_mode

ROVER = {name: number for number, name in mavutil.mode_mapping_rover.items()}
PX4 = {"HOLD": "LOITER", "GUIDED": "OFFBOARD", "AUTO": "MISSION", "RTL": "RTL", "MANUAL": "MANUAL"}


@pytest.mark.parametrize("identity", AutopilotIdentity)
@pytest.mark.parametrize("mode", Mode)
def test_the_number_that_is_shown_can_be_asked_for(identity, mode):
    assert requested_mode(identity, custom_mode(identity, mode), 0) is mode


@pytest.mark.parametrize("mode", Mode)
@pytest.mark.parametrize("identity", AutopilotIdentity)
def test_every_vehicle_knows_ardupilot_s_numbers(identity, mode):
    # As mavutil and MAVProxy send them to everything that is not PX4's.
    assert requested_mode(identity, ROVER[mode.value], 0) is mode


@pytest.mark.parametrize("mode", Mode)
def test_px4_s_names_are_what_mavutil_makes_of_the_number(mode):
    base_mode = 0xFF  # All of the flags that some of its names ask for.
    assert mavutil.interpret_px4_mode(base_mode, custom_mode(AutopilotIdentity.GENERIC, mode)) == PX4[mode.value]


@pytest.mark.parametrize(
    ("main", "sub", "mode"),
    [(4, 3, "HOLD"), (4, 4, "AUTO"), (4, 5, "RTL"), (6, 0, "GUIDED"), (1, 0, "MANUAL"), (3, 0, "MANUAL")],
)
def test_main_and_sub_modes_are_px4_s(main, sub, mode):
    assert requested_mode(AutopilotIdentity.GENERIC, main, sub) == mode
    assert requested_mode(AutopilotIdentity.GENERIC, main << 16 | sub << 24, 0) == mode


@pytest.mark.parametrize(("main", "sub"), [(4, 9), (7, 0), (200, 0), (0xFFFFFFFF, 0), (1 << 40, 0)])
@pytest.mark.parametrize("identity", AutopilotIdentity)
def test_other_numbers_are_no_mode(identity, main, sub):
    assert requested_mode(identity, main, sub) is None


def test_standard_modes_are_modes():
    known = {mode: standard_mode(mode) for mode in Mode if standard_mode(mode)}
    assert set(known) == {Mode.RETURN, Mode.AUTO}
    assert all(mode_from_standard(code) is mode for mode, code in known.items())
    assert mode_from_standard(1) is None
