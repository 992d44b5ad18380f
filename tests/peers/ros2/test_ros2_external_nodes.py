"""Simulated robots whose Nav2 nodes other programs run: the session leaves them their names, and obeys cmd_vel."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.peers.ros2.action_scripts import NEEDS_RCLPY
from tests.peers.ros2.peer_process import PYTHON, environment
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_domain
from tests.support.programs.processes import Program, until

pytestmark = [NEEDS_RCLPY, pytest.mark.slow]
DOMAIN = free_domain()
CLIENT = Path(__file__).with_name("external_nodes_client.py")
NAVIGATION = {
    "/robot1/behavior_server",
    "/robot1/bt_navigator",
    "/robot1/controller_server",
    "/robot1/global_costmap/global_costmap",
    "/robot1/lifecycle_manager_navigation",
    "/robot1/local_costmap/local_costmap",
    "/robot1/planner_server",
    "/robot1/waypoint_follower",
}
LOCALIZATION = {"/robot1/amcl", "/robot1/lifecycle_manager_localization"}
OF_NAVIGATION = {"/robot1/plan", "/robot1/cmd_vel", "/robot1/navigate_to_pose/_action/status"}
OF_AMCL = {"/robot1/amcl_pose", "/robot1/particle_cloud", "/robot1/believed_pose", "/robot1/lost"}
OF_BODY = {"/robot1/odom", "/robot1/scan", "/robot1/battery_state", "/robot1/map", "/robot1/base_pose_ground_truth"}


@pytest.mark.parametrize("external", ["none", "move_base", "both"])
def test_external_nodes_have_their_names_and_transforms_to_themselves(external: str, tmp_path: Path) -> None:
    (tmp_path / "world.yaml").write_text(f"robots: 1\nexternal_nodes: {external}\nros2: {{domain: {DOMAIN}}}\n")
    session = Program(tmp_path, "simr", "world.yaml", "--ros2", "--server", "127.0.0.1:9")
    try:
        until("the session to join", lambda: "ROS 2:" in session.text, [session])
        done = run_peer([PYTHON, CLIENT], env=environment(DOMAIN), timeout=120.0)
        session.stop()
    finally:
        session.close()
    assert done.returncode == 0, done.stderr + session.text
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    nodes, topics, services = ({*found[kind]} for kind in ("nodes", "topics", "services"))
    localizes, navigates = external != "both", external == "none"
    expected = {"/robot1/map_server"} | (LOCALIZATION if localizes else set())
    assert nodes == expected | (NAVIGATION if navigates else set())
    assert topics & OF_NAVIGATION == (OF_NAVIGATION if navigates else set())
    assert topics & OF_AMCL == (OF_AMCL if localizes else set())
    assert topics >= OF_BODY
    owners = {service.rpartition("/")[0] for service in services}
    assert {owner for owner in owners if owner in NAVIGATION} == (NAVIGATION if navigates else set())
    assert ("/robot1/set_initial_pose" in services) is localizes
    for frames in found["frames"].values():
        assert "robot1/odom robot1/base_footprint" in frames
        assert ("map robot1/odom" in frames) is localizes
