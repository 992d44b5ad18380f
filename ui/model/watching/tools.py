"""Requests that result from a researcher's actions on the map, and reasons why a request is impossible."""

import math
from collections.abc import Iterable
from enum import StrEnum
from itertools import count
from typing import Literal

import numpy as np

from sim.common.geometry import Pose2
from sim.common.traversability import inside
from sim.inputs import ClearCostmaps, KidnapRobot, KillRobot, PutThing, RemoveThing, ReviveRobot
from sim.world.thing import Thing
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.shared.robot_requests import Request, WizardAdvice, WizardMode, WizardMove, WizardRequest
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import InitialPose, SimpleGoal
from ui.model.watching.scene import PendingTurn, RobotScene, Scene

SENDER = "watch"
"""Name of the sender in records of these requests."""
COVARIANCE = np.diag([0.25, 0.25, (math.pi / 12.0) ** 2])
"""Covariance of a pose that a person sets on the map, as in rviz: standard deviations of 0.5 m and 15 degrees.

Source: rviz, src/rviz/default_plugin/tools/initial_pose_tool.cpp.
"""
LEAST_SIZE, MOST_SIZE = 0.1, 10.0
"""Smallest and largest size of an obstacle, meters."""
CORNERS = 16
"""Number of corners of a round obstacle."""

Shape = Literal["circle", "box"]


class ToolRefusalReason(StrEnum):
    """Reasons why a request is impossible."""

    RECORDED = "recorded"
    NO_ROBOT = "no-robot"
    DEAD = "dead"
    ALIVE = "alive"
    OFF_MAP = "off-map"
    NO_THING = "no-thing"
    NOT_WAITING = "not-waiting"


RECORDED = RequestRefused(ToolRefusalReason.RECORDED, "This is a recording. Its robots cannot receive requests.")


class Tools:
    """Maker of requests to a running session from a researcher's actions on the map.

    Each method gets the scene that the researcher sees. For recordings, the answer to every request is `RECORDED`.
    """

    def __init__(self) -> None:
        self._goals = count()

    def goal(self, scene: Scene, robot: int, base_in_map: Pose2) -> Request | RequestRefused:
        """Send a robot to a pose (rviz: 2D Nav Goal)."""
        found = _alive_robot(scene, robot)
        if isinstance(found, RequestRefused):
            return found
        return _off_map(scene, base_in_map) or SimpleGoal(robot, base_in_map, next(self._goals), owner=GoalOwner.WINDOW)

    def pose(self, scene: Scene, robot: int, base_in_map: Pose2) -> Request | RequestRefused:
        """Set a robot's estimate of its pose (rviz: 2D Pose Estimate)."""
        found = _alive_robot(scene, robot)
        if isinstance(found, RequestRefused):
            return found
        return _off_map(scene, base_in_map) or InitialPose(robot, base_in_map, COVARIANCE)

    def clear_costmaps(self, scene: Scene, robot: int) -> Request | RequestRefused:
        """Delete the obstacles that a robot's laser has seen from the robot's costmaps."""
        found = _alive_robot(scene, robot)
        return found if isinstance(found, RequestRefused) else ClearCostmaps(robot)

    def carry(
        self, scene: Scene, robot: int, x: float, y: float, heading: float | None = None
    ) -> Request | RequestRefused:
        """Kidnap a robot (move it by hand). If no heading is given, the heading does not change."""
        found = _robot(scene, robot)
        if isinstance(found, RequestRefused):
            return found
        known = found.truth or found.estimate
        kept = 0.0 if known is None else known.theta
        place = Pose2(x, y, kept if heading is None else heading)
        return _off_map(scene, place) or KidnapRobot(robot, place)

    def kill(self, scene: Scene, robot: int) -> Request | RequestRefused:
        """Stop a robot's software."""
        found = _alive_robot(scene, robot)
        return found if isinstance(found, RequestRefused) else KillRobot(robot)

    def revive(self, scene: Scene, robot: int) -> Request | RequestRefused:
        """Restart the software of a dead robot."""
        found = _robot(scene, robot)
        if isinstance(found, RequestRefused):
            return found
        return (
            ReviveRobot(robot)
            if found.dead
            else RequestRefused(ToolRefusalReason.ALIVE, f"{_named(found)} runs already: its software has not stopped.")
        )

    def put(self, scene: Scene, shape: Shape, x: float, y: float, size: float) -> Request | RequestRefused:
        """Place an obstacle, which appears as soon as the place is free."""
        place = Pose2(x, y, 0.0)
        thing = obstacle(_new_name(thing.name for thing in scene.things), shape, place, size)
        return _off_map(scene, place) or PutThing(thing)

    def remove(self, scene: Scene, x: float, y: float) -> Request | RequestRefused:
        """Remove the obstacle at a place."""
        for thing in scene.things:
            corners = tuple((float(cx), float(cy)) for cx, cy in thing.outline[:-1])
            if inside(corners, np.array([x]), np.array([y]))[0]:
                return RemoveThing(thing.name)
        return RequestRefused(ToolRefusalReason.NO_THING, "There is no obstacle at this place.")

    def puppeteer(self, scene: Scene, robot: int, on: bool) -> WizardRequest | RequestRefused:
        """Begin or stop speaking for a robot."""
        found = _robot(scene, robot)
        return found if isinstance(found, RequestRefused) else WizardMode(robot, on)

    def speak(self, scene: Scene, turn: PendingTurn, move: int, text: str = "") -> WizardRequest | RequestRefused:
        """Make a robot's move. If `text` is not empty, it replaces the usual sentence."""
        if turn not in scene.wizard.turns or not 0 <= move < len(turn.sentences):
            return RequestRefused(ToolRefusalReason.NOT_WAITING, "It is too late to choose this move of the robot.")
        return WizardMove(turn.dialogue, turn.turn, move, text.strip())

    def advise(self, scene: Scene, robot: int, room: int) -> WizardRequest | RequestRefused:
        """Answer a participant's request for advice ("don't know") in the name of a robot."""
        if not any(waiting.robot == robot for waiting in scene.wizard.advice):
            return RequestRefused(ToolRefusalReason.NOT_WAITING, "The participant no longer waits for advice.")
        return WizardAdvice(robot, room)


def dragged_pose(x: float, y: float, to_x: float, to_y: float, heading: float = 0.0) -> Pose2:
    """Return the pose at the place where a drag began, with the heading to the place where the drag ended.

    If the two places are at most 0.1 m apart, the heading is `heading`.
    """
    dragged = math.hypot(to_x - x, to_y - y) >= 0.1
    return Pose2(x, y, math.atan2(to_y - y, to_x - x) if dragged else heading)


def obstacle(name: str, shape: Shape, place: Pose2, size: float) -> Thing:
    """Return an obstacle that does not move.

    Args:
        name: name for people.
        shape: round, or square with an edge along the heading.
        place: pose of the obstacle's middle.
        size: size in meters; values outside the allowed range are replaced by the smallest or largest size.
    """
    half = 0.5 * min(max(size, LEAST_SIZE), MOST_SIZE)
    if shape == "box":
        return Thing(name, ((half, half), (-half, half), (-half, -half), (half, -half)), place)
    angles = [math.tau * (corner + 0.5) / CORNERS for corner in range(CORNERS)]
    return Thing(name, tuple((half * math.cos(angle), half * math.sin(angle)) for angle in angles), place)


def _new_name(taken: Iterable[str]) -> str:
    known = set(taken)
    return next(name for number in count(1) if (name := f"obstacle {number}") not in known)


def _robot(scene: Scene, robot: int) -> RobotScene | RequestRefused:
    found = next((each for each in scene.robots if each.robot == robot), None)
    return found or RequestRefused(ToolRefusalReason.NO_ROBOT, "Select a robot first.")


def _alive_robot(scene: Scene, robot: int) -> RobotScene | RequestRefused:
    found = _robot(scene, robot)
    if isinstance(found, RobotScene) and found.dead:
        problem = f"The software of {found.name} has stopped. Revive the robot first (R)."
        return RequestRefused(ToolRefusalReason.DEAD, problem)
    return found


def _named(robot: RobotScene) -> str:
    return robot.name[:1].upper() + robot.name[1:]


def _off_map(scene: Scene, place: Pose2) -> RequestRefused | None:
    """Return the refusal for a place outside the map; None if the place is on the map or no map is known."""
    grid = scene.grid
    if grid is None:
        return None
    at = grid.origin.between(place)
    if 0.0 <= at.x < grid.cols * grid.resolution and 0.0 <= at.y < grid.rows * grid.resolution:
        return None
    return RequestRefused(ToolRefusalReason.OFF_MAP, "This place is not on the map.")
