"""Names of topics and frames of a real robot."""

from dataclasses import dataclass

from thbridge.ros.names import TF


@dataclass(frozen=True, slots=True)
class RemoteNames:
    """Names of one robot. Topics are global, and frames have no leading slash.

    Attributes:
        map_frame: frame of the map. It must be the map of the session.
        odom_frame: frame of its odometry.
        base_frame: frame of its base in tf.
        odom: topic of its odometry.
        scan: topic of its laser.
        amcl_pose: topic of its localization.
        battery: topic of its battery.
        cmd_vel: topic of the commands to its base.
        initialpose: topic of pose estimates for its localization.
        move_base: name of its action server.
        plan: topic of its global plan.
        recorded: other topics. They are only recorded.
        tf: topic of its transforms, for people. `RemoteRobot` itself receives them as /tf.
        action_space: what the topics of its action server have between the server's name and their own.
    """

    map_frame: str
    odom_frame: str
    base_frame: str
    odom: str
    scan: str
    amcl_pose: str
    battery: str
    cmd_vel: str
    initialpose: str
    move_base: str
    plan: str
    recorded: tuple[str, ...] = ()
    tf: str = TF
    action_space: str = ""

    def action(self, part: str) -> str:
        """Return the topic of a part of the robot's action: goal, cancel, status, feedback or result."""
        return f"{self.move_base}{self.action_space}/{part}"


@dataclass(frozen=True, slots=True)
class Nav2Names:
    """Names of one robot that ROS 1 does not have.

    Attributes:
        action: name of its action navigate_to_pose.
        tf: topic of its transforms.
        tf_static: topic of its fixed transforms.
        is_twist_stamped: True if its base receives geometry_msgs/TwistStamped.
    """

    action: str
    tf: str
    tf_static: str
    is_twist_stamped: bool
