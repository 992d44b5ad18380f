"""Simulated participants. Like a person in front of the window, they know only the view."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from sim.numerics import noise
from thbridge.dialogue.games.strategies import Attitude
from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.properties import Teller
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.reply_policy import Opinion, ReplyPolicy
from thbridge.roles.shared.participant_rules import revealed
from thbridge.roles.shared.seat_rights import may_discuss, why_not_allowed
from thbridge.roles.shared.team_notices import DecisionView, RaiseObjection, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    Consent,
    DialogueView,
    EndGame,
    GiveConsent,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    RequestHandback,
    RequestSuggestion,
    RobotView,
    RoomView,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    TakePicture,
    TeamView,
    TellProperty,
    View,
    objections_of,
)
from thbridge.text_protocol.wire.notice_format import kind_of

STOP_PROBABILITY = 0.1
"""Probability that the `random` participant answers Stop."""
MAX_ATTEMPTS = 3
"""The bot gives up after this number of failed moves of a robot to a room, or failed dialogues or votes about a
treasure."""
TALKS_AS_USUAL, TALKS_ABOUT_ROOMS, MOST_TALKS = 2, 4, 6
"""Numbers of failed dialogues with a robot. After the first number, the bot no longer asks for advice. After the second
number, it no longer chooses rooms itself, but asks for advice again and accepts all advice. After the third number, it
no longer talks with the robot."""
MOST_THOUGHTS = 4
"""The bot looks at an open vote 1 to this number of times before it votes."""
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
    seats have found, and leaves a treasure if no other participant finds out more about it for a time. It votes for
    possible names, and for moves according to its attitude; it votes for the end of the game if it waits itself. A bot
    without robots asks for a robot of a participant who has several; a bot with several robots hands one over if asked.
    A sceptical bot sometimes objects in a dialogue of another seat, if its seat may.

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
        # Numbers of looks at open votes, the bot's own open proposals, and numbers of rejected names by room.
        self._considered: Counter[int] = Counter()
        self._proposals: dict[int, DecisionView] = {}
        self._rejected_names: Counter[int] = Counter()
        self._thoughts = noise.key(seed, "participant", "thoughts")

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the next requests; see `Player`."""
        if view.over is not None:
            return ()
        if view.consent is not None:
            return (GiveConsent(),)
        self._count_failures(view)
        self._count_talks_in_vain(view)
        self._count_votes_in_vain(view)
        requests: list[ParticipantRequest] = [
            self._answer(view, dialogue) for dialogue in view.dialogues if dialogue.choices
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
        is_busy = bool(requests) or moves
        for_teammates = [] if view.team is None else self._for_teammates(view, view.team, is_busy=is_busy)
        if is_busy or not view.robots or view.dialogues or view.thinking:
            self._idle = 0
            return [*for_teammates, *requests]
        self._idle += 1
        if any(robot.has_other_commander for robot in view.robots) and (view.team is None or self._idle < PATIENCE):
            return for_teammates
        end = EndGame(view.game)
        return [*for_teammates, end] if _is_allowed(view, end) else for_teammates

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
        # A refused objection is about a dialogue of another seat.
        refusal = None if view.refusal is None or view.refusal.wish == kind_of(RaiseObjection) else view.refusal
        is_refused = refusal is not None and refusal.number > self._refusals
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

    def _count_votes_in_vain(self, view: View) -> None:
        """Count the bot's proposals for which the others did not vote, like failed moves and failed dialogues."""
        team = view.team
        if team is None:
            return
        before, self._proposals = (
            self._proposals,
            {each.decision: each for each in team.decisions if each.seat == team.own.name},
        )
        for each in (each for number, each in before.items() if number not in self._proposals):
            match each:
                case DecisionView(kind="send", robot=int(robot), room=int(room)):
                    if view.robots[robot].moving_to != room and view.room(room).state == "unvisited":
                        self._failed_moves[robot, room] += 1
                case DecisionView(kind="name", room=int(room)):
                    self._rejected_names[room] += view.room(room).undecided
                case _:
                    self._idle = 0

    def _for_teammates(self, view: View, team: TeamView, *, is_busy: bool) -> list[ParticipantRequest]:
        """Return the requests to the other participants: votes, and robots to hand over or to ask for."""
        requests: list[ParticipantRequest] = []
        for each in team.decisions:
            if team.own.name not in {each.seat, *(vote.seat for vote in each.votes)}:
                self._considered[each.decision] += 1
                if self._considered[each.decision] > MOST_THOUGHTS * noise.uniform(self._thoughts, each.decision, 0):
                    requests.append(Vote(each.decision, agrees=self._agrees(view, each, is_busy=is_busy)))
        requests += self._objections(view, team)
        own = [robot.robot for robot in view.robots if not robot.has_other_commander]
        able = {mate.seat.name for mate in team.teammates if mate.seat.can_take_over}
        for robot, seat in team.asked_for:
            if seat in able and len(own) > 1 and robot in own:
                own.remove(robot)
                requests.append(HandOver(robot, seat))
        if not own and team.own.can_take_over:
            requests += _asked_robot(view, team)
        return requests

    def _objections(self, view: View, team: TeamView) -> Iterator[RaiseObjection]:
        """Yield the bot's objections in dialogues of teammates."""
        raised = {each.dialogue for each in objections_of(view) if each.seat == team.own.name}
        for dialogue in view.dialogues:
            if not team.own.may_object or dialogue.dialogue in raised:
                continue
            moves = dialogue.matter == "select-room"
            is_dear = moves and self._is_dear(view, view.robots[dialogue.robot], dialogue.room)
            reason = self._replies.objection(dialogue, is_dear=is_dear)
            about = (dialogue.robot, dialogue.matter)
            if reason is not None and may_discuss(revealed(view).state, team.own, *about) is not None:
                yield RaiseObjection(dialogue.dialogue, reason)

    def _agrees(self, view: View, decision: DecisionView, *, is_busy: bool) -> bool:
        """Return True if the bot votes for a decision of a teammate."""
        match decision:
            case DecisionView(kind="send", robot=int(robot), room=int(room)):
                return self._replies.agrees(decision.decision, is_dear=self._is_dear(view, view.robots[robot], room))
            case DecisionView(kind="name", room=int(room)):
                return decision.name in self._names(view.room(room))
            case _:
                return not is_busy

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
            if not room.found or _is_awaited(view):
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
        cost, cheapest = view.costs_from(robot)[dialogue.room], self._cheapest(view, robot)
        asked = self._asked.get(dialogue.robot)
        return Opinion(
            is_own=asked == SelectRoom(dialogue.robot, dialogue.room),
            is_liked=cost is not None and cost <= cheapest,
            is_dear=self._is_dear(view, robot, dialogue.room),
        )

    def _cheapest(self, view: View, robot: RobotView) -> float:
        """Return the smallest cost of a move to a room that no other robot discusses."""
        matters: Sequence[DialogueView | Consent] = (*view.dialogues, *view.consents)
        others = {item.room for item in matters if item.robot != robot.robot}
        costs = view.costs_from(robot)
        return min((costs[room] or 0.0 for room in self._affordable(view, robot, others)), default=0.0)

    def _is_dear(self, view: View, robot: RobotView, room: int) -> bool:
        """Return True if a room costs a robot much more than another room."""
        cost = view.costs_from(robot)[room]
        return cost is None or cost > DEAR * self._cheapest(view, robot)

    def _treasure(self, view: View, robot: RobotView, room: RoomView, agreed: set[str]) -> ParticipantRequest:
        if not room.found:
            return SenseTreasure(room.room)
        if self._rejected_names[room.room] >= MAX_ATTEMPTS:
            return LeaveTreasure(room.room)
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
        names = self._names(room)
        return names.pop() if len(names) == 1 else None

    def _names(self, room: RoomView) -> set[str]:
        """Return the possible names of the treasure in a room. If a picture is unknown, there are none."""
        if room.picture is not None:
            shown = self._knowledge.shown_by.get(room.picture)
            return set() if shown is None else {shown}
        return {kind.name for kind in self._fitting(room)}

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


def _is_awaited(view: View) -> bool:
    """Return True if a teammate who is present can decide about treasures."""
    teammates = () if view.team is None else view.team.teammates
    return any(mate.present and mate.seat.names_treasures for mate in teammates)


def _asked_robot(view: View, team: TeamView) -> Iterator[RequestHandback]:
    """Yield the request for a robot of a teammate who is present and commands several robots."""
    present = {mate.seat.label for mate in team.teammates if mate.present}
    robots = [robot for robot in view.robots if robot.commander is Commander.TEAMMATE]
    commanded = Counter(robot.commander_name for robot in robots)
    spare = [robot for robot in robots if robot.commander_name in present and commanded[robot.commander_name] > 1]
    if spare and not spare[-1].asked_back:
        yield RequestHandback(spare[-1].robot)


def _waits_for(robot: RobotView, room: RoomView) -> bool:
    """Return True if this robot must sense the treasure in a room, or must name the treasure that it found there."""
    beside = robot.place == room.room and robot.moving_to is None
    return room.undecided and room.robot == robot.robot and (room.found or beside)
