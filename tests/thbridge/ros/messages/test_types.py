import re
from pathlib import Path

import pytest

from tests.support.ros.type_lists import FURTHER_TYPES, SERVICES, STANDARD_TYPES
from thbridge.files.ros.definitions import Definitions
from thbridge.ros.messages.types import OWN_TYPES, TEXTS, full_text, md5_of, plain_definition, service_type

# The sums that ROS Noetic's own tools print.
ROS_MD5 = {
    "tf2_msgs/TFMessage": "94810edda583a504dfda3829e70d7eec",
    "nav_msgs/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "sensor_msgs/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "sensor_msgs/BatteryState": "4ddae7f048e32fda22cac764685e3974",
    "move_base_msgs/MoveBaseActionGoal": "660d6895a1b9a16dce51fbdd9a64a56b",
    "move_base_msgs/MoveBaseActionResult": "1eb06eeff08fa7ea874431638cb52332",
    "move_base_msgs/MoveBaseActionFeedback": "7d1870ff6e0decea702b943b5af0b42e",
    "actionlib_msgs/GoalStatusArray": "8b2b82f13216d0a8ea88bd3af735e619",
    "rosgraph_msgs/Log": "acffd30cd6b6de30f120938c17c593fb",
    "diagnostic_msgs/DiagnosticArray": "60810da900de1dd6ddd437c3503511da",
    "dynamic_reconfigure/ConfigDescription": "757ce9d44ba8ddd801bb30bc456f946f",
    "mavros_msgs/Mavlink": "41093e1fd0f3eea1da2aa33a177e5ba6",
    "mavros_msgs/State": "65cd0a9fff993b062b91e354554ec7e9",
}
ROS_SERVICE_MD5 = {
    "std_srvs/Empty": "d41d8cd98f00b204e9800998ecf8427e",
    "nav_msgs/GetMap": "6cdd0a18e0aff5b0a3ca2326a89b54ff",
    "nav_msgs/SetMap": "c36922319011e63ed7784112ad4fdd32",
    "nav_msgs/GetPlan": "421c8ea4d21c6c9db7054b4bbdf1e024",
    "dynamic_reconfigure/Reconfigure": "bb125d226a21982a4a98760418dc2672",
}


@pytest.mark.parametrize(("msgtype", "md5"), ROS_MD5.items())
def test_sums_are_those_of_ros(msgtype: str, md5: str) -> None:
    assert plain_definition(msgtype).md5 == md5


@pytest.mark.parametrize(("name", "md5"), ROS_SERVICE_MD5.items())
def test_sums_of_services_are_those_of_ros(name: str, md5: str) -> None:
    assert service_type(name).md5 == md5


def test_what_a_service_asks_and_answers_are_messages() -> None:
    for service in map(service_type, SERVICES):
        for msgtype in (service.request, service.response):
            assert re.fullmatch("[0-9a-f]{32}", plain_definition(msgtype).md5)


def test_an_unknown_service_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        service_type("std_srvs/Nonsense")


@pytest.mark.parametrize("msgtype", [*STANDARD_TYPES, *FURTHER_TYPES, *OWN_TYPES])
def test_a_definition_carries_all_it_takes_to_read_the_type(msgtype: str) -> None:
    definition = plain_definition(msgtype)
    assert md5_of(msgtype, definition.text) == definition.md5


def test_an_unknown_type_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        plain_definition("nav_msgs/Nonsense")


def test_full_text_names_each_inner_type_once_outer_before_inner() -> None:
    files = {
        "a_msgs/A": "# a\nHeader header\nB[] many  # of them\nB one\nc_msgs/C[3] other\n",
        "a_msgs/B": "c_msgs/C c\n",
        "c_msgs/C": "uint8 X=1\nfloat64 x\n",
        "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id\n",
    }
    text = full_text("a_msgs/A", files.get)
    assert text is not None
    bar = "=" * 80
    assert text.startswith(files["a_msgs/A"])
    named = [line for line in text.splitlines() if line.startswith("MSG: ")]
    assert named == ["MSG: std_msgs/Header", "MSG: a_msgs/B", "MSG: c_msgs/C"]
    assert text.count(bar) == 3


def test_full_text_is_none_when_an_inner_type_is_missing() -> None:
    assert full_text("a_msgs/A", {"a_msgs/A": "b_msgs/B b\n"}.get) is None


@pytest.mark.parametrize("msgtype", [*STANDARD_TYPES, *FURTHER_TYPES, *OWN_TYPES])
def test_texts_in_bags_are_our_own_whatever_is_installed(msgtype: str) -> None:
    definition = Definitions().of(msgtype)
    assert definition.text == full_text(msgtype, TEXTS.get)
    assert definition.md5 == plain_definition(msgtype).md5


def test_an_installed_text_is_taken_as_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "std_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "String.msg").write_text("# what it says\nstring data\n")
    definition = Definitions([tmp_path]).of("std_msgs/String")
    assert definition.text == "# what it says\nstring data\n"
    assert definition.md5 == plain_definition("std_msgs/String").md5


@pytest.mark.parametrize("content", ["string data\nstring more\n", "this is no definition {"])
def test_an_installed_text_with_other_fields_is_not_taken(tmp_path: Path, content: str) -> None:
    folder = tmp_path / "std_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "String.msg").write_text(content)
    assert Definitions([tmp_path]).of("std_msgs/String") == Definitions().of("std_msgs/String")
