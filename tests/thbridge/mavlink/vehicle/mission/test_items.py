"""Items on their way through both forms of their message."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.mavlink.values.vehicle_interface import Station
from thbridge.mavlink.vehicle.mission.ids import plan_id
from thbridge.mavlink.vehicle.mission.items import MissionItem, item_of, message_of, old_message_of, unfit
from thbridge.mavlink.wire.dialect import decoded, mav, payload_of

STATION = Station(255, 190)
INTEGERS = st.integers(-(2**31), 2**31 - 1)
FLOATS = st.floats(width=32, allow_nan=False)
ITEMS = st.builds(
    MissionItem,
    command=st.integers(0, 2**16 - 1),
    frame=st.integers(0, 255),
    params=st.tuples(*[FLOATS | st.just(math.nan)] * 4),
    x=INTEGERS,
    y=INTEGERS,
    z=FLOATS,
    autocontinue=st.booleans(),
)


def carried(message):
    """The same message behind its bytes."""
    return decoded(message.get_msgId(), payload_of(message))


@given(ITEMS, st.integers(0, 2**16 - 1), st.booleans())
def test_what_came_goes_out_again_bit_for_bit(item, seq, current):
    message = carried(message_of(item, seq, current, STATION))
    assert item_of(message) == item
    assert (message.seq, message.current, message.target_system, message.target_component) == (seq, current, 255, 190)


@given(st.integers(-90 * 10**7, 90 * 10**7), st.integers(-180 * 10**7, 180 * 10**7))
def test_in_the_form_of_old_degrees_are_good_to_a_metre(latitude, longitude):
    item = MissionItem(mav.MAV_CMD_NAV_WAYPOINT, mav.MAV_FRAME_GLOBAL, x=latitude, y=longitude)
    message = carried(old_message_of(item, 0, False, STATION))
    again = item_of(message)
    # 32-bit floats of up to 180 are some 1.5e-5 apart, 0.9 m to either side.
    assert again.x == pytest.approx(latitude, abs=80)
    assert again.y == pytest.approx(longitude, abs=80)


@given(st.integers(-(10**6), 10**6), st.integers(-(10**6), 10**6))
def test_in_the_form_of_old_metres_are_as_good_as_ever(x, y):
    item = MissionItem(mav.MAV_CMD_NAV_WAYPOINT, mav.MAV_FRAME_LOCAL_NED, x=x, y=y)
    assert item_of(carried(old_message_of(item, 0, False, STATION))) == item


@given(ITEMS, st.integers(0, 700))
def test_any_item_is_fit_or_has_a_reason(item, count):
    reason = unfit(item, count)
    assert reason is None or (0 < reason.result < 16 and reason.sentence)


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (mav.MAV_CMD_NAV_TAKEOFF, "command 22 (MAV_CMD_NAV_TAKEOFF) is not for these robots"),
        (41999, "command 41999 (no command of the dialect) is not for these robots"),
        (65535, "command 65535 (no command of the dialect) is not for these robots"),
    ],
)
def test_a_command_that_is_not_for_robots_is_told_with_those_that_are(command, told):
    reason = unfit(MissionItem(command, mav.MAV_FRAME_GLOBAL), 1)
    assert reason.sentence.startswith(f"{told}, whose commands are 16, 17, 19, 20, ")


@given(st.lists(ITEMS, max_size=4), st.lists(ITEMS, max_size=4))
def test_plans_have_equal_ids_if_they_are_equal(one, other):
    # Zero and minus zero are equal, but two plans on the wire.
    on_wire = [[payload_of(message_of(item, 0, False, STATION)) for item in plan] for plan in (one, other)]
    assert (plan_id(one) == plan_id(other)) == (on_wire[0] == on_wire[1])
    assert plan_id(one) in range(2**32)
