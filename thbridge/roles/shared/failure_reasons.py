"""Sentences for the participant about moves that failed; all of them stand here."""

from sim.common.robot_numbers import robot_name
from sim.robot.navigator.goals import NoPathReason

CALLED_BACK = "It was called back."
STOPPED = "It was stopped."
BY_HAND = "It is driven by hand."
ELSEWHERE = "It was sent elsewhere, or stopped."
NOT_READY = "The game is not ready for this move."

_SENTENCES: dict[NoPathReason, str] = {
    "blocked_by_obstacle": "Something that is not on the map blocks the way of {robot}.",
    "robots_in_the_way": "Other robots stand in the way of {robot} and do not clear it.",
    "no_way": "The map has no way there from where {robot} believes it is.",
    "goal_occupied": "Where {robot} should stand, the map has a wall, or one too near.",
    "goal_outside": "The place where {robot} should stand is not on the map.",
    "start_occupied": "{robot} stands within something, or too near to it to set out.",
    "start_outside": "{robot} believes that it is where the map has nothing.",
    "stuck": "{robot} is stuck and cannot get free.",
    "lost": "{robot} does not know where it is.",
    "gave_up": "{robot} has given up the way there.",
    "called_off": "Somebody at the robots' controls has called {robot} off.",
    "unanswered": "The navigation of {robot} does not answer.",
}


def failure_sentence(robot: int, reason: NoPathReason) -> str:
    """Return a sentence about a robot, counted from 0, for one of the navigator's reasons."""
    sentence = _SENTENCES[reason].format(robot=robot_name(robot))
    return sentence[0].upper() + sentence[1:]


def unknown_place_sentence(robot: int) -> str:
    """Return the sentence about a robot, counted from 0, that should stand where the map knows nothing."""
    return f"The map does not know what is where {robot_name(robot)} should stand."


def unresponsive_sentence(robot: int) -> str:
    """Return the sentence about a robot, counted from 0, that does not respond."""
    return f"{robot_name(robot).capitalize()} does not answer any more."
