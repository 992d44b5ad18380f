"""What the participant asked for and the view does not show yet."""

from thbridge.roles.view import (
    Agree,
    Answer,
    AskBack,
    CallBack,
    Discuss,
    GiveUp,
    Leave,
    ParticipantRequest,
    PlayAgain,
    RefusalView,
    Select,
    Unsure,
    View,
)
from ui.model.playing.possible import (
    deciding_robot,
    discussed_matters,
    robot_in_room,
    why_not_command,
    why_not_go,
    why_not_work,
)


class PendingRequests:
    """Wishes that were said and are neither granted nor refused nor moot; each is there once, oldest first.

    They are kept while the connection is lost, for the view that comes after it tells what became of them.
    """

    def __init__(self) -> None:
        # With each, the dialogue that its robot already held: the one asked for is another.
        self._requests: dict[ParticipantRequest, int | None] = {}

    def __contains__(self, wish: ParticipantRequest) -> bool:
        return wish in self._requests

    @property
    def requests(self) -> tuple[ParticipantRequest, ...]:
        """All of them."""
        return tuple(self._requests)

    def ask(self, wish: ParticipantRequest, view: View) -> None:
        """One more wish; a robot is asked to go to one place at a time."""
        if isinstance(wish, Select | Unsure):
            self.forget_destination(wish.robot)
        self._requests[wish] = _talking(view, wish.robot) if isinstance(wish, Unsure) else None

    def forget_destination(self, robot: int) -> None:
        """Ask this robot to go nowhere any more."""
        for wish in self.requests:
            if isinstance(wish, Select | Unsure) and wish.robot == robot:
                del self._requests[wish]

    def destination_request(self, robot: int) -> Select | Unsure | None:
        """What was asked of this robot about where to go."""
        return next((w for w in self._requests if isinstance(w, Select | Unsure) and w.robot == robot), None)

    def answer(self, dialogue: int, turn: int) -> int | None:
        """The choice made at this turn of a dialogue, if the view does not show it yet."""
        answers = (w for w in self._requests if isinstance(w, Answer) and (w.dialogue, w.turn) == (dialogue, turn))
        return next((answer.choice for answer in answers), None)

    def drop_refused(self, refusal: RefusalView) -> None:
        """Drop the oldest wish that this refusal may be about, for it does not say which."""
        found = next((wish for wish in self._requests if refusal.wish in _kinds(wish)), None)
        if found is not None:
            del self._requests[found]

    def receive(self, view: View) -> tuple[str, ...]:
        """Drop what this view grants or makes moot; why it is moot, in words, where the participant should know."""
        reasons = []
        for wish, before in list(self._requests.items()):
            if isinstance(wish, Unsure) and _talking(view, wish.robot) is None:
                self._requests[wish] = None
            if _granted(wish, view, before):
                del self._requests[wish]
            elif (reason := _moot(wish, view)) is not None:
                del self._requests[wish]
                reasons.append(reason)
        return tuple(reasons)


def _kinds(wish: ParticipantRequest) -> tuple[str, ...]:
    """How a refusal of this wish may name it: what opens a dialogue is refused by what the dialogue is about."""
    match wish:
        case Select() | Unsure():
            return ("select-room", type(wish).__name__)
        case Discuss(matter=matter):
            return (matter, Discuss.__name__)
        case _:
            return (type(wish).__name__,)


def _talking(view: View, robot: int) -> int | None:
    return next((dialogue.dialogue for dialogue in view.dialogues if dialogue.robot == robot), None)


def _granted(wish: ParticipantRequest, view: View, before: int | None) -> bool:
    match wish:
        case Agree():
            return view.consent is None
        case Select(robot, room):
            return (robot, "select-room", room) in discussed_matters(view) or view.robots[robot].moving_to == room
        case Unsure(robot):
            fresh = _talking(view, robot) not in (None, before)
            agreed = any(consent.robot == robot and consent.matter == "select-room" for consent in view.consents)
            return fresh or agreed or view.robots[robot].moving_to is not None
        case Answer(dialogue, turn, _):
            return not any((talk.dialogue, talk.turn) == (dialogue, turn) for talk in view.dialogues)
        case CallBack(robot):
            return view.robots[robot].moving_to is None
        case AskBack(robot):
            return view.robots[robot].asked_back
        case Discuss(robot, matter, room):
            done = view.room(room).picture is not None if matter == "take-picture" else not view.room(room).undecided
            return done or (robot, matter, room) in discussed_matters(view)
        case Leave(room):
            return not view.room(room).undecided
        case GiveUp(game):
            return view.over is not None or view.game != game
        case PlayAgain(game):
            return view.game != game
        case _:
            return False


def _moot(wish: ParticipantRequest, view: View) -> str | None:
    """Why a wish cannot come true any more; empty where that goes without saying."""
    if view.over is not None:
        return None if isinstance(wish, PlayAgain) else ""
    match wish:
        case Select(robot, room):
            return why_not_go(view, robot, room)
        case Unsure(robot):
            return why_not_work(view, robot) or why_not_command(view, robot)
        case CallBack(robot):
            return why_not_command(view, robot)
        case AskBack(robot):
            # That it is theirs again they are told anyway.
            return None if view.robots[robot].other_commander else ""
        case Discuss(robot, matter, room) if robot != _worker(view, matter, room):
            return why_not_work(view, robot) or ""
        case _:
            return None


def _worker(view: View, matter: str, room: int) -> int | None:
    """The robot with which this can be talked over."""
    return deciding_robot(view, room) if matter == "take-treasure" else robot_in_room(view, room)
