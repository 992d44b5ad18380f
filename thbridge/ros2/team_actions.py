"""Action servers of all robots of a session."""

from collections.abc import Iterable, Iterator, Sequence

from sim.robot.navigator.navigation import Navigation
from sim.robot.navigator.recovery import RecoveryProgress
from thbridge.ros.topics import RosMessage
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.follow_waypoints import FollowWaypointsServer
from thbridge.ros2.navigate_to_pose import AskRobot, NavigateToPoseServer


class TeamActions:
    """Servers navigate_to_pose and follow_waypoints of each robot.

    Args:
        robots: number of robots.
        distribution: message types.
        numbers: numbers of the goals of ROS clients. All sources of such goals share it.
        ask: callback for requests to robots.

    Attributes:
        navigate_to_pose: servers in the team's order.
        follow_waypoints: servers in the team's order.
    """

    def __init__(self, robots: int, distribution: Distribution, numbers: Iterator[int], ask: AskRobot) -> None:
        team = range(robots)
        self.navigate_to_pose = [NavigateToPoseServer(robot, distribution, numbers, ask) for robot in team]
        self.follow_waypoints = [FollowWaypointsServer(distribution, server) for server in self.navigate_to_pose]
        self._robot_of = {topic: robot for robot in team for topic in self.navigate_to_pose[robot].topics}
        self._tried = [0] * robots

    def take(
        self,
        tick: int,
        messages: Iterable[RosMessage],
        navigations: Sequence[Navigation | None],
        recoveries: Sequence[RecoveryProgress],
    ) -> None:
        """Process a tick of the session.

        Args:
            tick: number of the tick.
            messages: messages of this tick, in their order.
            navigations: output of each navigator. None for dead robots.
            recoveries: recovery of each robot's goal.
        """
        own: list[list[RosMessage]] = [[] for _ in self._tried]
        for message in messages:
            robot = self._robot_of.get(message.topic.name)
            if robot is not None and not message.foreign:
                own[robot].append(message)
        for robot, (navigate, waypoints) in enumerate(zip(self.navigate_to_pose, self.follow_waypoints, strict=True)):
            before, tried = self._tried[robot], recoveries[robot].tried
            self._tried[robot] = tried
            # If a robot began the list of behaviors again within the tick, all behaviors tried since then are new.
            begun = tried - before if tried >= before else tried
            navigate.follow(tick, own[robot], navigations[robot], begun)
            waypoints.follow(tick)
