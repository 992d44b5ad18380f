"""rviz2 configuration that shows a whole team: that of rviz, with the plugins, topics and quality of service of ROS 2.

Source: ros2/rviz, rviz_default_plugins; ros-navigation/navigation2, nav2_default_view.rviz.
"""

from collections.abc import Mapping, Sequence

from sim.common.grid import OccupancyGrid
from sim.parameters import RobotParameters
from thbridge.ros import topics
from thbridge.ros.names import RobotNames
from thbridge.ros.rviz import Section, Value, sections, write_sections
from thbridge.ros.topics import Planners, RobotTopics
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.qos import DEFAULT, DeliveryReliability, Durability, QosProfile
from thbridge.ros2.topics import PARTICLE_CLOUD, Ros2Topic, SessionTopics

_COMMON = {"Displays", "Group"}
"""Classes of rviz_common; all others are in rviz_default_plugins."""


def rviz2_configuration(software: Sequence[RobotParameters], grid: OccupancyGrid) -> str:
    """Return the configuration file for a team on this map, seen from above.

    Args:
        software: parameters of each robot.
        grid: the map. It determines the center and the scale of the view.
    """
    team = [RobotNames.of(number) for number in range(len(software))]
    of = [RobotTopics(robot, Planners.of(own)) for robot, own in zip(team, software, strict=True)]
    sent = [topics.MAP, topics.THINGS, topics.ROOMS, *(topic for each in of for topic in each.all())]
    targets = SessionTopics(Distribution.of("jazzy"), sent, len(team)).targets
    # What clients send has no target.
    shown = {name: found[0][0] for name, found in targets.items() if found}
    for robot, each in zip(team, of, strict=True):
        shown[each.initialpose.name] = Ros2Topic(each.initialpose.name, "", DEFAULT)
        shown[each.simple_goal.name] = Ros2Topic(robot.topic("goal_pose"), "", DEFAULT)
    return write_sections(_section(sections(software, grid), shown))


def _section(section: Mapping[str, Value], shown: Mapping[str, Ros2Topic]) -> Section:
    """Return a section of rviz as one of rviz2. `shown` has the topic of each topic of the session."""
    converted: Section = {}
    for key, value in section.items():
        if key in ("Topic", "Marker Topic"):
            topic = shown[str(value)]
            converted["Topic"] = _topic(topic.name, topic.qos)
            if topic.type == PARTICLE_CLOUD:
                converted["Class"] = "nav2_rviz_plugins/ParticleCloud"
        elif key == "Class" and value:
            name = str(value).partition("/")[2]
            converted[key] = f"{'rviz_common' if name in _COMMON else 'rviz_default_plugins'}/{name}"
        elif isinstance(value, Mapping):
            converted[key] = _section(value, shown)
        elif isinstance(value, Sequence) and not isinstance(value, str):
            converted[key] = [_section(each, shown) if isinstance(each, Mapping) else each for each in value]
        else:
            converted[key] = value
    return converted


def _topic(name: str, qos: QosProfile) -> Section:
    return {
        "Value": name,
        "Depth": qos.depth,
        "Durability Policy": "Volatile" if qos.durability is Durability.VOLATILE else "Transient Local",
        "History Policy": "Keep Last",
        "Reliability Policy": "Reliable" if qos.reliability is DeliveryReliability.RELIABLE else "Best Effort",
    }
