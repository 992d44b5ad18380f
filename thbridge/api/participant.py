"""The participant's seat: requests of a person's window, made by a program."""

import operator
from collections.abc import Callable, Sequence
from typing import Literal, SupportsIndex

from sim.common.robot_numbers import index_of
from thbridge.api.errors import HuntError
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    GiveConsent,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
    View,
)


class QueuePlayer:
    """Player for TabUI that makes each request once."""

    def __init__(self) -> None:
        self._waiting: list[ParticipantRequest] = []

    def put(self, request: ParticipantRequest) -> None:
        """Make this request with the next step."""
        self._waiting.append(request)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """See `Player`."""
        waiting, self._waiting = self._waiting, []
        return waiting


class HuntParticipant:
    """Requests of the participant, as a person's window makes them; each acts a few ticks later, or is refused.

    What a person talks over with a robot has to be agreed upon first: `select` or `suggest`, answers until the view has
    the agreement, then `send`; `discuss`, then `take_picture` or `name`. A refusal is an event, and in the view.

    Robots and rooms are numbers from 1, here as everywhere that people read them.
    """

    def __init__(self, ask: Callable[[ParticipantRequest], None], view: Callable[[], View | None], robots: int) -> None:
        self._ask = ask
        self._view = view
        self._robots = robots

    def agree(self) -> None:
        """Agree to take part, where the study asks for that."""
        self._ask(GiveConsent())

    def select(self, robot: int, room: int) -> None:
        """Ask a robot to go to a room: a dialogue begins."""
        self._ask(SelectRoom(self._index(robot), whole("room", room)))

    def suggest(self, robot: int) -> None:
        """Ask a robot where it would go: a dialogue begins."""
        self._ask(RequestSuggestion(self._index(robot)))

    def answer(self, robot: int, choice: int = 0) -> None:
        """Answer the robot that waits for one; the choice counts from 0, the most agreeable.

        Raises:
            HuntError: there is no such answer.
        """
        view = self._view()
        dialogues = () if view is None else view.dialogues
        talk = next((each for each in dialogues if each.robot == self._index(robot) and each.choices), None)
        if talk is None:
            raise HuntError(f"robot {robot} waits for no answer. Look at view.dialogues first.")
        if not 0 <= choice < len(talk.choices):
            raise HuntError(f"there is no choice {choice}. Choose one of 0 to {len(talk.choices) - 1}: {talk.choices}.")
        self._ask(AnswerDialogue(talk.dialogue, talk.turn, whole("choice", choice)))

    def send(self, robot: int, room: int) -> None:
        """Send a robot to the room agreed upon."""
        self._ask(SendRobot(self._index(robot), whole("room", room)))

    def stop(self, robot: int) -> None:
        """Stop a robot that drives to a room."""
        self._ask(StopRobot(self._index(robot)))

    def sense(self, room: int) -> None:
        """Sense the treasure in a room that a robot reached."""
        self._ask(SenseTreasure(whole("room", room)))

    def measure(self, room: int, name: str) -> None:
        """Let the robot sense one more property of the treasure in a room, for energy."""
        self._ask(MeasureProperty(whole("room", room), name))

    def tell(self, room: int, name: str, value: str) -> None:
        """Tell a property of the treasure in a room that only people can tell."""
        self._ask(TellProperty(whole("room", room), name, value))

    def discuss(
        self, robot: int, matter: Literal["take-picture", "take-treasure"], room: int, name: str | None = None
    ) -> None:
        """Talk with a robot about taking a picture, or the treasure: a dialogue begins; `name` is the treasure's."""
        self._ask(OpenDialogue(self._index(robot), matter, whole("room", room), name))

    def take_picture(self, room: int) -> None:
        """Take a picture of the treasure in a room."""
        self._ask(TakePicture(whole("room", room)))

    def name(self, room: int, name: str) -> None:
        """Name the treasure in a room."""
        self._ask(IdentifyTreasure(whole("room", room), name))

    def leave_treasure(self, room: int) -> None:
        """Leave the treasure in a room undecided."""
        self._ask(LeaveTreasure(whole("room", room)))

    def take_up(self, room: int) -> None:
        """Take back that a treasure was left, while its robot still stands there."""
        self._ask(TakeUpTreasure(whole("room", room)))

    def end_game(self) -> None:
        """End the game although robots could still do something."""
        self._ask(EndGame(self._game()))

    def play_again(self) -> None:
        """Begin a new game once this one is over."""
        self._ask(PlayAgain(self._game()))

    def _game(self) -> int:
        view = self._view()
        return 0 if view is None else view.game

    def _index(self, robot: int) -> int:
        return checked_index(robot, self._robots)

    def __repr__(self) -> str:
        return f"<HuntParticipant of {self._robots} robots>"


def checked_index(robot: int, robots: int) -> int:
    """Return the index of a robot's number. Raises HuntError: there is no such robot."""
    if not 1 <= robot <= robots:
        raise HuntError(f"there is no robot {robot}. Name one of 1 to {robots}.")
    return index_of(whole("robot", robot))


def whole(name: str, value: SupportsIndex) -> int:
    """Return a whole number, also one of numpy. Raises HuntError: the argument of this name is none."""
    try:
        return operator.index(value)
    except TypeError:
        raise HuntError(f"{name}: {value!r} is no whole number. Give one.", key=name) from None
