"""The states of move_base, and the transitions between them.

Source: ros-planning/navigation, move_base/include/move_base/move_base.h (MoveBaseState).
Differences from ROS: a robot without a goal is in state Idle, and a robot that is not localized is in state Lost.
"""

from dataclasses import dataclass
from typing import Literal

from sim.common.frozen import frozen
from sim.common.observations import Claim
from sim.numerics.float_array import FloatArray
from sim.robot.navigator.follower import STANDING, Follower, FollowerOutput
from sim.robot.navigator.recovery import RunningRecovery


@dataclass(frozen=True, slots=True)
class WantedPath:
    """A path that other robots are asked to clear.

    Attributes:
        poses: (m, 3) poses in the map.
        claim: priority of the robot that wants the path.
    """

    poses: FloatArray
    claim: Claim | None


@dataclass(frozen=True, slots=True)
class Idle:
    """State in which the robot stands without a goal.

    Attributes:
        wanted: path on which the robot would make way for another robot that has asked for this.
    """

    wanted: WantedPath | None = None


@dataclass(frozen=True, slots=True)
class Planning:
    """State in which the robot stands and has no plan to its goal yet.

    Attributes:
        wanted: path that other robots block: to the robot's goal, or to a place where it would make way.
        waits_for: other robot that goes first.
    """

    wanted: WantedPath | None = None
    waits_for: int | None = None


@frozen()
class Controlling:
    """State in which the robot follows an itinerary.

    Attributes:
        follower: follower of the itinerary.
        gives_way: True if the itinerary leads away from another robot's path. The robot may have a goal or not.
        output: output of the follower's last step.
        makes_way_for: other robot with the right of way. The itinerary leads away from its path, waits for it, or makes
            a detour around it.
    """

    follower: Follower
    gives_way: bool
    output: FollowerOutput = STANDING
    makes_way_for: int | None = None


@dataclass(frozen=True, slots=True)
class Clearing:
    """State in which the robot turns once around to see more (rotate_recovery), or runs an installed recovery behavior.

    Attributes:
        turn_left: remaining turn, radians.
        then: state in which the robot continues.
        behavior: the installed behavior. If None, the robot turns.
        began: tick in which the behavior began.
    """

    turn_left: float
    then: Idle | Planning | Controlling
    behavior: RunningRecovery | None = None
    began: int = 0


@dataclass(frozen=True, slots=True)
class Lost:
    """State in which the robot is not localized. If it has a goal, it looks around."""


State = Idle | Planning | Controlling | Clearing | Lost
Event = Literal[
    "goal received",
    "goal ended",
    "plan made",
    "deferred",
    "blocked by robots",
    "plan refused",
    "asked to clear",
    "no longer asked",
    "command due",
    "way given",
    "recovery",
    "recovery ended",
    "replan requested",
    "lost",
    "located",
]

TRANSITIONS: set[tuple[type[State], Event, type[State]]] = {
    # Idle: the robot stands without a goal.
    (Idle, "goal received", Planning),  # Plan as soon as it is this robot's turn.
    (Idle, "asked to clear", Controlling),  # Drive to a refuge off the other robot's path.
    (Idle, "asked to clear", Idle),  # If there is no free refuge, ask nearby robots to clear a path to a refuge.
    (Idle, "no longer asked", Idle),  # Stop asking nearby robots.
    (Idle, "replan requested", Idle),  # Stop asking nearby robots.
    (Idle, "lost", Lost),  # Forget the obstacles seen by the laser.
    # Planning: the robot stands, and plans whenever it is its turn (`planning_cycle`).
    (Planning, "plan made", Controlling),  # Follow the plan.
    (Planning, "deferred", Planning),  # The goal is on the path of a robot with an older goal, which goes first.
    (Planning, "blocked by robots", Planning),  # Ask the robots to clear the path. After CLEARING_TIMEOUT, give up.
    (Planning, "plan refused", Planning),  # Try again. After planner_patience try a recovery behavior, then give up.
    (Planning, "asked to clear", Controlling),
    (Planning, "asked to clear", Planning),
    (Planning, "recovery", Clearing),  # rotate_recovery: turn once around. Resets of costmaps change no state.
    (Planning, "replan requested", Planning),
    (Planning, "goal ended", Idle),  # Given up or cancelled.
    (Planning, "lost", Lost),
    # Controlling: a command is due at controller_frequency (`control_cycle`).
    (Controlling, "command due", Controlling),  # Ask the follower for a command.
    (Controlling, "plan made", Controlling),  # An obstacle or a delay, or planner_frequency, made a new plan due.
    (Controlling, "blocked by robots", Planning),
    (Controlling, "plan refused", Planning),
    (Controlling, "recovery", Clearing),  # Oscillation, or no valid command for controller_patience.
    (Controlling, "way given", Idle),  # Stand off the other robot's path.
    (Controlling, "way given", Planning),  # For GIVE_WAY_TIME, the other robot plans first.
    (Controlling, "replan requested", Idle),
    (Controlling, "replan requested", Planning),
    (Controlling, "goal ended", Idle),  # Reached, given up or cancelled.
    (Controlling, "lost", Lost),
    # Clearing: a recovery behavior, or reset of costmaps (`clearing_cycle`).
    (Clearing, "command due", Clearing),  # Continue the turn or the behavior, as far as it is safe.
    (Clearing, "asked to clear", Clearing),  # Give way after the turn.
    (Clearing, "recovery ended", Idle),
    (Clearing, "recovery ended", Planning),
    (Clearing, "recovery ended", Controlling),
    (Clearing, "replan requested", Clearing),
    (Clearing, "goal ended", Clearing),  # Cancelled. The turn is still completed.
    (Clearing, "lost", Lost),
    # Lost: the robot looks around until it is localized.
    (Lost, "located", Idle),
    (Lost, "located", Planning),
}
"""All changes of the state, with the actions as comments.

A goal that arrives while the robot gives way or is lost has to wait.
"""
