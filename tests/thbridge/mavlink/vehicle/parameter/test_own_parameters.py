"""What ground stations may tell a vehicle itself."""

import pytest

from tests.support.mavlink.vehicle_with_stations import SECOND, US, VehicleWithStations, messages
from thbridge.mavlink.values.options import Failsafe
from thbridge.mavlink.wire.dialect import mav

REAL32 = mav.MAV_PARAM_TYPE_REAL32
READ_ONLY, OUT_OF_RANGE = mav.MAV_PARAM_ERROR_READ_ONLY, mav.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE


def change(rig, name, value):
    """Set a parameter; the errors and the values that are answered."""
    said = rig.hear(mav.MAVLink_param_set_message(3, 1, name.encode(), value, REAL32))
    errors = [message.error for message in messages(said, "PARAM_ERROR")]
    return errors, [(message.param_id, message.param_value) for message in messages(said, "PARAM_VALUE")]


def test_they_come_before_those_of_the_robot():
    rig = VehicleWithStations(failsafe=Failsafe.HOME, lost_after=2.5)
    rig.hear(mav.MAVLink_param_request_list_message(3, 1))
    told = [(each.param_id, each.param_value) for each in messages(rig.run(20), "PARAM_VALUE")]
    assert told[:3] == [("SYSID_THISMAV", 3.0), ("FS_GCS_TIMEOUT", 2.5), ("FS_ACTION", 1.0)]
    assert told[3:] == [*rig.robot.values.items()]


@pytest.mark.parametrize("failsafe", Failsafe)
def test_the_failsafe_is_told_as_ardupilot_numbers_it(failsafe):
    rig = VehicleWithStations(failsafe=failsafe)
    number = {Failsafe.CONTINUE: 0.0, Failsafe.HOME: 1.0, Failsafe.STOP: 2.0}[failsafe]
    assert change(rig, "FS_ACTION", number) == ([], [("FS_ACTION", number)])


def test_who_sends_the_robot_home_on_its_loss_finds_it_on_its_way_there():
    rig = VehicleWithStations(failsafe=Failsafe.STOP, lost_after=5.0)
    assert change(rig, "FS_ACTION", 1.0) == ([], [("FS_ACTION", 1.0)])
    assert change(rig, "FS_GCS_TIMEOUT", 2.0) == ([], [("FS_GCS_TIMEOUT", 2.0)])
    rig.arm()
    rig.run(SECOND, beating=(US,))
    rig.run(SECOND)
    assert not rig.robot.calls("go_to")
    rig.run(2 * SECOND)
    assert len(rig.robot.calls("go_to")) == 1


@pytest.mark.parametrize(
    ("name", "value", "error", "old"),
    [
        ("SYSID_THISMAV", 4.0, READ_ONLY, 3.0),
        ("FS_GCS_TIMEOUT", 0.5, OUT_OF_RANGE, 5.0),
        ("FS_GCS_TIMEOUT", 601.0, OUT_OF_RANGE, 5.0),
        ("FS_ACTION", 3.0, OUT_OF_RANGE, 2.0),
        ("FS_ACTION", 0.5, OUT_OF_RANGE, 2.0),
    ],
)
def test_what_cannot_be_is_refused_with_the_old_value_and_a_sentence(name, value, error, old):
    rig = VehicleWithStations()
    assert change(rig, name, value) == ([error], [(name, old)])
    assert any(text.startswith(f"{name} is ") for text in rig.texts())


def test_the_same_again_is_no_change_even_of_what_is_fixed():
    assert change(VehicleWithStations(), "SYSID_THISMAV", 3.0) == ([], [("SYSID_THISMAV", 3.0)])


def test_those_of_the_robot_are_the_robots():
    rig = VehicleWithStations()
    assert change(rig, "PARAM_03", 7.0) == ([], [("PARAM_03", 7.0)])
    assert rig.robot.values["PARAM_03"] == 7.0
    assert [message.param_value for message in messages(rig.hear(read("PARAM_03")), "PARAM_VALUE")] == [7.0]
    assert [message.param_value for message in messages(rig.hear(read("FS_ACTION")), "PARAM_VALUE")] == [2.0]


def read(name):
    return mav.MAVLink_param_request_read_message(3, 1, name.encode(), -1)
