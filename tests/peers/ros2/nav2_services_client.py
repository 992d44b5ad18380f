"""A node of rclpy that calls Nav2's services of a session, and prints what it finds as JSON.

It runs with the Python of the peer, so it imports nothing of the project.
"""

import json
import time

import rclpy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from nav2_msgs.action import ComputePathToPose
from nav2_msgs.srv import (
    ClearCostmapAroundRobot,
    ClearCostmapExceptRegion,
    ClearEntireCostmap,
    GetCostmap,
    GetCosts,
    IsPathValid,
    LoadMap,
    ManageLifecycleNodes,
    SetInitialPose,
)
from nav_msgs.msg import Path
from nav_msgs.srv import GetMap
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from std_srvs.srv import Empty, Trigger

TIMEOUT = 60.0
rclpy.init()
node = rclpy.create_node("nav2_services_client")
reference = LifecycleNode("reference", enable_communication_interface=True)
executor = SingleThreadedExecutor()
for each in (node, reference):
    executor.add_node(each)
found = {}


def wait(future):
    executor.spin_until_future_complete(future, timeout_sec=TIMEOUT)
    assert future.done(), "no response"
    return future.result()


def call(kind, name, **fields):
    """Call a service."""
    client = node.create_client(kind, name)
    assert client.wait_for_service(TIMEOUT), name
    return wait(client.call_async(kind.Request(**fields)))


def pose(x, y):
    stamped = PoseStamped()
    stamped.header.frame_id = "map"
    stamped.pose.position.x, stamped.pose.position.y, stamped.pose.orientation.w = x, y, 1.0
    return stamped


found["states"] = [
    call(GetState, f"/robot2/{name}/get_state").current_state.label
    for name in ("amcl", "map_server", "planner_server", "waypoint_follower", "local_costmap/local_costmap")
]


def lifecycle(name):
    """Return all that an active lifecycle node answers about states and transitions."""
    answers = [call(GetState, f"{name}/get_state").current_state]
    # An active node cannot be activated again.
    answers.append(call(ChangeState, f"{name}/change_state", transition=Transition(id=3)).success)
    answers.append(call(GetAvailableStates, f"{name}/get_available_states").available_states)
    for service in ("get_available_transitions", "get_transition_graph"):
        answers.append(call(GetAvailableTransitions, f"{name}/{service}").available_transitions)
    return answers


for transition in (1, 3):
    assert call(ChangeState, "/reference/change_state", transition=Transition(id=transition)).success
found["same lifecycle"] = lifecycle("/robot2/planner_server") == lifecycle("/reference")
found["deactivated"] = call(ChangeState, "/robot2/amcl/change_state", transition=Transition(id=4)).success
found["managers"] = [
    [
        call(Trigger, f"/robot2/lifecycle_manager_{name}/is_active").success,
        call(ManageLifecycleNodes, f"/robot2/lifecycle_manager_{name}/manage_nodes", command=1).success,
    ]
    for name in ("localization", "navigation")
]
found["map"] = call(GetMap, "/robot2/map_server/map").map.info.width
found["load"] = call(LoadMap, "/robot2/map_server/load_map", map_url="none.yaml").result
end = time.monotonic() + TIMEOUT
while not (costmap := call(GetCostmap, "/robot2/global_costmap/get_costmap").map).data and time.monotonic() < end:
    pass
found["costmap"] = [costmap.metadata.size_x, len(costmap.data) == costmap.metadata.size_x * costmap.metadata.size_y]
found["lethal"] = 254 in costmap.data
paths = ActionClient(node, ComputePathToPose, "/robot2/compute_path_to_pose")
assert paths.wait_for_server(TIMEOUT)
for name, goal in (
    ("path", ComputePathToPose.Goal(start=pose(1.0, 0.0), goal=pose(3.0, 0.0), use_start=True)),
    ("outside", ComputePathToPose.Goal(goal=pose(500.0, 0.0))),
    ("planner", ComputePathToPose.Goal(goal=pose(3.0, 0.0), planner_id="Smac")),
):
    handle = wait(paths.send_goal_async(goal))
    answer = wait(handle.get_result_async())
    found[name] = [answer.status, answer.result.error_code, answer.result.error_msg != ""]
    if name == "path":
        path = answer.result.path
        ends = [answer.result.path.poses[place].pose.position for place in (0, -1)]
        found["ends"] = [[round(each.x, 1), round(each.y, 1)] for each in ends]
found["valid"] = [
    call(IsPathValid, "/robot2/is_path_valid", path=each, max_cost=most).is_valid
    for each, most in ((path, 254), (path, 0), (Path(), 254), (Path(poses=[pose(3.0, 0.0), pose(500.0, 0.0)]), 254))
]
wall = costmap.data.index(254)
origin, size = costmap.metadata.origin.position, costmap.metadata.resolution
row, column = divmod(wall, costmap.metadata.size_x)
points = [pose(origin.x + (column + 0.5) * size, origin.y + (row + 0.5) * size), pose(500.0, 0.0)]
for costs in ("global_costmap", "local_costmap"):
    answer = call(GetCosts, f"/robot2/{costs}/get_cost_{costs}", poses=points)
    found[costs] = [list(answer.costs), answer.success]
answer = call(GetCosts, "/robot2/global_costmap/get_cost_global_costmap", poses=points[:1], use_footprint=True)
found["footprint"] = [list(answer.costs), answer.success]
call(ClearCostmapAroundRobot, "/robot2/local_costmap/clear_around_local_costmap", reset_distance=1.5)
call(ClearCostmapExceptRegion, "/robot2/global_costmap/clear_except_global_costmap", reset_distance=2.5)
call(Empty, "/robot2/request_nomotion_update")
call(ClearEntireCostmap, "/robot2/global_costmap/clear_entirely_global_costmap")
estimate = PoseWithCovarianceStamped()
estimate.header.frame_id = "map"
estimate.pose.pose.orientation.w = 1.0
estimate.pose.covariance[0] = estimate.pose.covariance[7] = estimate.pose.covariance[35] = 0.1
call(SetInitialPose, "/robot2/set_initial_pose", pose=estimate)
call(Empty, "/robot1/reinitialize_global_localization")
print(json.dumps(found))
