"""Views for tests: unvisited rooms 1 to 3, robots in the corridor, and changes of such a view."""

from dataclasses import replace

from msgspec import structs

from thbridge.hunt.events import Condition
from thbridge.roles.shared.view import DialogueView, LastWords, RefusalView, RobotView, RoomView, View
from ui.model.playing.participant import Participant

COSTS = ((None, 5.0, 9.0, 7.0), (None, None, 5.0, 5.0), (None, 5.0, None, 5.0), (None, 5.0, 5.0, None))


def view(robots: int = 2, rooms: int = 3, **changes) -> View:
    team = tuple(RobotView(robot, 0, None, 100.0, False, Condition.WELL) for robot in range(robots))
    known = tuple(RoomView(room, "unvisited", None, None, None, None, False) for room in range(1, rooms + 1))
    costs = COSTS if rooms == 3 else tuple((5.0,) * (rooms + 1) for _ in range(rooms + 1))
    return structs.replace(View(1, True, costs, team, known, (), (), 0, None, 5.0, 1.0, None), **changes)


def with_robot(was: View, robot: int, **changes) -> View:
    changed = replace(was.robots[robot], **changes)
    return structs.replace(was, robots=(*was.robots[:robot], changed, *was.robots[robot + 1 :]))


def with_room(was: View, room: int, **changes) -> View:
    changed = replace(was.room(room), **changes)
    return structs.replace(was, rooms=(*was.rooms[: room - 1], changed, *was.rooms[room:]))


def view_of(*moving_to: int | None) -> View:
    """Return a view with robots in the corridor, each driving to the given room, or to none if None."""
    shown = view(len(moving_to))
    for robot, room in enumerate(moving_to):
        if room is not None:
            shown = with_room(with_robot(shown, robot, moving_to=room), room, state="reserved", robot=robot)
    return shown


def asking(robot: int, room: int, number: int = 1, turn: int = 1) -> DialogueView:
    return DialogueView(number, turn, robot, "select-room", room, ("Shall I go?",), ("Continue", "Stop"))


def arguing(*turns: str, acts: tuple[str, ...] = ("accept", "leave"), robot: int = 0, room: int = 2) -> DialogueView:
    """Return a dialogue with these sentences; those of the participant begin with `>`."""
    said = tuple(turn.removeprefix(">") for turn in turns)
    speakers = tuple("person" if turn.startswith(">") else "robot" for turn in turns)
    return DialogueView(robot + 1, len(turns), robot, "select-room", room, said, acts, acts, speakers)


def refusal(number: int, request: str) -> RefusalView:
    return RefusalView(number, request, "no", f"No {request}.")


def model_of(*levels, now=0.0):
    model = Participant()
    model.connected(0.0)
    for level in levels:
        model.receive(level, now)
    model.screen(now)
    return model


def texts(screen):
    return [line.text for line in screen.history]


ANSWERS = ("accept", "challenge", "open-questions", "leave")


def argued(*dialogues, words=(), who="both", **changes) -> View:
    """Return a view of a game in which robots argue."""
    return view(dialogues=dialogues, last_words=words, has_last_word=who, **changes)


def ended(*, agreed: bool, robot: int = 0, said=("No.", "Leave it."), number: int = 1) -> LastWords:
    return LastWords(number, robot, "select-room", 2, said, ("robot", "person")[: len(said)], agreed)
