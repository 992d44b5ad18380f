"""Questions that ask for confirmation before steps that cannot be undone."""

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from ui.model.keys import keyed
from ui.model.playing.memory.state import (
    EndGameEarly,
    HuntMemory,
    LeaveLast,
    LeaveUndecided,
    LeaveWindow,
    ParticipantMemory,
    Reroute,
)
from ui.model.playing.words import as_sentence, counted, place_name, scored, titled
from ui.model.screen import Cancel, Confirm, Confirmation


def confirmation(memory: ParticipantMemory, hunt: HuntMemory) -> Confirmation | None:
    """The question about the pending step, if there is one."""
    match hunt.pending_step:
        case Reroute(robot, room):
            return Confirmation(
                f"Send {robot_name(robot)} to room {room} instead?",
                _reroute_text(memory, hunt, robot, room),
                keyed(Confirm(), f"Stop it, then room {room}"),
                keyed(Cancel(), "Let it go on"),
            )
        case LeaveUndecided(request, room):
            return Confirmation(
                f"Leave what is in room {room}?",
                f"{titled(request.robot)} has found something in room {room} that you have not named yet. Once the "
                "robot sets out, that is left for good.",
                keyed(Confirm(), "Go on"),
                keyed(Cancel(), "Stay there"),
            )
        case EndGameEarly():
            left = sum(room.state == "unvisited" for room in hunt.view.rooms)
            return Confirmation(
                "End the game?",
                as_sentence(f"{counted(left, 'room')} left to visit. The score stays {scored(hunt.view.score)}."),
                keyed(Confirm(), "End the game"),
                keyed(Cancel(), "Play on"),
            )
        case LeaveLast(room):
            return Confirmation(
                "Leave it, and end the game?",
                f"Nothing is left to do but to decide about room {room}: if you leave what is there, the game ends. "
                f"The score stays {scored(hunt.view.score)}.",
                keyed(Confirm(), "Leave it"),
                keyed(Cancel(), "Not yet"),
            )
        case LeaveWindow(ends):
            return Confirmation(
                "Leave the game?",
                "The game is not over. It ends if you leave it."
                if ends
                else "The game is not over. The robots go on with what they are doing; you can come back.",
                keyed(Confirm(), "Leave the game"),
                keyed(Cancel(), "Stay"),
            )
        case None:
            return None


def _reroute_text(memory: ParticipantMemory, hunt: HuntMemory, robot: int, room: int) -> str:
    mover = hunt.view.robots[robot]
    back = hunt.known.state.robots[robot].paid * (1.0 - min(max(memory.motion(robot).progress, 0.0), 1.0))
    return (
        f"{titled(robot)} is on its way to {place_name(mover.moving_to or 0)}. If it stops, the energy for the rest of "
        f"that way comes back, about {energy_text(round(back, 1))}. Then it asks you about room {room}."
    )
