"""A session's nodes on a ROS 2 graph in memory, with and without nodes that other programs run."""

import asyncio
import dataclasses
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.app.compose.recording import build_publisher, build_team_description
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.app.live_graph.client_messages import ClientRequests
from thbridge.app.live_graph.live_ros2 import LiveRos2Graph
from thbridge.ros import names
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.pack import Transform
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import DEFAULT, TF
from thbridge.ros2graph.sockets import joining
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.study_file import Study

JAZZY = Distribution.of("jazzy")
TFMESSAGE = "tf2_msgs/msg/TFMessage"


def session(
    external: ExternalNodes = ExternalNodes.NONE, distribution: Distribution = JAZZY
) -> tuple[LoopbackGraph, LiveRos2Graph]:
    setting = read_setting(dataclasses.replace(Study(), robots=1, external_nodes=external), Path())
    graph = LoopbackGraph()
    team, publisher = build_team(setting), build_publisher(setting)
    description = build_team_description(setting, publisher)
    return graph, LiveRos2Graph(graph.program(), distribution, description, team, ClientRequests(lambda *_: None))


@pytest.mark.parametrize("external", ExternalNodes)
def test_external_nodes_that_run_before_the_session_are_no_rivals(
    external: ExternalNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(joining, "_LOOK_SECONDS", 0.0)
    graph, live = session(external)
    graph.program().publish(NodeName("/robot1", "driver"), "/robot1/tf", JAZZY.message(TFMESSAGE), TF)
    assert asyncio.run(live.join()) == (["/robot1/driver"] if external is ExternalNodes.NONE else ())


@pytest.mark.parametrize("external", ExternalNodes)
def test_nodes_of_other_programs_keep_their_topics_services_and_transforms(external: ExternalNodes) -> None:
    graph, live = session(external)
    other = graph.program()
    offered = {(endpoint.role, endpoint.name) for endpoint in other.endpoints()}
    nodes = {endpoint.node.name for endpoint in other.endpoints() if endpoint.node is not None}

    navigates, localizes = external is ExternalNodes.NONE, external is not ExternalNodes.BOTH
    assert "map_server" in nodes
    assert ("bt_navigator" in nodes, "amcl" in nodes) == (navigates, localizes)
    for role, name, ours in (
        (EndpointRole.PUBLISHER, "/robot1/odom", True),
        (EndpointRole.PUBLISHER, "/robot1/scan", True),
        (EndpointRole.SUBSCRIPTION, "/robot1/cmd_vel", True),
        (EndpointRole.PUBLISHER, "/robot1/cmd_vel", navigates),
        (EndpointRole.PUBLISHER, "/robot1/plan", navigates),
        (EndpointRole.SUBSCRIPTION, "/robot1/goal_pose", navigates),
        (EndpointRole.SERVER, "/robot1/navigate_to_pose/_action/send_goal", navigates),
        (EndpointRole.SERVER, "/robot1/bt_navigator/set_parameters", navigates),
        (EndpointRole.PUBLISHER, "/robot1/amcl_pose", localizes),
        (EndpointRole.PUBLISHER, "/robot1/position_error", localizes),
        (EndpointRole.SUBSCRIPTION, "/robot1/initialpose", localizes),
        (EndpointRole.SERVER, "/robot1/set_initial_pose", localizes),
    ):
        assert ((role, name) in offered) is ours, name

    heard: list[bytes] = []
    for topic in ("/tf", "/robot1/tf"):
        other.subscribe(NodeName("/", "listener"), topic, JAZZY.message(TFMESSAGE), TF, lambda m, _: heard.append(m))
    here = Pose2(1.0, 0.0, 0.0)
    chain = [Transform("map", "robot1/odom", here), Transform("robot1/odom", "robot1/base_footprint", here)]
    live.take(5, [RosMessage(Topic(names.TF, types.TFMESSAGE), 0, pack.transforms(5, chain))])
    graph.deliver()
    to_ros1 = JAZZY.to_ros1(TFMESSAGE, types.TFMESSAGE)
    parents = [[each.parent for _, each in unpack.transforms(to_ros1(message))] for message in heard]
    assert parents == [["map", "robot1/odom"] if localizes else ["robot1/odom"]] * 2


@pytest.mark.parametrize(
    ("distribution", "own", "other"),
    [(JAZZY, "Twist", "TwistStamped"), (Distribution.of("kilted"), "TwistStamped", "Twist")],
)
def test_a_topic_has_a_second_type_only_while_clients_use_it(distribution: Distribution, own: str, other: str) -> None:
    graph, live = session(distribution=distribution)
    joystick = graph.program()

    def offered() -> set[str]:
        return {each.type for each in joystick.endpoints() if each.name == "/robot1/cmd_vel"}

    live.take(50, [])
    assert offered() == {f"geometry_msgs/msg/{own}"}
    kind = f"geometry_msgs/msg/{other}"
    joystick.publish(NodeName("/", "joystick"), "/robot1/cmd_vel", distribution.message(kind), DEFAULT)
    live.take(100, [])
    assert offered() == {f"geometry_msgs/msg/{own}", kind}
