"""ROS 1's own dynamic_reconfigure beside a running session: its Python client, which rqt uses too, and dynparam."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from tests.peers.ros_programs import NEEDS_ROS, PYTHON, Ros, session
from tests.support.programs.processes import Program, until

DYNPARAM = Path("/usr/lib/dynamic_reconfigure/dynparam")

pytestmark = [
    NEEDS_ROS,
    pytest.mark.skipif(
        not DYNPARAM.exists(), reason="python3-dynamic-reconfigure is not installed (see scripts/install_peers.sh)"
    ),
]

# Each change goes out and comes back three ways: the call's answer, what is published, the parameter server.
CLIENT = """
import json, sys
import dynamic_reconfigure, rospy
from dynamic_reconfigure.client import Client

rospy.init_node("client")
client = Client(sys.argv[1], timeout=60)
first = client.get_configuration(timeout=60)
described = client.get_parameter_descriptions(timeout=60)
said = {
    "servers": dynamic_reconfigure.find_reconfigure_services(),
    "first": {name: value for name, value in first.items() if name != "groups"},
    "described": {each["name"]: each for each in described},
    "changes": [],
}
for changes in json.loads(sys.argv[2]):
    answer = client.update_configuration(dict(changes))
    while any(client.get_configuration()[name] != answer[name] for name in changes):
        rospy.sleep(0.05)
    while any(rospy.get_param(sys.argv[1] + "/" + name) != answer[name] for name in changes):
        rospy.sleep(0.05)
    said["changes"].append({name: answer[name] for name in changes})
print(json.dumps(said))
"""


MANIFEST = """<package><name>dynamic_reconfigure</name><version>1.7.3</version><description>-</description>
<maintainer email="nobody@example.org">-</maintainer><license>BSD</license></package>
"""


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros]:
    folder = tmp_path_factory.mktemp("reconfigure")
    # dynparam looks for its own package's manifest, which Debian leaves to a package of compilers' matters.
    (folder / "dynamic_reconfigure").mkdir()
    (folder / "dynamic_reconfigure" / "package.xml").write_text(MANIFEST)
    with session(folder) as (ros, _):
        ros.environment["ROS_PACKAGE_PATH"] = str(folder)
        yield ros


def test_the_client_of_ros_reads_and_turns_numbers_words_and_switches(beside: Ros) -> None:
    changes = [
        {"laser_max_beams": 31},
        {"kld_err": 0.125, "do_beamskip": True},
        {"odom_model_type": "omni"},
        {"laser_model_type": "BEAM"},  # The client itself finds the word among the choices.
        {"laser_max_beams": 100_000, "laser_z_hit": -3.0},
        {"min_particles": 5000},  # More than the most: both stay.
    ]
    said = beside.script(CLIENT, "/robot1/amcl", json.dumps(changes))
    assert isinstance(said, dict)
    assert len([name for name in said["servers"] if name.startswith("/robot2/")]) == 14
    assert "/robot1/move_base/local_costmap/inflation_layer" in said["servers"]
    assert said["first"]["laser_max_beams"] == 60
    assert said["first"]["laser_model_type"] == "likelihood_field"
    beams = said["described"]["laser_max_beams"]
    assert (beams["type"], beams["min"], beams["max"], beams["default"]) == ("int", 2, 4000, 30)
    assert beams["description"] == "number of beams of a scan that are used"
    assert said["changes"] == [
        {"laser_max_beams": 31},
        {"kld_err": 0.125, "do_beamskip": True},
        {"odom_model_type": "omni"},
        {"laser_model_type": "beam"},
        {"laser_max_beams": 4000, "laser_z_hit": 0.0},
        {"min_particles": 100},
    ]


def test_dynparam_lists_saves_and_sets_and_the_robot_obeys(beside: Ros, tmp_path: Path) -> None:
    costmap = "/robot2/move_base/local_costmap"
    listed = beside.says(PYTHON, str(DYNPARAM), "list").split()
    assert {costmap, f"{costmap}/obstacle_layer", "/robot2/move_base/TrajectoryPlannerROS"} <= set(listed)
    saved = tmp_path / "costmap.yaml"
    beside.says(PYTHON, str(DYNPARAM), "dump", costmap, str(saved))
    assert "robot_radius: 0.0" in saved.read_text()
    beside.says(PYTHON, str(DYNPARAM), "load", costmap, str(saved))
    assert "robot_radius" not in beside.says("rosparam", "get", costmap)  # Null, which messages cannot say.
    layer, corners = f"{costmap}/obstacle_layer", [[0.5, 0.25], [-0.5, 0.25], [0.0, -0.75]]
    beside.says(PYTHON, str(DYNPARAM), "set", layer, "combination_method", "Nothing")
    method = f"{layer}/combination_method"
    until("the method to change", lambda: beside.says("rosparam", "get", method).strip() == "99", [])
    beside.says(PYTHON, str(DYNPARAM), "set", costmap, f"{{width: 6.0, footprint: '{corners}'}}")

    def has_corners() -> bool:
        return YAML(typ="safe").load(beside.says("rosparam", "get", f"{costmap}/footprint")) == corners

    def is_wider() -> bool:
        return beside.says("rostopic", "echo", "-n", "1", f"{costmap}/costmap/info/width").split()[0] == "120"

    until("the footprint to change", has_corners, [])
    until("the costmap to be wider", is_wider, [])


@pytest.mark.slow
def test_what_rosparam_sets_dynparam_gets(beside: Ros) -> None:
    beside.says("rosparam", "set", "/robot2/amcl/kld_err", "0.0625")
    asked = (PYTHON, str(DYNPARAM), "get", "/robot2/amcl")
    until("the parameter to change", lambda: "'kld_err': 0.0625" in beside.says(*asked), [])


@pytest.mark.slow
def test_dynparam_corrects_the_stamps_of_real_robots_odometry(beside: Ros, tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots_from: ros\nrobots: 1\nfleet: {odom_time_offset: 0.05}\n")
    master = beside.environment["ROS_MASTER_URI"]
    fleet = Program(tmp_path, "simr", "--study", "study.yaml", "--ros-master", master, "--server", "127.0.0.1:9")
    try:
        listed = (PYTHON, str(DYNPARAM), "list")
        until("the fleet", lambda: "/thbridge_fleet" in beside.says(*listed).split(), [fleet])
        asked = (PYTHON, str(DYNPARAM), "get", "/thbridge_fleet")
        assert "'odom_time_offset': 0.05" in beside.says(*asked)
        beside.says(PYTHON, str(DYNPARAM), "set", "/thbridge_fleet", "odom_time_offset", "0.2")
        assert "'odom_time_offset': 0.2" in beside.says(*asked)
        key = "/thbridge_fleet/odom_time_offset"
        until("the parameter to change", lambda: beside.says("rosparam", "get", key).strip() == "0.2", [fleet])
        until("the change to be told", lambda: f"{key} is 0.2 s now" in fleet.text, [fleet])
    finally:
        fleet.close()
