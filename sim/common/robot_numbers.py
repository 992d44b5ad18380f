"""Numbers of robots. Only this module converts between the program's counting and people's counting.

In the program a robot is an `int`, its index in the team, from 0. The text lines of 2016 contain this index, too.
People, ROS names, MAVLink system ids, study files and bags count from 1. Convert with these functions, never by adding
1.
"""

from typing import NewType

RobotNumber = NewType("RobotNumber", int)
"""A robot's number for people, counted from 1."""


def number_of(robot: int) -> RobotNumber:
    """Return the number of the robot with this index. It is also the robot's MAVLink system id."""
    return RobotNumber(robot + 1)


def index_of(number: int) -> int:
    """Return the index of the robot with this number, as given by people, files or messages."""
    return number - 1


def robot_numbers(robots: int) -> list[RobotNumber]:
    """Return the numbers of the robots in a team of this size."""
    return [number_of(robot) for robot in range(robots)]


def robot_name(robot: int) -> str:
    """Return the name of a robot for people: "robot 1" for index 0."""
    return f"robot {number_of(robot)}"


def namespace_of(robot: int) -> str:
    """Return the name of a robot for programs, such as its namespace in ROS: "robot1" for index 0."""
    return f"robot{number_of(robot)}"
