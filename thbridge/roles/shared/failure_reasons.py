"""All sentences for the participant about failed moves.

The sentences are recorded. If you change a sentence, add a row to `thbridge.app.replay.rewordings`.
"""

from sim.common.robot_numbers import robot_name
from sim.robot.navigator.goals import NoPathReason

CALLED_BACK = "It was called back."
STOPPED = "It was stopped."
BY_HAND = "It is driven by hand."
ELSEWHERE = "It was sent elsewhere, or stopped."
NOT_READY = "The game is not ready for this move."

_SENTENCES: dict[NoPathReason, str] = {
    "blocked_by_obstacle": "Something that is not on the map blocks the path of {robot}.",
    "robots_in_the_way": "Other robots block the path of {robot} and do not move away.",
    "no_way": "The map has no path there from where {robot} believes it is.",
    "goal_occupied": "The place where {robot} should stand is inside a wall or too near to one.",
    "goal_outside": "The place where {robot} should stand is not on the map.",
    "start_occupied": "{robot} stands inside an obstacle, or too near to one to start.",
    "start_outside": "{robot} believes that it is outside the map.",
    "stuck": "{robot} is stuck and cannot get free.",
    "lost": "{robot} does not know where it is.",
    "gave_up": "{robot} has given up its goal.",
    "called_off": "A person at the robots' controls has canceled the goal of {robot}.",
    "unanswered": "The navigation of {robot} does not answer.",
}


def failure_sentence(robot: int, reason: NoPathReason) -> str:
    """Return a sentence about a robot (index from 0) for one of the navigator's reasons."""
    sentence = _SENTENCES[reason].format(robot=robot_name(robot))
    return sentence[0].upper() + sentence[1:]


def unknown_place_sentence(robot: int) -> str:
    """Return the sentence about a robot (index from 0) with a goal on an unknown part of the map."""
    return f"The map does not show what is at the place where {robot_name(robot)} should stand."


def unresponsive_sentence(robot: int) -> str:
    """Return the sentence about a robot (index from 0) that does not respond."""
    return f"{robot_name(robot).capitalize()} no longer answers."
