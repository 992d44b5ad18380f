"""Messages of dynamic_reconfigure's servers, against rosbags' serializer, and their reading of clients' requests."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys.msg import normalize_msgtype

from sim.parameters import RobotParameters, reconfigurable
from sim.parameters.reconfiguration import with_values
from thbridge.ros import reconfigure
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames
from thbridge.ros.reconfigure import ReconfigureServer, Value

STORE = types.typestore()
SOFTWARE = RobotParameters()
SECTIONS = {section.path: section for section in reconfigure.reconfigure_servers()}
LISTS = {"bools": "Bool", "ints": "Int", "strs": "Str", "doubles": "Double"}


def message(msgtype: str, *fields: object) -> object:
    return STORE.types[normalize_msgtype(f"dynamic_reconfigure/{msgtype}")](*fields)


def packed(groups: Sequence[object] = (), **lists: Mapping[str, Value]) -> bytes:
    """A Config by rosbags' serializer: not by the code that is under test."""
    rows = [
        [message(f"{kind}Parameter", name, value) for name, value in lists.get(key, {}).items()]
        for key, kind in LISTS.items()
    ]
    return bytes(STORE.serialize_ros1(message("Config", *rows, list(groups)), normalize_msgtype(types.CONFIG)))


def values(config) -> dict[str, Value]:
    return {row.name: row.value for key in LISTS for row in getattr(config, key)}


def unpacked(data: bytes, msgtype: str):
    known = normalize_msgtype(msgtype)
    read = STORE.deserialize_ros1(data, known)
    assert bytes(STORE.serialize_ros1(read, known)) == data
    return read


def asked(path: str, data: bytes, software: RobotParameters = SOFTWARE) -> dict[str, Value]:
    found = reconfigure.requested_changes(SECTIONS[path], software, data)
    assert not isinstance(found, InvalidMessage), found
    return dict(found)


def test_the_servers_of_a_robot_are_those_of_ros_and_that_of_its_kalman_filter() -> None:
    robot = RobotNames.of(1)
    layers = ("", "/static_layer", "/obstacle_layer", "/inflation_layer")
    inside = [f"{costmap}{layer}" for costmap in ("global_costmap", "local_costmap") for layer in layers]
    planners = ["GlobalPlanner", "TrajectoryPlannerROS", "DWAPlannerROS"]
    assert {section.name(robot) for section in reconfigure.reconfigure_servers()} == {
        "/robot2/amcl",
        "/robot2/ekf",
        "/robot2/move_base",
        *(f"/robot2/move_base/{each}" for each in (*inside, *planners)),
    }


def test_every_live_parameter_is_with_one_server() -> None:
    paths = [parameter.path for section in reconfigure.reconfigure_servers() for parameter in section.parameters]
    assert sorted(paths) == sorted(reconfigurable())


@pytest.mark.parametrize("section", reconfigure.reconfigure_servers(), ids=lambda section: section.path)
def test_values_and_descriptions_can_be_read_by_everybody(section: ReconfigureServer) -> None:
    names = {parameter.name for parameter in section.parameters}
    config = unpacked(reconfigure.config(section, SOFTWARE), types.CONFIG)
    described = unpacked(reconfigure.description(section), types.CONFIG_DESCRIPTION)
    (group,) = described.groups
    assert (group.name, group.id, group.parent) == ("Default", 0, 0)
    assert {row.name for row in group.parameters} == names
    assert all(row.description and row.type in {"bool", "int", "str", "double"} for row in group.parameters)
    for each in (config, described.max, described.min, described.dflt):
        assert values(each).keys() == names
        (state,) = each.groups
        assert (state.name, state.state, state.id, state.parent) == ("Default", True, 0, 0)
    now, least, greatest = values(config), values(described.min), values(described.max)
    for row in group.parameters:
        if row.type in {"int", "double"}:
            assert least[row.name] <= now[row.name] <= greatest[row.name]
        if row.edit_method:
            choices = eval(row.edit_method)["enum"]
            assert now[row.name] in {choice["value"] for choice in choices}
            assert {choice["type"] for choice in choices} == {row.type}


def test_a_description_is_the_fields() -> None:
    described = unpacked(reconfigure.description(SECTIONS["amcl"]), types.CONFIG_DESCRIPTION)
    rows = {row.name: row for row in described.groups[0].parameters}
    assert rows["update_min_d"].type == "double"
    assert rows["update_min_d"].description == "distance driven before the next filter update [m]"
    assert rows["update_min_d"].edit_method == ""
    models = eval(rows["odom_model_type"].edit_method)["enum"]
    assert [choice["name"] for choice in models] == ["diff", "diff-corrected", "omni", "omni-corrected"]
    assert (values(described.min)["laser_max_beams"], values(described.max)["laser_max_beams"]) == (2, 4000)
    assert values(described.max)["laser_max_range"] == math.inf
    # ROS's default, not our study's.
    assert values(described.dflt)["laser_max_beams"] == 30
    assert values(unpacked(reconfigure.config(SECTIONS["amcl"], SOFTWARE), types.CONFIG))["laser_max_beams"] == 60


def test_numbers_that_ros_names_are_named() -> None:
    described = unpacked(reconfigure.description(SECTIONS["local_costmap.obstacle_layer"]), types.CONFIG_DESCRIPTION)
    (row,) = (row for row in described.groups[0].parameters if row.name == "combination_method")
    choices = {choice["name"]: choice["value"] for choice in eval(row.edit_method)["enum"]}
    assert choices == {"Overwrite": 0, "Maximum": 1, "Nothing": 99}


def test_what_is_asked_is_what_changes() -> None:
    data = packed(
        [message("GroupState", "Default", False, 0, 0)],
        bools={"do_beamskip": True},
        ints={"min_particles": 200, "max_particles": SOFTWARE.amcl.max_particles},
        strs={"odom_model_type": "omni"},
        doubles={"kld_err": 0.02, "laser_z_hit": SOFTWARE.amcl.laser_z_hit},
    )
    assert asked("amcl", data) == {
        "amcl.do_beamskip": True,
        "amcl.min_particles": 200,
        "amcl.odom_model_type": "omni",
        "amcl.kld_err": 0.02,
    }


def test_beyond_its_bounds_a_value_is_the_bound() -> None:
    data = packed(
        ints={"min_particles": -5, "laser_max_beams": 2**31 - 1},
        doubles={"kld_err": -math.inf, "laser_max_range": -7.0, "update_min_d": 5.0001},
    )
    assert asked("amcl", data) == {
        "amcl.min_particles": 1,
        "amcl.laser_max_beams": 4000,
        "amcl.kld_err": 0.0,
        "amcl.update_min_d": 5.0,
    }  # laser_max_range is at its least already


def test_what_the_server_does_not_know_is_passed_over() -> None:
    data = packed(
        bools={"restore_defaults": True, "kld_err": True},
        ints={"update_min_d": 3},
        strs={"": "", "max_particles": "many"},
        doubles={"initial_pose_x": 1.0},
    )
    assert asked("amcl", data) == {}


def test_a_footprint_is_text_as_in_ros() -> None:
    corners = "[[0.3, 0.2], [-0.3, 0.2], [0.0, -0.2]]"
    found = asked("local_costmap", packed(strs={"footprint": corners}))
    assert found == {"local_costmap.footprint": corners}
    after = with_values(SOFTWARE, tuple(found.items()))
    assert isinstance(after, RobotParameters)
    config = values(unpacked(reconfigure.config(SECTIONS["local_costmap"], after), types.CONFIG))
    assert json.loads(str(config["footprint"])) == [[0.3, 0.2], [-0.3, 0.2], [0.0, -0.2]]
    assert asked("local_costmap", packed(strs={"footprint": str(config["footprint"])}), after) == {}


def test_no_value_is_told_as_zero_and_stays_none_when_it_comes_back() -> None:
    assert SOFTWARE.local_costmap.robot_radius is None
    section = SECTIONS["local_costmap"]
    assert values(unpacked(reconfigure.config(section, SOFTWARE), types.CONFIG))["robot_radius"] == 0.0
    assert asked("local_costmap", packed(doubles={"robot_radius": 0.0})) == {}
    assert asked("local_costmap", packed(doubles={"robot_radius": 0.3})) == {"local_costmap.robot_radius": 0.3}


@pytest.mark.parametrize("section", reconfigure.reconfigure_servers(), ids=lambda section: section.path)
def test_all_sent_back_as_it_was_told_changes_nothing(section: ReconfigureServer) -> None:
    assert reconfigure.requested_changes(section, SOFTWARE, reconfigure.config(section, SOFTWARE)) == ()


def test_values_that_are_not_floats_in_the_study_are_doubles_all_the_same() -> None:
    whole = replace(SOFTWARE, amcl=replace(SOFTWARE.amcl, laser_sigma_hit=1))
    assert values(unpacked(reconfigure.config(SECTIONS["amcl"], whole), types.CONFIG))["laser_sigma_hit"] == 1.0


@given(st.data())
def test_what_is_asked_is_in_force_or_within_the_bounds(data: st.DataObject) -> None:
    section = data.draw(st.sampled_from(reconfigure.reconfigure_servers()))
    numbers = [each for each in section.parameters if each.kind in {"int", "double"}]
    if not numbers:
        return
    parameter = data.draw(st.sampled_from(numbers))
    whole = parameter.kind == "int"
    value = data.draw(st.integers(-(2**31), 2**31 - 1) if whole else st.floats(allow_nan=False, allow_infinity=False))
    request = packed(**{"ints" if whole else "doubles": {parameter.name: value}})
    found = asked(section.path, request).get(parameter.path, parameter.reported(SOFTWARE))
    assert parameter.minimum <= found <= parameter.maximum
    if parameter.minimum <= value <= parameter.maximum:
        assert found == value


@given(st.binary(max_size=200))
def test_whatever_comes_is_a_change_or_refused(data: bytes) -> None:
    for section in reconfigure.reconfigure_servers():
        found = reconfigure.requested_changes(section, SOFTWARE, data)
        assert isinstance(found, tuple | InvalidMessage)


def test_a_request_that_ends_too_early_is_refused() -> None:
    found = reconfigure.requested_changes(SECTIONS["amcl"], SOFTWARE, packed(doubles={"kld_err": 0.02})[:20])
    assert isinstance(found, InvalidMessage)
    assert "ends too early" in found.sentence
