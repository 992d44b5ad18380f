"""Nodes of rclpy that play Nav2 robots: they drive straight to their goals and publish what Nav2 robots publish.

It runs with the Python of the peer, so it imports nothing of the project. Usage: nav2_robots.py SPEED NUMBER ...
The first goal of robot 1 has no path.
"""

import math
import sys
import threading
import time

import rclpy
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from tf2_msgs.msg import TFMessage

PERIOD = 0.05
speed, numbers = float(sys.argv[1]), [int(number) for number in sys.argv[2:]]
rclpy.init()


class Robot:
    """One robot. As in Nav2, a newer goal preempts: the older goal is aborted with an empty result."""

    def __init__(self, number):
        self.node = rclpy.create_node("bt_navigator", namespace=f"/robot{number}")
        self.x, self.y, self.speed = 0.0, float(number), 0.0
        self.newest = None
        self.fails = number == 1
        self.lock = threading.Lock()
        group = ReentrantCallbackGroup()
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.odom = self.node.create_publisher(Odometry, "odom", qos_profile_sensor_data)
        self.pose = self.node.create_publisher(PoseWithCovarianceStamped, "amcl_pose", latched)
        self.tf = self.node.create_publisher(TFMessage, "tf", 100)
        self.server = ActionServer(
            self.node,
            NavigateToPose,
            "navigate_to_pose",
            self.execute,
            callback_group=group,
            handle_accepted_callback=self.accept,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
        )
        self.node.create_timer(PERIOD, self.publish, callback_group=group)

    def accept(self, handle):
        with self.lock:
            self.newest = handle
        handle.execute()

    def execute(self, handle):
        goal = handle.request.pose.pose.position
        began = time.monotonic()
        result = NavigateToPose.Result()
        while True:
            with self.lock:
                if handle is not self.newest:
                    handle.abort()
                    return result
            if handle.is_cancel_requested:
                self.speed = 0.0
                handle.canceled()
                return result
            if self.fails:
                self.fails = False
                result.error_code, result.error_msg = 208, "no valid path"
                handle.abort()
                return result
            left = math.hypot(goal.x - self.x, goal.y - self.y)
            step = speed * PERIOD
            if left <= step:
                self.x, self.y, self.speed = goal.x, goal.y, 0.0
                handle.succeed()
                return result
            self.x += (goal.x - self.x) * step / left
            self.y += (goal.y - self.y) * step / left
            self.speed = speed
            feedback = NavigateToPose.Feedback(distance_remaining=left)
            feedback.navigation_time.sec = int(time.monotonic() - began)
            handle.publish_feedback(feedback)
            time.sleep(PERIOD)

    def publish(self):
        now = self.node.get_clock().now().to_msg()
        odometry = Odometry()
        odometry.header.stamp, odometry.header.frame_id, odometry.child_frame_id = now, "odom", "base_link"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.x, self.y
        odometry.twist.twist.linear.x = self.speed
        self.odom.publish(odometry)
        pose = PoseWithCovarianceStamped()
        pose.header.stamp, pose.header.frame_id = now, "map"
        pose.pose.pose = odometry.pose.pose
        self.pose.publish(pose)
        correction = TransformStamped()
        correction.header.stamp, correction.header.frame_id, correction.child_frame_id = now, "map", "odom"
        self.tf.publish(TFMessage(transforms=[correction]))


executor = MultiThreadedExecutor(num_threads=2 * len(numbers) + 2)
for each in [Robot(number) for number in numbers]:
    executor.add_node(each.node)
print("ready", flush=True)
executor.spin()
