"""A node of rclpy that calls Nav2's services of a session, and prints what it finds as JSON.

It runs with the Python of the peer, so it imports nothing of the project.
"""

import json
import time

import rclpy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs.action import ComputePathToPose
from nav2_msgs.srv import ClearEntireCostmap, GetCostmap, LoadMap, SetInitialPose
from nav_msgs.srv import GetMap
from rclpy.action import ActionClient
from std_srvs.srv import Empty

TIMEOUT = 60.0
rclpy.init()
node = rclpy.create_node("nav2_services_client")
found = {}


def wait(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=TIMEOUT)
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
        ends = [answer.result.path.poses[place].pose.position for place in (0, -1)]
        found["ends"] = [[round(each.x, 1), round(each.y, 1)] for each in ends]
call(Empty, "/robot2/request_nomotion_update")
call(ClearEntireCostmap, "/robot2/global_costmap/clear_entirely_global_costmap")
estimate = PoseWithCovarianceStamped()
estimate.header.frame_id = "map"
estimate.pose.pose.orientation.w = 1.0
estimate.pose.covariance[0] = estimate.pose.covariance[7] = estimate.pose.covariance[35] = 0.1
call(SetInitialPose, "/robot2/set_initial_pose", pose=estimate)
call(Empty, "/robot1/reinitialize_global_localization")
print(json.dumps(found))
