"""Requests of the participant whose effects are not in the latest view yet."""

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.participant_rules import Situation, revealed
from thbridge.roles.shared.team_notices import RaiseObjection, Vote, VoteView
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    GiveConsent,
    HandOver,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RefusalView,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    StopRobot,
    TakeUpTreasure,
    TellProperty,
    View,
    refusal_wishes,
)
from ui.model.playing.possible import why_not_ask, why_not_command, why_not_find_out, why_not_go, why_not_work
from ui.model.playing.seat_view import decision_about, decisions, has_objected


class PendingRequests:
    """Requests that are not granted, refused or obsolete yet, without duplicates, oldest first.

    The requests are kept while the connection is lost, because the next view shows their results.
    """

    def __init__(self) -> None:
        # For each request for advice, the number of the robot's open dialogue at the time of the request. A dialogue
        # with another number grants the request.
        self._requests: dict[ParticipantRequest, int | None] = {}
        # For each request for a dialogue, the number of the robot's last ended dialogue at the time of the request.
        self._ended: dict[ParticipantRequest, int | None] = {}

    def __contains__(self, request: ParticipantRequest) -> bool:
        return request in self._requests

    def has_kind(self, kind: type[ParticipantRequest]) -> bool:
        """Return True if a request of this kind is pending."""
        return any(isinstance(request, kind) for request in self._requests)

    @property
    def requests(self) -> tuple[ParticipantRequest, ...]:
        """All pending requests, oldest first."""
        return tuple(self._requests)

    def ask(self, request: ParticipantRequest, view: View) -> None:
        """Add a request. It replaces earlier ones about the robot's next room, the same property or the same vote."""
        if isinstance(request, SelectRoom | RequestSuggestion):
            self.forget_destination(request.robot)
        if isinstance(request, TellProperty):
            about = (request.room, request.property)
            told = [each for each in self._requests if isinstance(each, TellProperty)]
            for earlier in (each for each in told if (each.room, each.property) == about):
                del self._requests[earlier]
        if isinstance(request, Vote):
            votes = [each for each in self._requests if isinstance(each, Vote)]
            for vote in (each for each in votes if each.decision == request.decision):
                del self._requests[vote]
        self._requests[request] = (
            _open_dialogue(view, request.robot) if isinstance(request, RequestSuggestion) else None
        )
        self._ended[request] = _ended_dialogue(view, request)

    def forget_destination(self, robot: int) -> None:
        """Drop the requests to this robot about its next room."""
        for request in self.requests:
            if isinstance(request, SelectRoom | RequestSuggestion) and request.robot == robot:
                del self._requests[request]

    def destination_request(self, robot: int) -> SelectRoom | RequestSuggestion | None:
        """Return the pending request to this robot about its next room; None if there is none."""
        destinations = (request for request in self._requests if isinstance(request, SelectRoom | RequestSuggestion))
        return next((request for request in destinations if request.robot == robot), None)

    def answer(self, dialogue: int, turn: int) -> int | None:
        """Return the participant's choice at a turn of a dialogue, as long as the view does not show the choice."""
        answers = (request for request in self._requests if isinstance(request, AnswerDialogue))
        return next((each.choice for each in answers if (each.dialogue, each.turn) == (dialogue, turn)), None)

    def drop_refused(self, refusal: RefusalView) -> ParticipantRequest | None:
        """Drop and return the oldest request of the kind that this refusal names; None if there is none."""
        found = next((request for request in self._requests if refusal.wish in refusal_wishes(request)), None)
        if found is not None:
            del self._requests[found]
        return found

    def receive(self, texts: Texts, view: View) -> tuple[str, ...]:
        """Drop the requests that this view grants or makes obsolete; return the reasons to show to the participant."""
        reasons = []
        known = revealed(view)
        for request, before in list(self._requests.items()):
            if isinstance(request, RequestSuggestion) and _open_dialogue(view, request.robot) is None:
                self._requests[request] = None
            if _granted(request, view, known, before) or _ended_dialogue(view, request) not in (
                None,
                self._ended[request],
            ):
                del self._requests[request]
            elif (reason := _moot(texts, request, view, known)) is not None:
                del self._requests[request]
                reasons.append(reason)
        return tuple(reasons)


def _open_dialogue(view: View, robot: int) -> int | None:
    return next((dialogue.dialogue for dialogue in view.dialogues if dialogue.robot == robot), None)


def _ended_dialogue(view: View, request: ParticipantRequest) -> int | None:
    """Return the number of the last ended dialogue with the robot if the request is for a new dialogue, or None."""
    if not isinstance(request, SelectRoom | RequestSuggestion | OpenDialogue):
        return None
    return next((words.dialogue for words in view.last_words if words.robot == request.robot), None)


def _granted(request: ParticipantRequest, view: View, known: Situation, before: int | None) -> bool:
    match request:
        case GiveConsent():
            return view.consent is None
        case SelectRoom(robot, room):
            return (robot, "select-room", room) in known.discussed or view.robots[robot].moving_to == room
        case RequestSuggestion(robot):
            fresh = _open_dialogue(view, robot) not in (None, before)
            agreed = any(consent.robot == robot and consent.matter == "select-room" for consent in view.consents)
            stands = any(dialogue.robot == robot and dialogue.suggested for dialogue in view.dialogues)
            return fresh or stands or agreed or view.robots[robot].moving_to is not None
        case AnswerDialogue(dialogue, turn, _):
            return not any((each.dialogue, each.turn) == (dialogue, turn) for each in view.dialogues)
        case StopRobot(robot):
            return view.robots[robot].moving_to is None
        case RequestHandback(robot):
            return view.robots[robot].asked_back
        case OpenDialogue(robot, matter, room):
            done = view.room(room).picture is not None if matter == "take-picture" else not view.room(room).undecided
            return done or (robot, matter, room) in known.discussed
        case LeaveTreasure(room):
            return not view.room(room).undecided
        case TakeUpTreasure(room):
            return not view.room(room).left
        case MeasureProperty(room, name):
            return name in view.room(room).known
        case TellProperty(room, name, value):
            return view.room(room).told.get(name) == value
        case EndGame(game):
            # If several people must agree, the request opens a vote.
            return view.over is not None or view.game != game or decision_about(view) is not None
        case HandOver(robot):
            return view.robots[robot].has_other_commander
        case Vote(decision, agrees, reason):
            known_votes = {each.decision: each.votes for each in decisions(view)}
            own = "" if view.team is None else view.team.own.name
            return decision not in known_votes or VoteView(own, agrees, reason) in known_votes[decision]
        case RaiseObjection(dialogue):
            # If the dialogue has ended before the objection, the game refuses it.
            return has_objected(view, dialogue) or all(each.dialogue != dialogue for each in view.dialogues)
        case PlayAgain(game):
            return view.game != game
        case _:
            return False


def _moot(texts: Texts, request: ParticipantRequest, view: View, known: Situation) -> str | None:
    """Return the reason why a request is obsolete; empty if the reason is obvious.

    Return None if the request is not obsolete.
    """
    if view.over is not None:
        return None if isinstance(request, PlayAgain) else ""
    match request:
        case SelectRoom(robot, room):
            return why_not_go(texts, known, robot, room)
        case RequestSuggestion(robot):
            return why_not_ask(texts, known, robot)
        case StopRobot(robot):
            return why_not_command(texts, known, robot)
        case RequestHandback(robot):
            # Another text already announces that the participant has got the robot back.
            return None if view.robots[robot].has_other_commander else ""
        case TakeUpTreasure() | MeasureProperty() | TellProperty():
            return why_not_find_out(texts, known, request)
        case OpenDialogue(robot, matter, room) if robot != _worker(known.state, matter, room):
            return why_not_work(texts, known, robot) or ""
        case _:
            return None


def _worker(state: GameState, matter: str, room: int) -> int | None:
    """Return the robot with which the participant can discuss a matter."""
    return state.decider(Room(room)) if matter == "take-treasure" else state.standing_in(Room(room))
