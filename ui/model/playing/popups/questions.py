"""Questions before what cannot be taken back."""

from thbridge.hunt.costs import spoken_energy
from thbridge.hunt.rules import robot_name
from thbridge.roles.view import View
from ui.model.keys import key_of
from ui.model.playing.possible import paid
from ui.model.playing.state import End, Hunt, Memory, MoveOn, Reroute
from ui.model.playing.words import as_sentence, counted, place_name, scored, titled
from ui.model.screen import Action, Meant, NotYet, Question


def question(memory: Memory, hunt: Hunt) -> Question | None:
    """What the participant is asked about, if anything."""
    match hunt.doubt:
        case Reroute(robot, room):
            return Question(
                f"Send {robot_name(robot)} to room {room} instead?",
                _reroute_text(memory, hunt.view, robot, room),
                Action(Meant(), f"Stop it, then room {room}", key_of(Meant())),
                Action(NotYet(), "Let it go on", key_of(NotYet())),
            )
        case MoveOn(wish, room):
            return Question(
                f"Leave what is in room {room}?",
                f"{titled(wish.robot)} has found something in room {room} that you have not named yet. Once the robot "
                "sets out, that is left for good.",
                Action(Meant(), "Go on", key_of(Meant())),
                Action(NotYet(), "Stay there", key_of(NotYet())),
            )
        case End():
            left = sum(room.state == "unvisited" for room in hunt.view.rooms)
            return Question(
                "End the game?",
                as_sentence(f"{counted(left, 'room')} left to visit. The score stays {scored(hunt.view.score)}."),
                Action(Meant(), "End the game", key_of(Meant())),
                Action(NotYet(), "Play on", key_of(NotYet())),
            )
        case None:
            return None


def _reroute_text(memory: Memory, view: View, robot: int, room: int) -> str:
    mover = view.robots[robot]
    back = paid(view, mover) * (1.0 - min(max(memory.motion(robot).progress, 0.0), 1.0))
    cost = view.costs[0][room]
    price = "" if cost is None else f", which costs about {spoken_energy(round(cost, 1))}"
    return (
        f"{titled(robot)} is on its way to {place_name(mover.moving_to or 0)}. If it stops, the energy for the rest of "
        f"that way comes back, about {spoken_energy(round(back, 1))}. Then it asks you about room {room}{price}."
    )
