"""The section `fleet` of a study: the names of real robots' topics and frames."""

import dataclasses
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, TypeVar, cast

from sim.common.robot_numbers import RobotNumber, robot_numbers
from sim.parameters import param
from sim.parameters.declaration import live
from thbridge.files.errors import BadFile
from thbridge.files.yaml.load import Loaded
from thbridge.ros.names import frame_name
from thbridge.ros.remote.names import Nav2Names, RemoteNames
from thbridge.ros2graph.values.address import RosDistribution
from thbridge.rosgraph.values.names import canonical, join
from thbridge.study.robots_from import RobotsFrom

S = TypeVar("S")

NUMBER = "{n}"
"""Placeholder for the robot's number. Numbers start at 1."""

ACTION_SPACE = "/_action"
"""Suffix of the name of an action in the names of its topics on ROS 2."""
_FRAMES = ("map_frame", "odom_frame", "base_frame")
_NAME = re.compile(r"/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*/?")
_FRAME = re.compile(r"\S+")
_OWN = ("odom_frame", "odom", "scan", "amcl_pose", "battery", "cmd_vel", "initialpose", "move_base", "plan")
"""Fields with names that must be unique in a team."""
_OF_NAV2 = {"move_base": "nav2.action", "plan": "nav2.plan", "battery": "nav2.battery", "recorded": "nav2.recorded"}
"""Fields for move_base, and the fields that replace them for Nav2 robots."""


@dataclass(frozen=True, slots=True)
class Nav2FleetNames:
    """Names of a Nav2 robot that differ from those of ROS 1."""

    action: str = param("navigate_to_pose", "action server of Nav2's navigation, nav2_msgs/NavigateToPose")
    plan: str = param("plan", "topic of the robot's global plan, nav_msgs/Path; optional")
    battery: str = param("battery_state", "topic of the robot's battery, sensor_msgs/BatteryState; optional")
    tf: str = param("tf", "topic of the robot's transforms; /tf if all robots share it")
    tf_static: str = param("tf_static", "topic of the robot's fixed transforms")
    stamped_cmd_vel: bool | None = param(
        None,
        "whether the robot's base receives geometry_msgs/TwistStamped; if null, as Nav2's default in the distribution: "
        "false in Jazzy, true in Kilted",
    )
    recorded: tuple[str, ...] = param(
        ("particle_cloud", "local_plan", "local_costmap/costmap", "local_costmap/published_footprint"),
        "further topics; they are only recorded in the bag, if ROS 1 has their types",
    )


@dataclass(frozen=True, slots=True)
class FleetNames:
    """Names of the topics and frames of a robot; {n} is the placeholder for the robot's number."""

    namespace: str = param("/robot{n}", "prefix of the robot's topics, except topics that begin with /")
    map_frame: str = param("map", "frame of the study's map")
    odom_frame: str = param("robot{n}/odom", "frame of the robot's odometry")
    base_frame: str = param("robot{n}/base_footprint", "frame of the robot's base")
    odom: str = param("odom", "topic of the robot's odometry, nav_msgs/Odometry")
    scan: str = param("scan", "topic of the robot's laser, sensor_msgs/LaserScan")
    amcl_pose: str = param("amcl_pose", "topic of the robot's localization, geometry_msgs/PoseWithCovarianceStamped")
    battery: str = param("battery", "topic of the robot's battery, sensor_msgs/BatteryState; optional")
    cmd_vel: str = param("cmd_vel", "topic of the commands to the robot's base, geometry_msgs/Twist")
    initialpose: str = param("initialpose", "topic on which amcl receives its initial pose")
    move_base: str = param("move_base", "action server of the robot's move_base, move_base_msgs/MoveBaseAction")
    plan: str = param("move_base/NavfnROS/plan", "topic of the robot's global plan, nav_msgs/Path; optional")
    recorded: tuple[str, ...] = param(
        (
            "particlecloud",
            "move_base/TrajectoryPlannerROS/local_plan",
            "move_base/local_costmap/costmap",
            "move_base/local_costmap/footprint",
        ),
        "further topics of any type; they are only recorded in the bag",
    )
    nav2: Nav2FleetNames = param(
        Nav2FleetNames(), "with robots_from: ros2, these names replace move_base, plan, battery and recorded"
    )

    def _topic(self, name: str, number: RobotNumber) -> str:
        space = self._for_robot("namespace", number)
        return canonical("/" + join(space, name.replace(NUMBER, str(number))))

    def nav2_names(self, number: RobotNumber, distribution: RosDistribution) -> tuple[RemoteNames, Nav2Names]:
        """Return the names of the Nav2 robot with this number."""
        topic, own = partial(self._topic, number=number), self.nav2
        stamped = own.stamped_cmd_vel
        nav2 = Nav2Names(
            action=topic(own.action),
            tf=topic(own.tf),
            tf_static=topic(own.tf_static),
            is_twist_stamped=distribution is not RosDistribution.JAZZY if stamped is None else stamped,
        )
        remote = dataclasses.replace(
            self.names(number),
            move_base=nav2.action,
            action_space=ACTION_SPACE,
            plan=topic(own.plan),
            battery=topic(own.battery),
            tf=nav2.tf,
            recorded=tuple(topic(name) for name in own.recorded),
        )
        return remote, nav2

    def names(self, number: RobotNumber) -> RemoteNames:
        """Return the names of the robot with this number."""
        topic = partial(self._topic, number=number)
        return RemoteNames(
            map_frame=frame_name(self._for_robot("map_frame", number)),
            odom_frame=frame_name(self._for_robot("odom_frame", number)),
            base_frame=frame_name(self._for_robot("base_frame", number)),
            odom=topic(self.odom),
            scan=topic(self.scan),
            amcl_pose=topic(self.amcl_pose),
            battery=topic(self.battery),
            cmd_vel=topic(self.cmd_vel),
            initialpose=topic(self.initialpose),
            move_base=topic(self.move_base),
            plan=topic(self.plan),
            recorded=tuple(topic(name) for name in self.recorded),
        )

    def _for_robot(self, field: str, number: int) -> str:
        return cast(str, getattr(self, field)).replace(NUMBER, str(number))

    def faults(self, number: int) -> Iterator[tuple[str, str]]:
        """Yield the field and problem of each invalid name."""
        values = [(field.name, getattr(self, field.name)) for field in dataclasses.fields(self)]
        values += [(f"nav2.{each.name}", getattr(self.nav2, each.name)) for each in dataclasses.fields(self.nav2)]
        for field, value in values:
            for text in (value,) if isinstance(value, str) else value if isinstance(value, tuple) else ():
                plain = text.replace(NUMBER, str(number))
                if field == "namespace" and not plain.strip("/"):
                    continue  # A robot that is alone on its ROS graph needs no namespace.
                if not (_FRAME if field in _FRAMES else _NAME).fullmatch(plain):
                    what = "frame" if field in _FRAMES else "topic"
                    yield field, f"{text!r} is not a valid name of a {what}"


class NameClash(NamedTuple):
    """A name that is used twice: number of the second robot, field with the name, and description of the problem."""

    robot: RobotNumber
    field: str
    problem: str


@dataclass(frozen=True, slots=True)
class FleetSection:
    """Settings of real robots."""

    robot: FleetNames = param(FleetNames(), "names of the topics and frames of every robot; {n} is its number")
    silence: float = param(
        5.0, "time without a message after which the robot or its move_base counts as silent", "s", 1, 600
    )
    odom_time_offset: float = live(
        0.0,
        "time by which odometry is ahead of the scans (measured by `thbridge localize`); odometry stamps are corrected "
        "by this time",
        "s",
        -10,
        10,
    )
    each: Mapping[int, FleetNames] = dataclasses.field(
        default_factory=dict,
        metadata={"help": "names for single robots, by robot number: `{2: {namespace: /kobuki}}`", "like": "robot"},
    )

    def names(self, robots: int) -> list[RemoteNames]:
        """Return the names of each robot in a team of this size."""
        return [self.each.get(number, self.robot).names(number) for number in robot_numbers(robots)]

    def nav2_names(self, robots: int, distribution: RosDistribution) -> list[tuple[RemoteNames, Nav2Names]]:
        """Return the names of each Nav2 robot in a team of this size."""
        return [self.each.get(number, self.robot).nav2_names(number, distribution) for number in robot_numbers(robots)]

    def clash(self, robots: int, source: RobotsFrom = RobotsFrom.ROS) -> NameClash | None:
        """Return the first name that is used twice in a team of this size, or None."""
        if source is not RobotsFrom.ROS2:
            return _clash(self.names(robots), {})
        # Robots with separate topics of transforms may have frames of the same name.
        return _clash(
            [
                dataclasses.replace(remote, odom_frame=f"{remote.odom_frame} on {nav2.tf}")
                for remote, nav2 in self.nav2_names(robots, RosDistribution.JAZZY)
            ],
            _OF_NAV2,
        )

    def replaced(self) -> Iterator[tuple[str, str]]:
        """Yield the key of each name that Nav2 robots ignore, and the key that they use instead."""
        for key, own in (("robot", self.robot), *((f"each.{number}", own) for number, own in self.each.items())):
            for field, other in _OF_NAV2.items():
                if getattr(own, field) != getattr(FleetNames(), field):
                    yield f"fleet.{key}.{field}", f"fleet.{key}.{other}"


def _clash(names: Sequence[RemoteNames], keys: Mapping[str, str]) -> NameClash | None:
    """Return the first name that is used twice; `keys` has the keys of fields whose key has another name."""
    taken: dict[str, tuple[int, str]] = {}
    for number, own in zip(robot_numbers(len(names)), names, strict=True):
        for field in _OWN:
            name, key = cast(str, getattr(own, field)), keys.get(field, field)
            first, other = taken.setdefault(name, (number, key))
            if (first, other) != (number, key):
                problem = f"{name} is both {other} of robot {first} and {key} of robot {number}"
                return NameClash(number, key, problem)
    return None


def faults_of_fleet(
    loaded: Loaded[S], fleet: FleetSection, robots: int, source: RobotsFrom = RobotsFrom.ROS
) -> Iterator[BadFile]:
    """Yield faults: names that are invalid in ROS, and names that are used twice.

    A study for simulated robots may get its source of robots later, so its names need to suit only one source.
    """
    sound = True
    for key, named, number in (
        ("fleet.robot", fleet.robot, 1),
        *((f"fleet.each.{number}", own, number) for number, own in fleet.each.items()),
    ):
        for field, problem in named.faults(number):
            sound = False
            yield loaded.fault(
                f"{key}.{field}", problem, f"Write letters, digits, _ and /; {NUMBER} is replaced by the robot's number"
            )
    if not sound:
        return
    sources = (source,) if source.is_real else (RobotsFrom.ROS, RobotsFrom.ROS2)
    clashes = [fleet.clash(robots, each) for each in sources]
    if all(clashes) and (clash := clashes[0]) is not None:
        key = f"fleet.each.{clash.robot}" if clash.robot in fleet.each else "fleet.robot"
        remedy = f"Write a different name for each; {NUMBER} is replaced by the robot's number"
        yield loaded.fault(f"{key}.{clash.field}", clash.problem, remedy)
