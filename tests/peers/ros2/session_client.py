"""A node of rclpy that commands the robots of a session as Nav2's clients do, and prints what it finds as JSON.

It runs with the Python of the peer, so it imports nothing of the project.
"""

import json
import time

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped
from lifecycle_msgs.srv import GetState
from nav2_msgs.action import FollowWaypoints, NavigateToPose
from nav_msgs.msg import Odometry
from nav_msgs.srv import GetMap
from rcl_interfaces.msg import ParameterEvent
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from std_srvs.srv import Empty

PATIENCE = 60.0
found = {}

rclpy.init()
node = rclpy.create_node("session_client", parameter_overrides=[Parameter("use_sim_time", value=True)])
events = []
speeds = []
node.create_subscription(ParameterEvent, "/parameter_events", events.append, 100)
node.create_subscription(Odometry, "/robot2/odom", lambda m: speeds.append(m.twist.twist.angular.z), 10)


def until(condition, what):
    """Spin until something happens."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(what)
        rclpy.spin_once(node, timeout_sec=0.05)


def outcome(future, what):
    """Return the result of a future."""
    until(future.done, what)
    return future.result()


def pose(x, y):
    """Return a goal pose on the map."""
    goal = PoseStamped()
    goal.header.frame_id = "map"
    goal.pose.position.x, goal.pose.position.y, goal.pose.orientation.w = x, y, 1.0
    return goal


def call(kind, name, request):
    """Call a service."""
    client = node.create_client(kind, name)
    assert client.wait_for_service(PATIENCE), name
    return outcome(client.call_async(request), name)


def sent(client, goal, feedback=None):
    """Send a goal; return its handle."""
    handle = outcome(client.send_goal_async(goal, feedback_callback=feedback), "the answer to a goal")
    assert handle.accepted
    return handle


# Simulated time
until(lambda: node.get_clock().now().nanoseconds > 0, "the clock")
found["seconds"] = node.get_clock().now().nanoseconds / 1e9

# navigate_to_pose: a goal is reached, a goal is replaced, a goal is canceled, and a goal in a wall fails.
navigate = ActionClient(node, NavigateToPose, "/robot1/navigate_to_pose")
assert navigate.wait_for_server(PATIENCE)
feedback = []
first = sent(navigate, NavigateToPose.Goal(pose=pose(3.0, 0.0)), lambda m: feedback.append(m.feedback))
result = outcome(first.get_result_async(), "the first result")
found["reached"] = [result.status == GoalStatus.STATUS_SUCCEEDED, result.result.error_code]
found["feedback"] = [len(feedback) > 5, feedback[1].distance_remaining > 0.5, feedback[-1].navigation_time.sec >= 1]
old = sent(navigate, NavigateToPose.Goal(pose=pose(-3.0, 0.0)))
new = sent(navigate, NavigateToPose.Goal(pose=pose(-2.0, 0.0)))
found["replaced"] = outcome(old.get_result_async(), "the replaced goal").status == GoalStatus.STATUS_ABORTED
canceled = outcome(new.cancel_goal_async(), "the answer to a cancel request")
found["canceling"] = len(canceled.goals_canceling)
found["canceled"] = outcome(new.get_result_async(), "the canceled goal").status == GoalStatus.STATUS_CANCELED
lost = sent(navigate, NavigateToPose.Goal(pose=pose(500.0, 0.0)))
failed = outcome(lost.get_result_async(), "the impossible goal")
found["impossible"] = [
    failed.status == GoalStatus.STATUS_ABORTED,
    failed.result.error_code,
    failed.result.error_msg != "",
]

# follow_waypoints
waypoints = ActionClient(node, FollowWaypoints, "/robot1/follow_waypoints")
assert waypoints.wait_for_server(PATIENCE)
tour = sent(waypoints, FollowWaypoints.Goal(poses=[pose(1.0, 0.0), pose(2.0, 0.0)]))
toured = outcome(tour.get_result_async(), "the tour")
found["tour"] = [toured.status == GoalStatus.STATUS_SUCCEEDED, len(toured.result.missed_waypoints)]

# Parameters
amcl = AsyncParameterClient(node, "/robot1/amcl")
assert amcl.wait_for_services(PATIENCE)
names = outcome(amcl.list_parameters([], 10), "the list").result.names
described = outcome(amcl.describe_parameters(list(names)), "the descriptions").descriptors
found["described"] = [len(described) == len(names), all(each.description for each in described)]
given = [
    Parameter("min_particles", value=321),
    Parameter("laser_model_type", value="guess"),
    Parameter("nothing", value=1),
]
results = outcome(amcl.set_parameters(given), "the settings").results
found["set"] = [each.successful for each in results]
found["reasons"] = [each.reason for each in results]
until(
    lambda: any(p.name == "min_particles" for e in events if e.node == "/robot1/amcl" for p in e.changed_parameters),
    "the event",
)
found["value"] = outcome(amcl.get_parameters(["min_particles"]), "the value").values[0].integer_value

# Services
found["map"] = call(GetMap, "/robot1/map_server/map", GetMap.Request()).map.info.width
found["state"] = call(GetState, "/robot1/bt_navigator/get_state", GetState.Request()).current_state.label
call(Empty, "/robot1/reinitialize_global_localization", Empty.Request())

# Topics
estimate = PoseWithCovarianceStamped()
estimate.header.frame_id = "map"
estimate.pose.pose.orientation.w = 1.0
estimate.pose.covariance[0] = estimate.pose.covariance[7] = estimate.pose.covariance[35] = 0.1
poses = node.create_publisher(PoseWithCovarianceStamped, "/robot2/initialpose", 10)
for kind in (Twist, TwistStamped):
    commands = node.create_publisher(kind, "/robot2/cmd_vel", 10)
    until(lambda pub=commands: pub.get_subscription_count() >= 1, "the subscription")
    speeds.clear()
    command = kind()
    (command if kind is Twist else command.twist).angular.z = 0.5

    def turned(pub=commands, command=command):
        pub.publish(command)
        return any(speed > 0.3 for speed in speeds)

    until(turned, "the robot to turn")
    found[kind.__name__] = True
    until(lambda: speeds and abs(speeds[-1]) < 0.05, "the robot to stop")
    node.destroy_publisher(commands)  # A process of rclpy can have only one type on a topic.
until(lambda: poses.get_subscription_count() >= 1, "the subscription")
poses.publish(estimate)
end = node.get_clock().now().nanoseconds + 1_000_000_000
until(lambda: node.get_clock().now().nanoseconds > end, "one second")
print(json.dumps(found))
