"""Names in ROS: namespaces and frames of robots, topics of the team."""

from dataclasses import dataclass

from sim.common.robot_numbers import namespace_of

MAP_FRAME = "map"
CALLER = "/thbridge"
"""Name of thbridge's node. It is the only publisher in bags and on a live graph."""
FLEET = "/thbridge_fleet"
"""Name of the node that commands real robots. A simulated session on the same graph has another name."""

TF = "/tf"
TF_STATIC = "/tf_static"
MAP = "/map"
MAP_METADATA = "/map_metadata"
SESSION = "/thbridge/session"
SEND_ROBOTS = "/sendRobots"
SUCCESS = "/success"
GAME_EVENTS = "/hunt/events"
SCORE = "/hunt/score"
ROOMS = "/hunt/rooms"
UTTERANCES = "/dialogue/utterances"
DIALOGUE_MOVES = "/dialogue/moves"
DIALOGUE_STATES = "/dialogue/states"
WIZARD = "/hunt/wizard"
TEAM = "/hunt/team"
SHOWN = "/hunt/shown"
INPUTS = "/inputs"
THINGS = "/things"
ROSOUT = "/rosout"
DIAGNOSTICS = "/diagnostics"
NAVIGATION, MAKES_WAY_FOR = "navigation", "makes way for"
"""Name of the part in /diagnostics that drives a robot. Key for the other robot for which the robot makes way."""
CLOCK = "/clock"
GRAPH_LINK = "ros"
"""Name of the MAVLink link of ROS clients, which use the topic mavlink/to."""
STATIC_MAP = "/static_map"
"""Name of a service."""
USE_SIM_TIME = "/use_sim_time"
"""Name of a parameter."""


def frame_name(name: str) -> str:
    """Return a frame's name without a leading slash. The old tf wrote this slash, and tf2 forbids it."""
    return name.lstrip("/")


@dataclass(frozen=True, slots=True)
class RobotNames:
    """Namespace, frames and topics of one robot. Frames have no leading slash, because tf2 forbids it.

    Attributes:
        namespace: namespace, such as "/robot1" for the first robot.
    """

    namespace: str

    @classmethod
    def of(cls, robot: int) -> "RobotNames":
        """Return the names of the robot with this index in the team."""
        return cls(f"/{namespace_of(robot)}")

    def frame(self, name: str) -> str:
        """Return this robot's frame `name`, such as "robot1/odom" for "odom"."""
        return f"{self.namespace[1:]}/{name}"

    def topic(self, name: str) -> str:
        """Return this robot's topic `name`, such as "/robot1/scan" for "scan"."""
        return f"{self.namespace}/{name}"

    @property
    def odom(self) -> str:
        """Frame of the wheel odometry."""
        return self.frame("odom")

    @property
    def base_footprint(self) -> str:
        """Frame of the base at the height of the ground."""
        return self.frame("base_footprint")

    @property
    def base_link(self) -> str:
        """Frame of the body."""
        return self.frame("base_link")

    @property
    def base_laser(self) -> str:
        """Frame of the laser."""
        return self.frame("base_laser")
