"""Types of ROS 2's distributions: hashes, default values, bytes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from thbridge.ros2.distribution import DISTRIBUTIONS, Distribution
from thbridge.ros2.interfaces import MessageDefinition, messages_in, parsed, written

JAZZY, KILTED = Distribution.of("jazzy"), Distribution.of("kilted")
GOAL = "nav2_msgs/action/NavigateToPose_SendGoal_Request"

HASHES = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "nav_msgs/msg/OccupancyGrid": "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7",
    "service_msgs/msg/ServiceEventInfo": "41bcbbe07a75c9b52bc96bfd5c24d7f0fc0a08c0cb7921b3373c5732345a6f45",
    "std_srvs/srv/SetBool": "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
    "std_srvs/srv/SetBool_Event": "3c4c20015afb4303eafd347b1d6a786f171a89c814726961a9593ef10df878cf",
    "nav2_msgs/action/NavigateToPose": "a56dba8a3234a1215e610180dc703ae25bbf406dded8b54887891c9732857eab",
    "thbridge_msgs/msg/Score": "55e14f5259d7738a5d8c28a8b92be5162456bbe2963f1ca595242ddc48e76063",
}
"""Hashes that rosidl computed. tests/peers/ros2 compares all types."""


def names(distribution: Distribution) -> list[str]:
    """All messages of the distribution's own texts, without services and actions themselves."""
    texts = DISTRIBUTIONS[distribution.name][1]
    return [name for whole in texts for name in messages_in(whole, texts[whole]) if name != whole or "/msg/" in name]


@pytest.mark.parametrize("name", HASHES)
def test_hashes_are_those_of_rosidl(name: str) -> None:
    assert KILTED.message(name).hash == f"RIHS01_{HASHES[name]}"


def test_the_distributions_differ_in_the_documented_types() -> None:
    types = {name for _, texts in DISTRIBUTIONS.values() for name in texts}
    differing = set()
    for name in types:
        try:
            if JAZZY.message(name).hash != KILTED.message(name).hash:
                differing.add(name)
        except KeyError:
            differing.add(name)
    assert differing == {
        "nav2_msgs/action/FollowWaypoints",
        "nav2_msgs/msg/MissedWaypoint",
        "nav2_msgs/msg/WaypointStatus",
        "nav2_msgs/srv/ClearCostmapAroundPose",
        "nav2_msgs/srv/GetCost",
        "nav2_msgs/srv/GetCosts",
        "nav2_msgs/srv/IsPathValid",
    }
    with pytest.raises(KeyError):
        JAZZY.message("nav_msgs/msg/Goals")


def test_an_action_names_its_services_and_messages() -> None:
    action = KILTED.action("nav2_msgs/action/NavigateToPose")
    assert action.send_goal.request.dds_name == "nav2_msgs::action::dds_::NavigateToPose_SendGoal_Request_"
    assert action.get_result.response.name == "nav2_msgs/action/NavigateToPose_GetResult_Response"
    assert action.cancel_goal.name == "action_msgs/srv/CancelGoal"
    assert action.feedback.name == "nav2_msgs/action/NavigateToPose_FeedbackMessage"
    assert KILTED.constant("nav2_msgs/action/NavigateToPose_Result", "TIMEOUT") == 9003


def test_fields_that_are_not_given_have_the_default_values_of_ros() -> None:
    goal = KILTED.make(GOAL, goal_id=KILTED.make("unique_identifier_msgs/msg/UUID", uuid=bytes(range(16))))
    again = KILTED.decode(GOAL, KILTED.encode(GOAL, goal))
    assert again.goal.pose.pose.orientation.w == 1.0
    assert bytes(again.goal_id.uuid) == bytes(range(16))
    request = KILTED.make("type_description_interfaces/srv/GetTypeDescription_Request")
    assert request.include_type_sources is True
    with pytest.raises(TypeError, match="no_such_field"):
        KILTED.make("std_msgs/msg/String", no_such_field=1)
    with pytest.raises(KeyError):
        KILTED.make("std_msgs/msg/NoSuchType")


def test_a_message_without_fields_is_one_byte() -> None:
    name = "std_srvs/srv/Trigger_Request"
    assert KILTED.encode(name, KILTED.make(name)) == b"\0\1\0\0\0"


def test_sequences_of_numbers_may_be_given_as_lists() -> None:
    scan = KILTED.make("sensor_msgs/msg/LaserScan", ranges=[1.0, 2.5])
    assert scan.ranges.dtype == np.float32
    assert KILTED.decode("sensor_msgs/msg/LaserScan", KILTED.encode("sensor_msgs/msg/LaserScan", scan)).ranges[1] == 2.5


@pytest.mark.parametrize("distribution", [JAZZY, KILTED], ids=lambda each: each.name)
def test_all_types_can_be_written_and_read(distribution: Distribution) -> None:
    for name in names(distribution):
        data = distribution.encode(name, distribution.make(name))
        assert distribution.encode(name, distribution.decode(name, data)) == data, name


@given(
    name=st.sampled_from([GOAL, "rcl_interfaces/srv/SetParameters_Request", "nav_msgs/msg/OccupancyGrid"]),
    data=st.binary(max_size=200),
    head=st.sampled_from([b"", b"\0\0\0\0", b"\0\1\0\0"]),
)
def test_any_bytes_are_a_message_or_a_value_error(name: str, data: bytes, head: bytes) -> None:
    try:
        value = KILTED.decode(name, head + data)
    except ValueError:
        return
    again = KILTED.encode(name, value)
    assert KILTED.encode(name, KILTED.decode(name, again)) == again


def test_sources_of_an_action_are_those_of_a_node_of_rclpy() -> None:
    sources = KILTED.sources("nav2_msgs/action/NavigateToPose")
    assert sources[0].encoding == "action"
    assert sources[0].raw_file_contents.count("---") == 2
    encodings = {source.type_name: source.encoding for source in sources}
    assert encodings["nav2_msgs/action/NavigateToPose_Goal"] == "implicit"
    assert encodings["geometry_msgs/msg/Pose"] == "msg"
    assert [source.raw_file_contents for source in sources if source.encoding == "implicit"] == [""] * 12


def test_a_written_definition_is_read_as_the_same() -> None:
    for name in get_typestore(Stores.ROS2_KILTED).fielddefs:
        definition = KILTED.definition(name)
        again = parsed(name, written(definition))
        assert again == MessageDefinition(definition.constants, definition.fields, dict(definition.defaults)), name
