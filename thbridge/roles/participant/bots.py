"""Simulated participants. Like a person in front of the window, they know only the view."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from sim.numerics import noise
from thbridge.dialogue.games.strategies import Attitude
from thbridge.hunt.events import Condition
from thbridge.hunt.properties import Teller
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.reply_policy import Opinion, ReplyPolicy
from thbridge.roles.shared.participant_rules import revealed
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.team_notices import Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    DialogueView,
    EndGame,
    GiveConsent,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    TakePicture,
    TellProperty,
    View,
)

STOP_PROBABILITY = 0.1
"""Probability that the `random` participant answers Stop."""
MAX_ATTEMPTS = 3
"""The bot gives up after this number of failed moves of a robot to a room, or failed dialogues about a treasure."""
TALKS_AS_USUAL, TALKS_ABOUT_ROOMS, MOST_TALKS = 2, 4, 6
"""Numbers of failed dialogues with a robot. After the first number, the bot no longer asks for advice. After the second
number, it no longer chooses rooms itself, but asks for advice again and accepts all advice. After the third number, it
no longer talks with the robot."""
PATIENCE = 20
"""Number of looks at an unchanged view after which a bot acts without its teammates. TabUI lets it look at each new
view, and at least every `RETRY_PERIOD`."""
DEAR = 2.0
"""A room is too expensive for a cautious participant if it costs more than this number of times the cheapest room."""


@dataclass(frozen=True, slots=True)
class TreasureKnowledge:
    """Knowledge of the participant: all treasures, and their pictures.

    Attributes:
        kinds: kinds of the participant's treasure list.
        shown_by: name of the treasure on each picture, by the picture's file name.
    """

    kinds: tuple[TreasureKind, ...]
    shown_by: Mapping[str, str]


class Bot:
    """A simulated participant. It is a player for TabUI.

    It handles each robot separately. Before a robot drives to another room, the bot decides about the found treasure:

    * If the known properties determine the name, the bot names the treasure.
    * Otherwise the robot senses a further property, if this costs less than a picture.
    * Otherwise the bot takes a picture and enters the properties that only people can recognize.
    * If there is not enough energy for this, the bot leaves the treasure.

    For a robot with another commander, the bot only decides about found treasures, and waits. With all strategies,
    rooms that a robot did not reach are chosen last, and are given up after three attempts. A lost robot is sent only
    once, because it may localize itself during the drive. If there are no further requests, the bot ends the game.

    The bot counts dialogues without an agreement until the robot drives again. After two such dialogues about a room,
    it chooses another room. After some further dialogues, it follows the robot's advice. Finally, it stops talking with
    the robot.

    In a game with several seats, the bot sends only requests that its seat may send. It names what the robots of other
    seats have found, and leaves a treasure if nobody finds out more about it for a time.

    Args:
        strategy: strategy for the choice of rooms.
        knowledge: knowledge of treasures.
        seed: random seed. Only the strategy `random` and the sceptical attitude use random numbers.
        attitude: attitude to robots' claims.
    """

    def __init__(
        self,
        strategy: BotStrategy,
        knowledge: TreasureKnowledge,
        seed: int,
        attitude: Attitude = Attitude.CREDULOUS,
    ) -> None:
        self._strategy = strategy
        self._replies = ReplyPolicy(attitude, seed)
        self._taken_advice = ReplyPolicy(Attitude.CREDULOUS, seed)
        self._knowledge = knowledge
        self._choices = noise.key(seed, "participant", "choices")
        self._doubts = noise.key(seed, "participant", "doubts")
        self._stopped: set[int] = set()
        self._destinations: dict[int, int] = {}
        self._failed_moves: Counter[tuple[int, int]] = Counter()
        self._lost: set[int] = set()
        # By robot: the last request for a dialogue without a result in the views.
        self._asked: dict[int, _TalkRequest] = {}
        self._talking: set[int] = set()
        self._refusals = 0
        # By robot: rooms of failed dialogues since its last drive. None means a dialogue about advice.
        self._vain: dict[int, list[int | None]] = {}
        self._vain_matters: Counter[tuple[str, int]] = Counter()
        # In a game with several seats: numbers of looks at treasures that others examine, and of
        # looks without a request.
        self._waited: Counter[tuple[int, int]] = Counter()
        self._idle = 0

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the next requests; see `Player`."""
        if view.over is not None:
            return ()
        if view.consent is not None:
            return (GiveConsent(),)
        self._count_failures(view)
        self._count_talks_in_vain(view)
        decisions = () if view.team is None else view.team.decisions
        own = "" if view.team is None else view.team.own.name
        requests: list[ParticipantRequest] = [
            self._answer(view, dialogue) for dialogue in view.dialogues if dialogue.choices
        ]
        requests += [
            Vote(each.decision, agrees=True)
            for each in decisions
            if own not in {each.seat, *(vote.seat for vote in each.votes)}
        ]
        open_matters: Sequence[DialogueView | Consent] = (*view.dialogues, *view.consents)
        taken = {item.room for item in open_matters if item.matter == "select-room"}
        for robot in view.robots:
            for request in self._for_robot(view, robot, taken):
                requests.append(request)
                if isinstance(request, SelectRoom | RequestSuggestion | OpenDialogue):
                    self._asked[robot.robot] = request
                if isinstance(request, SelectRoom):
                    taken.add(request.room)
        moves = any(robot.moving_to is not None for robot in view.robots)
        if requests or not view.robots or view.dialogues or view.thinking or moves:
            self._idle = 0
            return requests
        self._idle += 1
        if any(robot.has_other_commander for robot in view.robots) and (view.team is None or self._idle < PATIENCE):
            return ()
        end = EndGame(view.game)
        return (end,) if _is_allowed(view, end) else ()

    def _count_failures(self, view: View) -> None:
        """Count failed moves by robot and room. Record robots that are lost after a failed move."""
        for robot in view.robots:
            if robot.condition is not Condition.LOST:
                self._lost.discard(robot.robot)
            room = self._destinations.pop(robot.robot, robot.moving_to)
            if room is not None and room != robot.moving_to and view.room(room).state == "unvisited":
                self._failed_moves[robot.robot, room] += 1
                if robot.condition is Condition.LOST:
                    self._lost.add(robot.robot)
            if robot.moving_to is not None:
                self._destinations[robot.robot] = robot.moving_to

    def _count_talks_in_vain(self, view: View) -> None:
        """Count dialogues that ended without an agreement or were refused."""
        is_refused = view.refusal is not None and view.refusal.number > self._refusals
        self._refusals = self._refusals if view.refusal is None else view.refusal.number
        talking = {*view.thinking, *(dialogue.robot for dialogue in view.dialogues)}
        agreed = {consent.robot for consent in view.consents}
        for robot in view.robots:
            if robot.moving_to is not None:
                self._vain.pop(robot.robot, None)
                self._asked.pop(robot.robot, None)
            elif robot.robot not in talking | agreed and (is_refused or robot.robot in self._talking):
                self._note_vain(self._asked.pop(robot.robot, None), robot.robot)
        self._talking = talking

    def _note_vain(self, asked: "_TalkRequest | None", robot: int) -> None:
        match asked:
            case SelectRoom(room=room):
                self._vain.setdefault(robot, []).append(room)
            case OpenDialogue(matter=matter, room=room):
                self._vain_matters[matter, room] += 1
            case RequestSuggestion():
                self._vain.setdefault(robot, []).append(None)
            case None:
                pass

    def _for_robot(self, view: View, robot: RobotView, taken: set[int]) -> Iterator[ParticipantRequest]:
        agreed = [consent for consent in view.consents if consent.robot == robot.robot]
        if robot.blocked or robot.condition is Condition.SILENT:
            return
        if robot.robot in view.thinking or any(dialogue.robot == robot.robot for dialogue in view.dialogues):
            return
        room = next((room for room in view.rooms if _waits_for(robot, room)), None)
        if room is not None:
            matters: set[str] = {consent.matter for consent in agreed if consent.room == room.room}
            asked = self._treasure(view, robot, room, matters)
            if _is_allowed(view, asked):
                yield asked
                return
            if room.found and _is_allowed(view, LeaveTreasure(room.room)):
                self._waited[room.room, len(room.known)] += 1
                if self._waited[room.room, len(room.known)] >= PATIENCE:
                    yield LeaveTreasure(room.room)
                return
        if robot.moving_to is not None or robot.has_other_commander:
            return
        for consent in agreed:
            if consent.matter == "select-room" and not self._is_given_up(robot.robot, consent.room):
                yield SendRobot(robot.robot, consent.room)
                return
        if robot.robot in self._lost:
            return
        rooms = self._affordable(view, robot, taken)
        fresh = [room for room in rooms if not self._failed_moves[robot.robot, room]]
        open_to_it = fresh or [room for room in rooms if not self._is_given_up(robot.robot, room)]
        vain = self._vain.get(robot.robot, [])
        if not open_to_it or len(vain) >= MOST_TALKS:
            return
        # Without this, the robot would repeatedly suggest the room that it did not reach.
        is_advised = self._strategy is BotStrategy.SUGGESTION and fresh == rooms and len(vain) < TALKS_AS_USUAL
        if is_advised or len(vain) >= TALKS_ABOUT_ROOMS:
            yield RequestSuggestion(robot.robot)
        else:
            untold = [room for room in open_to_it if vain.count(room) < TALKS_AS_USUAL]
            yield SelectRoom(robot.robot, self._choice(view, robot, untold or open_to_it))

    def _is_given_up(self, robot: int, room: int) -> bool:
        """Return True for a room that a robot failed to reach too often."""
        return self._failed_moves[robot, room] >= MAX_ATTEMPTS

    def _affordable(self, view: View, robot: RobotView, taken: set[int]) -> list[int]:
        row = view.costs_from(robot)
        rooms = [room.room for room in view.rooms if room.state == "unvisited" and room.room not in taken]
        return [room for room in rooms if (cost := row[room]) is not None and cost <= robot.energy]

    def _choice(self, view: View, robot: RobotView, rooms: Sequence[int]) -> int:
        if self._strategy is BotStrategy.RANDOM:
            # The choice must not change while the robot's state does not change. It must change after each stopped
            # dialogue.
            turn = (len(self._stopped) * len(view.costs) + robot.place) * len(view.robots) + robot.robot
            return rooms[int(noise.uniform(self._choices, turn, 0) * len(rooms))]
        costs = view.costs_from(robot)
        return min(rooms, key=lambda room: (costs[room] or 0.0, room))

    def _answer(self, view: View, dialogue: DialogueView) -> ParticipantRequest:
        doubts = self._strategy is BotStrategy.RANDOM and dialogue.matter == "select-room"
        if doubts and noise.uniform(self._doubts, dialogue.dialogue, 0) < STOP_PROBABILITY:
            self._stopped.add(dialogue.dialogue)
            return AnswerDialogue(dialogue.dialogue, dialogue.turn, len(dialogue.choices) - 1)
        if dialogue.matter == "select-room" and self._is_given_up(dialogue.robot, dialogue.room):
            return AnswerDialogue(dialogue.dialogue, dialogue.turn, len(dialogue.choices) - 1)
        takes_advice = len(self._vain.get(dialogue.robot, ())) >= TALKS_ABOUT_ROOMS
        policy = self._taken_advice if takes_advice else self._replies
        return AnswerDialogue(dialogue.dialogue, dialogue.turn, policy.reply(dialogue, self._opinion(view, dialogue)))

    def _opinion(self, view: View, dialogue: DialogueView) -> Opinion:
        """Return the participant's opinion about the matter of a dialogue. It depends on the costs in the view."""
        if dialogue.matter != "select-room":
            return Opinion(is_own=True)
        robot = view.robots[dialogue.robot]
        matters: Sequence[DialogueView | Consent] = (*view.dialogues, *view.consents)
        others = {item.room for item in matters if item.robot != dialogue.robot}
        costs = view.costs_from(robot)
        cost = costs[dialogue.room]
        cheapest = min((costs[room] or 0.0 for room in self._affordable(view, robot, others)), default=0.0)
        asked = self._asked.get(dialogue.robot)
        return Opinion(
            is_own=asked == SelectRoom(dialogue.robot, dialogue.room),
            is_liked=cost is not None and cost <= cheapest,
            is_dear=cost is None or cost > DEAR * cheapest,
        )

    def _treasure(self, view: View, robot: RobotView, room: RoomView, agreed: set[str]) -> ParticipantRequest:
        if not room.found:
            return SenseTreasure(room.room)
        name = self._name(room)
        if room.picture is not None and name is not None and (entered := self._entered(view, room, name)) is not None:
            return entered
        if name is not None and robot.energy >= view.identify_cost:
            return (
                IdentifyTreasure(room.room, name)
                if "take-treasure" in agreed
                else self._talk(robot, "take-treasure", room, None if view.has_last_word is None else name)
            )
        beside = robot.place == room.room and robot.moving_to is None
        can_look = beside and room.picture is None and robot.energy >= view.picture_cost + view.identify_cost
        if name is None and beside and (asked := self._measured(view, robot, room)) is not None:
            return asked
        if name is None and can_look:
            return TakePicture(room.room) if "take-picture" in agreed else self._talk(robot, "take-picture", room)
        return LeaveTreasure(room.room)

    def _talk(
        self,
        robot: RobotView,
        matter: Literal["take-picture", "take-treasure"],
        room: RoomView,
        name: str | None = None,
    ) -> ParticipantRequest:
        if self._vain_matters[matter, room.room] >= MAX_ATTEMPTS:
            return LeaveTreasure(room.room)
        return OpenDialogue(robot.robot, matter, room.room, name)

    def _name(self, room: RoomView) -> str | None:
        """Return the name of the treasure in a room, or None if several names are possible."""
        if room.picture is not None:
            return self._knowledge.shown_by.get(room.picture)
        fitting = {kind.name for kind in self._fitting(room)}
        return fitting.pop() if len(fitting) == 1 else None

    def _fitting(self, room: RoomView) -> list[TreasureKind]:
        """Return the kinds of treasures with all known properties of the treasure in a room."""
        known = room.known.items()
        return [
            kind for kind in self._knowledge.kinds if all(kind.properties.get(name) == value for name, value in known)
        ]

    def _measured(self, view: View, robot: RobotView, room: RoomView) -> MeasureProperty | None:
        """Return the request for a property that distinguishes the possible treasures and costs less than a picture."""
        fitting = self._fitting(room)
        telling = [
            each
            for each in view.properties
            if each.is_measured
            and each.name not in room.known
            and each.cost < view.picture_cost
            and each.cost + view.identify_cost <= robot.energy
            and len({kind.properties[each.name] for kind in fitting}) > 1
        ]
        return MeasureProperty(room.room, min(telling, key=lambda each: each.cost).name) if telling else None

    def _entered(self, view: View, room: RoomView, name: str) -> TellProperty | None:
        """Return the request for the next property that a person recognizes on the picture of a treasure, or None."""
        shown = next((kind for kind in self._knowledge.kinds if kind.name == name), None)
        untold = (each for each in view.properties if each.told_by is Teller.PERSON and each.name not in room.told)
        each = next(untold, None)
        return (
            None if each is None or shown is None else TellProperty(room.room, each.name, shown.properties[each.name])
        )


_TalkRequest: TypeAlias = SelectRoom | RequestSuggestion | OpenDialogue
"""Request that opens a dialogue."""


def _is_allowed(view: View, request: ParticipantRequest) -> bool:
    """Return True if the bot's seat may send a request."""
    if view.team is None:
        return True
    return why_not_allowed(revealed(view).state, view.team.own, request) is None


def _waits_for(robot: RobotView, room: RoomView) -> bool:
    """Return True if this robot must sense the treasure in a room, or must name the treasure that it found there."""
    beside = robot.place == room.room and robot.moving_to is None
    return room.undecided and room.robot == robot.robot and (room.found or beside)
