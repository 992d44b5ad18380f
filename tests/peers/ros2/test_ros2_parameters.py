"""A real client of rclpy at our parameters: the answers are those of a node of rclpy, except the texts of refusals."""

import asyncio
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.inputs import GlobalLocalization
from sim.parameters import RobotParameters
from sim.parameters.reconfiguration import with_values
from sim.robot.costmap.robot_costmap import RobotCostmap
from tests.peers.ros2.peer_process import environment
from tests.support.programs.ports import free_domain
from tests.support.project import ROOT
from thbridge.app.live_graph.live_node_parameters import LiveNodeParameters
from thbridge.app.live_graph.live_node_services import LiveNodeServices, offer_logger_levels
from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros2.distribution import Distribution
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName

PYTHON = ROOT / ".peers" / "ros2" / "bin" / "python"
SCRIPT = Path(__file__).parent / "parameter_client.py"
DOMAIN = free_domain()
TIMEOUT = 180.0

pytestmark = [
    pytest.mark.skipif(not PYTHON.exists(), reason=f"not installed: {PYTHON} (see scripts/install_peers.sh)"),
    pytest.mark.slow,
]


async def answers(node: str, prefix: str, asks: list[tuple[str, Request]]) -> dict[str, Any]:
    """Return the answers that a client of rclpy gets from one of our nodes and from a node of rclpy."""
    types, limiter, carrier = Distribution.of("kilted"), RateLimiter(), DdsCarrier(DOMAIN)
    services = NodeServices(carrier, types)
    software = [RobotParameters()] * 2
    parameters = LiveNodeParameters(
        services, software, {"rooms": 4}, 0.05, limiter, lambda sender, request: asks.append((sender, request))
    )
    searches: list[Request] = []
    grid = OccupancyGrid(np.arange(6, dtype=np.int8).reshape(2, 3), 0.05, Pose2(0.0, 0.0, 0.0))
    costs = RobotCostmap(0, grid.origin, grid.origin, 0.05, np.zeros((2, 3), np.uint8), np.empty((0, 2)), True)
    LiveNodeServices(
        services, types, parameters.nodes, grid, lambda robot, name: costs, limiter,
        lambda sender, request: searches.append(request),
    )  # fmt: skip
    offer_logger_levels(services, types, NodeName("/", "thbridge"))
    for each in parameters.nodes:
        carrier.add_node(NodeName(each.namespace, each.name))
    assert await carrier.start() is None
    ticking = asyncio.create_task(tick(parameters, software, asks, limiter))
    try:
        async with asyncio.timeout(TIMEOUT):
            client = await asyncio.create_subprocess_exec(
                str(PYTHON), str(SCRIPT), node, prefix, env=environment(DOMAIN), stdout=asyncio.subprocess.PIPE
            )
            output, _ = await client.communicate()
        assert client.returncode == 0
    finally:
        ticking.cancel()
        await carrier.stop()
    assert searches == [GlobalLocalization(int(node[len("/robot")]) - 1)]
    return json.loads(output)


async def tick(
    parameters: LiveNodeParameters,
    software: list[RobotParameters],
    asks: list[tuple[str, Request]],
    limiter: RateLimiter,
) -> None:
    """Carry out requests between two ticks, as a session does."""
    number = done = 0
    while True:
        for _, request in asks[done:]:
            assert isinstance(request, SetParameters)
            changed = with_values(software[request.robot], request.values)
            assert isinstance(changed, RobotParameters)
            software[request.robot] = changed
        number, done = number + 1, len(asks)
        limiter.tick()
        parameters.follow(number, software)
        await asyncio.sleep(0.001)  # Shorter than a tick, because the client is faster than people are.


@pytest.mark.parametrize(
    ("node", "prefix"),
    [("/robot2/amcl", "initial_pose"), ("/robot1/local_costmap/local_costmap", "obstacle_layer")],
)
def test_a_client_gets_the_answers_of_a_node_of_rclpy(node: str, prefix: str) -> None:
    asks: list[tuple[str, Request]] = []
    found = asyncio.run(answers(node, prefix, asks))
    ours, theirs = found["ours"], found["theirs"]
    # A change to the present value is no change here; rclpy publishes an event.
    events, their_events = ours.pop("events"), theirs.pop("events")
    assert events == their_events[:2]
    assert ours.keys() == theirs.keys()
    for call, answer in theirs.items():
        if call.startswith(("set ", "atomically ")):
            assert [done for done, _ in ours[call]] == [done for done, _ in answer], call
            assert [bool(reason) for _, reason in ours[call]] == [bool(reason) for _, reason in answer], call
        else:
            assert ours[call] == answer, call
    assert [request for _, request in asks] == [SetParameters(*own) for own in expected(node, events)]
    for name, (own, other) in found["described"].items():
        assert own == other, name
    assert found["services"] == {
        "state": [3, "active"],
        "map": ["map", 3, 2, [0, 1, 2, 3, 4, 5]],
        "levels": [0],
        "set levels": [True, False],
    }
    assert sum(own[0] for own, _ in found["described"].values()) == 4


def expected(node: str, events: list[tuple[str, Any]]) -> list[tuple[int, tuple[tuple[str, Any], ...]]]:
    """Return the inputs of the session that belong to the events."""
    robot = int(node[len("/robot")]) - 1
    paths = {
        "alpha1": "amcl.odom_alpha1",
        "ekf.laser_max_beams": "ekf.laser_max_beams",
        "footprint_padding": "local_costmap.footprint_padding",
        "obstacle_layer.combination_method": "local_costmap.obstacle_layer.combination_method",
    }
    return [(robot, ((paths[name], value),)) for name, value in events]
