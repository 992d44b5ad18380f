"""A node of rclpy that looks at a session on the graph, drives robot 1 by cmd_vel, and prints what it finds as JSON.

It runs with the Python of the peer, so it imports nothing of the project.
"""

import json
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

PATIENCE = 60.0
rclpy.init()
node = rclpy.create_node("laboratory")
frames = {"/tf": [], "/robot1/tf": []}
odometry = []
for name, heard in frames.items():
    node.create_subscription(
        TFMessage,
        name,
        lambda m, heard=heard: heard.extend((t.header.frame_id, t.child_frame_id) for t in m.transforms),
        100,
    )
node.create_subscription(Odometry, "/robot1/odom", lambda m: odometry.append(m.twist.twist.linear.x), 10)
velocity = node.create_publisher(Twist, "/robot1/cmd_vel", 10)


def until(condition, what):
    """Spin until something happens."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(what)
        rclpy.spin_once(node, timeout_sec=0.05)


def drives():
    """Command the robot; return True when it drives."""
    command = Twist()
    command.linear.x = 0.3
    velocity.publish(command)
    return bool(odometry) and odometry[-1] > 0.25


until(lambda: odometry and all(len(heard) > 20 for heard in frames.values()), "odometry and transforms")
until(drives, "the robot to drive")
names = {f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces()}
topics = {
    name
    for name, _ in node.get_topic_names_and_types()
    if any(info.node_name != node.get_name() for info in node.get_publishers_info_by_topic(name))
}
services = {name for name, _ in node.get_service_names_and_types()}
print(
    json.dumps(
        {
            "nodes": sorted(name for name in names if name.startswith("/robot1/")),
            "topics": sorted(name for name in topics if name.startswith("/robot1/")),
            "services": sorted(name for name in services if name.startswith("/robot1/")),
            "frames": {
                name: sorted({f"{parent} {child}" for parent, child in heard}) for name, heard in frames.items()
            },
        }
    )
)
