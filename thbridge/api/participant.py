"""Requests of the participant, sent by a program instead of a window."""

import operator
from collections.abc import Callable, Sequence
from typing import Literal, SupportsIndex

from sim.common.robot_numbers import index_of
from thbridge.api.errors import HuntError
from thbridge.api.view import HuntView, view_of
from thbridge.hunt.events import ObjectionReason
from thbridge.roles.shared.team_notices import REASONS, RaiseObjection, SayToPeople, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    GiveConsent,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestHandback,
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
    """Player for TabUI that sends each request once."""

    def __init__(self) -> None:
        self._waiting: list[ParticipantRequest] = []

    def put(self, request: ParticipantRequest) -> None:
        """Queue a request for the next step."""
        self._waiting.append(request)

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests to send; see `Player`."""
        waiting, self._waiting = self._waiting, []
        return waiting


class HuntParticipant:
    """Requests of the participant, as the participant's window sends them.

    A few ticks later, a request takes effect or is refused. A refusal is an event, and is shown in the view.

    Decisions that are discussed with a robot need an agreement first. To send a robot to a room, call `select` or
    `suggest`, call `answer` until the view contains the agreement, then call `send`. For a treasure, begin with
    `discuss`, and end with `take_picture` or `name`.

    Robots and rooms are numbers from 1.

    Attributes:
        seat: name of the participant's seat; empty in a game with one participant.
    """

    def __init__(
        self, ask: Callable[[ParticipantRequest], None], view: Callable[[], View | None], robots: int, seat: str = ""
    ) -> None:
        self._ask = ask
        self._view = view
        self._robots = robots
        self.seat = seat

    @property
    def view(self) -> HuntView | None:
        """Part of the state that this participant may know; None in the first ticks, before the game sends a view."""
        view = self._view()
        return None if view is None else view_of(view)

    def agree(self) -> None:
        """Give consent to take part, if the study asks for consent."""
        self._ask(GiveConsent())

    def select(self, robot: int, room: int) -> None:
        """Ask a robot to go to a room, which opens a dialogue."""
        self._ask(SelectRoom(self._index(robot), whole("room", room)))

    def suggest(self, robot: int) -> None:
        """Ask a robot for a suggestion of a room, which opens a dialogue."""
        self._ask(RequestSuggestion(self._index(robot)))

    def answer(self, robot: int, choice: int = 0) -> None:
        """Answer a robot that waits for an answer; `choice` is an index from 0, and 0 is the most agreeable answer.

        Raises:
            HuntError: the robot does not wait for an answer, or the choice does not exist.
        """
        view = self._view()
        dialogues = () if view is None else view.dialogues
        talk = next((each for each in dialogues if each.robot == self._index(robot) and each.choices), None)
        if talk is None:
            raise HuntError(f"robot {robot} does not wait for an answer. Check view.dialogues first.")
        if not 0 <= choice < len(talk.choices):
            raise HuntError(f"there is no choice {choice}. Give 0 to {len(talk.choices) - 1} for {talk.choices}.")
        self._ask(AnswerDialogue(talk.dialogue, talk.turn, whole("choice", choice)))

    def send(self, robot: int, room: int) -> None:
        """Send a robot to a room after an agreement."""
        self._ask(SendRobot(self._index(robot), whole("room", room)))

    def stop(self, robot: int) -> None:
        """Stop a robot that is driving to a room."""
        self._ask(StopRobot(self._index(robot)))

    def sense(self, room: int) -> None:
        """Sense the treasure in a room that a robot has reached."""
        self._ask(SenseTreasure(whole("room", room)))

    def measure(self, room: int, name: str) -> None:
        """Let the robot measure one more property of the treasure in a room, which costs energy."""
        self._ask(MeasureProperty(whole("room", room), name))

    def tell(self, room: int, name: str, value: str) -> None:
        """Report a property of the treasure in a room that only people can see."""
        self._ask(TellProperty(whole("room", room), name, value))

    def discuss(
        self, robot: int, matter: Literal["take-picture", "take-treasure"], room: int, name: str | None = None
    ) -> None:
        """Open a dialogue with a robot about a picture of the treasure, or about `name` as the treasure's name."""
        self._ask(OpenDialogue(self._index(robot), matter, whole("room", room), name))

    def take_picture(self, room: int) -> None:
        """Take a picture of the treasure in a room."""
        self._ask(TakePicture(whole("room", room)))

    def name(self, room: int, name: str) -> None:
        """Name the treasure in a room."""
        self._ask(IdentifyTreasure(whole("room", room), name))

    def leave_treasure(self, room: int) -> None:
        """Leave the treasure in a room without naming it."""
        self._ask(LeaveTreasure(whole("room", room)))

    def take_up(self, room: int) -> None:
        """Return to a treasure that was left without a name, while the robot is still in the room."""
        self._ask(TakeUpTreasure(whole("room", room)))

    # Requests in games with several seats

    def hand_over(self, robot: int, seat: str) -> None:
        """Hand over the command of a robot to the participant of another seat."""
        self._ask(HandOver(self._index(robot), seat))

    def ask_for(self, robot: int) -> None:
        """Ask the commander of a robot, for example the participant of another seat, to hand it over."""
        self._ask(RequestHandback(self._index(robot)))

    def say(self, text: str, to: str = "") -> None:
        """Send a text to the participant of the seat `to`, or to all other participants."""
        self._ask(SayToPeople(text, to))

    def vote(self, decision: int, agrees: bool, reason: str = "") -> None:
        """Vote on a decision, given its number in `view.votes`."""
        self._ask(Vote(whole("decision", decision), agrees, reason))

    def object_to(self, robot: int, reason: str, text: str = "") -> None:
        """Object in the open dialogue of another seat with a robot, once in a dialogue.

        Args:
            robot: number of the robot.
            reason: "too-far", "other-room" or "other-robot" about a move, "not-needed" or "save-energy" about a
                picture, "wrong-name" or "not-sure" about a name.
            text: own words about it, if the study lets participants send texts.

        Raises:
            HuntError: there is no open dialogue with the robot, or the reason does not fit it.
        """
        view = self._view()
        dialogues = () if view is None else view.dialogues
        talk = next((each for each in dialogues if each.robot == self._index(robot)), None)
        if talk is None:
            raise HuntError(f"no dialogue with robot {robot} is open. Check view.dialogues first.")
        if reason not in REASONS[talk.matter]:
            raise HuntError(f"there is no reason {reason!r}. Give one of these: {', '.join(REASONS[talk.matter])}.")
        self._ask(RaiseObjection(talk.dialogue, ObjectionReason(reason), text))

    def end_game(self) -> None:
        """End the game even if robots can still act."""
        self._ask(EndGame(self._game()))

    def play_again(self) -> None:
        """Start a new game after this one has ended."""
        self._ask(PlayAgain(self._game()))

    def _game(self) -> int:
        view = self._view()
        return 0 if view is None else view.game

    def _index(self, robot: int) -> int:
        return checked_index(robot, self._robots)

    def __repr__(self) -> str:
        seat = f" {self.seat}" if self.seat else ""
        return f"<HuntParticipant{seat} of {self._robots} robots>"


def checked_index(robot: int, robots: int) -> int:
    """Return a robot's index, given its number. Raises HuntError: the robot does not exist."""
    if not 1 <= robot <= robots:
        raise HuntError(f"there is no robot {robot}. Give a number from 1 to {robots}.")
    return index_of(whole("robot", robot))


def whole(name: str, value: SupportsIndex) -> int:
    """Convert a number, possibly of NumPy, into an int. Raises HuntError: the value is not a whole number."""
    try:
        return operator.index(value)
    except TypeError:
        raise HuntError(f"{name}: {value!r} is not a whole number. Give a whole number.", key=name) from None
