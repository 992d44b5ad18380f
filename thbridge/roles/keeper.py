"""The keeper of the game: the one authority for what is hidden, visited, spent and scored.

It lives beside the router, hears every line that is forwarded (a *tap*), and is asked things by notices. What it
decides becomes events; the caller must write them to the journal before it passes on the messages of the same step.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from thbridge.dialogue.engine import Engine
from thbridge.dialogue.moves import Scenario, Utterance
from thbridge.hunt import game, rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Arrived, Departed, Event, Failed, Hidden, Started
from thbridge.hunt.game import GameState
from thbridge.hunt.outcomes import Refused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import suggest
from thbridge.roles.notices import (
    KEEPER,
    HidePlease,
    HiderReady,
    HideTreasures,
    Level,
    Order,
    Orders,
    ParticipantReady,
    Reply,
    RobotsReady,
    Status,
    Unfit,
    heard,
    tell,
)
from thbridge.roles.showing import view_of
from thbridge.roles.talks import MATTERS, Talks
from thbridge.roles.view import (
    Answer,
    CallBack,
    Discuss,
    Identify,
    Leave,
    Matter,
    PlayAgain,
    RefusalView,
    Select,
    SendRobot,
    Sense,
    TakePicture,
    Unsure,
    View,
)
from thbridge.wire import legacy
from thbridge.wire.notice import Notice, is_notice, notice, parse_notice
from thbridge.wire.router import Forwarded
from thbridge.wire.text import Message

MOST_ROBOTS = 250
"""Larger than any team; a number beyond it is a mistake."""


class Reason(StrEnum):
    """Why the keeper refuses what the rules would allow."""

    NO_CONSENSUS = "no-consensus"
    NOT_READY = "not-ready"
    UNDER_DISCUSSION = "under-discussion"
    NO_PATH = "no-path"


@dataclass(frozen=True, slots=True)
class GameRules:
    """What a study decides about the game.

    Attributes:
        seed: what the game's chance is keyed by; recorded.
        energy: of each robot at the start.
        picture_cost: energy of taking a picture.
        identify_cost: energy of naming a treasure.
        wrong_share: share of a treasure's points that a wrong name costs.
    """

    seed: int
    energy: float
    picture_cost: float
    identify_cost: float
    wrong_share: float


@dataclass(frozen=True, slots=True)
class Decided:
    """What one step of the keeper brought about, in order."""

    events: tuple[Event, ...]
    utterances: tuple[Utterance, ...]


class Keeper:
    """The game's authority; see the module's description.

    Args:
        rules: of the game.
        engine: how robots and the participant talk, given the game's number.
        history: the events of the game under way, oldest first, as the journal has them; empty for none.
        last_game: the number of the last game there ever was; the next one gets the number after it.
    """

    name = KEEPER

    def __init__(
        self,
        rules: GameRules,
        engine: Callable[[int], Engine],
        history: Sequence[Event] = (),
        last_game: int = 0,
    ) -> None:
        self._rules = rules
        self._make_engine = engine
        self._last_game = last_game
        self._state: GameState | None = None
        self._talks = Talks(engine(last_game))
        # The number of each robot's latest move in this game, and how many moves there were.
        self._moves: list[int] = []
        self._departures = 0
        self._recalled: set[int] = set()
        # An identification whose verdict another program's Hider has not told yet.
        self._named: tuple[Room, str] | None = None
        self._refusal: RefusalView | None = None
        self._refusals = 0
        # Who is there, and what they were told last.
        self._team: RobotsReady | None = None
        self._hider_ready = False
        self._participants: dict[str, None] = {}
        self._poses: tuple[tuple[float, float, float], ...] | None = None
        self._ordered: Orders | None = None
        self._shown: View | None = None
        # Of the step under way, and of the last one.
        self._heard_anything = False
        self._events: list[Event] = []
        self._decided = Decided((), ())
        self._said: list[Message] = []
        for event in history:
            self._apply(event)

    @property
    def state(self) -> GameState | None:
        """The game under way or just over; None before the first."""
        return self._state

    @property
    def decided(self) -> Decided:
        """Events and utterances of the last step; the events belong in the journal before anything else is done."""
        return self._decided

    def connected(self) -> None:
        """Nobody needs to be told: the others introduce themselves to the keeper."""

    def tap(self, forwarded: Sequence[Forwarded]) -> None:
        """Hear what was forwarded since the last step; call it right before `step`."""
        for item in forwarded:
            if not is_notice(item.message):
                self._heard_anything = True
                self._overhear(item)

    def step(self, tick: int, messages: Sequence[Message]) -> list[Message]:
        """One tick; see `Role`."""
        for message in messages:
            value = parse_notice(message)
            if isinstance(value, Notice):
                self._heard_anything = True
                self._heed(value)
        # Whatever changes does so because of something heard; most ticks are silent.
        if self._heard_anything:
            self._heard_anything = False
            self._see_to_end()
            self._tell_levels()
        self._decided = Decided(tuple(self._events), tuple(self._talks.take_utterances()))
        self._events.clear()
        said, self._said = self._said, []
        return said

    # What the programs of 2016 say

    def _overhear(self, item: Forwarded) -> None:
        state = self._state
        if state is None:
            return
        match legacy.decode(item.message):
            case legacy.Goto(robot, room) if item.message.receiver == legacy.SIMR:
                self._send(state, robot, Room.of_wire(room), item)
            case legacy.Arrived(robot, room) if item.message.sender == legacy.SIMR:
                self._arrived(state, robot, Room.of_wire(room))
            case legacy.AskTreasure(room) if item.message.receiver == legacy.HIDER:
                self._sense(state, Room.of_wire(room))
            case legacy.Snap(room) if item.message.receiver == legacy.HIDER:
                self._picture(state, Room.of_wire(room), item)
            case legacy.Identify(room, name) if item.message.receiver == legacy.HIDER:
                self._identify(state, Room.of_wire(room), name, item)
            case legacy.FoundTreasure(room, colour, footprint) if item.message.sender == legacy.HIDER:
                self._if_told(state, lambda: rules.sense(state, Room.of_wire(room), (colour, footprint)))
            case legacy.Image(room, filename) if item.message.sender == legacy.HIDER:
                self._if_told(state, lambda: rules.picture(state, Room.of_wire(room), filename))
            case legacy.Score(points) if item.message.sender == legacy.HIDER and self._named is not None:
                place, name = self._named
                self._named = None
                self._if_told(state, lambda: rules.identify(state, place, name, points))

    def _send(self, state: GameState, robot: int, room: Room, item: Forwarded) -> None:
        """A robot is sent to a room: the rules judge, and our own participant must have agreed with it first."""
        ruling = rules.move(state, robot, room)
        agreed = self._talks.agreed(robot, "select-room", room) or not self._needs_consent(item)
        if isinstance(ruling, tuple) and not agreed:
            name = rules.robot_name(robot)
            ruling = Refused(Reason.NO_CONSENSUS, f"You have not agreed with {name} that it goes to {room}.")
        if self._take(SendRobot.__name__, ruling):
            self._talks.use(robot, "select-room")

    def _arrived(self, state: GameState, robot: int, room: Room) -> None:
        # SimR says it again when it cannot know whether it was heard.
        here = state.robots[robot] if state.has_robot(robot) else None
        if here is None or (here.bound_for is None and here.at == room):
            return
        self._take("Arrived", rules.arrive(state, robot, room))

    def _sense(self, state: GameState, room: Room) -> None:
        if state.treasures is None:
            return
        if self._take(Sense.__name__, rules.sense(state, room)):
            treasure = state.treasure(room)
            if treasure is not None:
                self._reply(legacy.FoundTreasure(room.wire, treasure.colour, treasure.footprint).message())

    def _picture(self, state: GameState, room: Room, item: Forwarded) -> None:
        if state.treasures is None:
            return
        ruling = self._with_consent(rules.picture(state, room), state, room, "take-picture", item)
        if self._take(TakePicture.__name__, ruling):
            treasure = state.treasure(room)
            if treasure is not None and treasure.image is not None:
                self._reply(legacy.Image(room.wire, treasure.image).message())

    def _identify(self, state: GameState, room: Room, name: str, item: Forwarded) -> None:
        self._named = (room, name)
        if state.treasures is None:
            return
        self._named = None
        decided = state.room(room).points if state.has_room(room) else None
        if decided is not None:
            # The answer got lost: the verdict stands, and is said again.
            self._reply(legacy.Score(decided).message())
            return
        ruling = self._with_consent(rules.identify(state, room, name), state, room, "take-treasure", item)
        if self._take(Identify.__name__, ruling) and self._state is not None:
            self._reply(legacy.Score(self._state.room(room).points or 0).message())

    def _if_told(self, state: GameState, rule: Callable[[], rules.Ruling]) -> None:
        """Another program's Hider gave an answer; ours only repeats what the keeper decided."""
        if state.treasures is None:
            ruling = rule()
            if isinstance(ruling, tuple):
                self._happen(ruling)

    def _with_consent(
        self, ruling: rules.Ruling, state: GameState, room: Room, matter: Matter, item: Forwarded
    ) -> rules.Ruling:
        robot = state.standing_in(room)
        if isinstance(ruling, Refused) or robot is None or not self._needs_consent(item):
            return ruling
        repeated = matter == "take-picture" and state.room(room).image is not None
        if repeated or self._talks.agreed(robot, matter, room):
            self._talks.use(robot, matter)
            return ruling
        return Refused(Reason.NO_CONSENSUS, f"You have not agreed on that with {rules.robot_name(robot)}.")

    def _needs_consent(self, item: Forwarded) -> bool:
        """The programs of 2016 hold their dialogues themselves, where nobody can hear them."""
        return item.sender_extended and item.message.sender in self._participants

    def _reply(self, message: Message) -> None:
        self._tell(legacy.HIDER, Reply(message.command, message.text))

    # What our own programs say

    def _heed(self, notice: Notice) -> None:
        if (robots := heard(notice, RobotsReady)) is not None:
            self._robots(notice.sender, robots)
        elif (status := heard(notice, Status)) is not None:
            self._status(status)
        elif heard(notice, HiderReady) is not None:
            self._hider_ready = True
            self._ask_to_hide()
        elif (hidden := heard(notice, HideTreasures)) is not None:
            self._hide(hidden)
        elif heard(notice, ParticipantReady) is not None:
            self._participants[notice.sender] = None
            self._shown = None
        elif self._state is not None:
            self._wish(self._state, notice)

    def _robots(self, sender: str, robots: RobotsReady) -> None:
        state = self._state
        costs = costs_of(robots.costs)
        if isinstance(costs, Refused):
            self._tell(sender, Unfit(costs.sentence))
        elif not 0 < robots.robots <= MOST_ROBOTS:
            self._tell(sender, Unfit(f"A team has 1 to {MOST_ROBOTS} robots, not {robots.robots}."))
        elif state is None:
            self._team = robots
            self._start(robots.robots, costs)
        elif state.ended is not None:
            self._team = robots
        elif len(state.robots) != robots.robots or state.started.costs != costs:
            self._tell(sender, Unfit(_unfit(state, robots)))
        else:
            self._team = robots
            self._give_orders(with_poses=True)

    def _start(self, robots: int, costs: CostMatrix) -> None:
        chosen = self._rules
        started = Started(
            seed=chosen.seed,
            game=self._last_game + 1,
            robots=robots,
            energy=chosen.energy,
            picture_cost=chosen.picture_cost,
            identify_cost=chosen.identify_cost,
            wrong_share=chosen.wrong_share,
            costs=costs,
        )
        self._happen((started,))
        self._ask_to_hide()

    def _ask_to_hide(self) -> None:
        state = self._state
        if self._hider_ready and state is not None and state.treasures is None and state.ended is None:
            self._tell(legacy.HIDER, HidePlease(state.started.game, len(state.rooms)))

    def _hide(self, hidden: HideTreasures) -> None:
        state = self._state
        fresh = state is not None and state.treasures is None and state.started.game == hidden.game
        if state is not None and fresh and len(hidden.treasures) == len(state.rooms):
            self._happen((Hidden(hidden.treasures),))

    def _status(self, status: Status) -> None:
        state = self._state
        if state is None or status.game != state.started.game or len(status.poses) != len(state.robots):
            return
        self._poses = status.poses
        for robot, result in enumerate(status.results[: len(state.robots)]):
            bound_for = self._state.robots[robot].bound_for if self._state is not None else None
            if result is None or bound_for is None or result.move != self._moves[robot] or self._state is None:
                continue
            if result.arrived:
                self._take("Arrived", rules.arrive(self._state, robot, bound_for))
            else:
                self._take("Failed", rules.fail(self._state, robot, result.sentence, result.share))
                self._refuse(SendRobot.__name__, Refused(Reason.NO_PATH, result.sentence))

    def _wish(self, state: GameState, notice: Notice) -> None:
        if (asked := heard(notice, Select)) is not None:
            self._select(state, asked)
        elif (unsure := heard(notice, Unsure)) is not None:
            self._suggest(state, unsure)
        elif (discuss := heard(notice, Discuss)) is not None:
            self._discuss(state, discuss)
        elif (answer := heard(notice, Answer)) is not None:
            self._answer(answer)
        elif (leave := heard(notice, Leave)) is not None:
            self._take("Leave", rules.leave(state, Room(max(leave.room, 0))))
        elif (back := heard(notice, CallBack)) is not None:
            self._call_back(state, back.robot)
        elif (again := heard(notice, PlayAgain)) is not None:
            self._play_again(state, again.game)

    def _select(self, state: GameState, asked: Select) -> None:
        room = Room(max(asked.room, 0))
        ruling = self._movable(state, asked.robot) or rules.move(state, asked.robot, room)
        other = self._talks.spoken_for(room, asked.robot)
        if isinstance(ruling, tuple) and other is not None:
            name = rules.robot_name(other)
            ruling = Refused(Reason.UNDER_DISCUSSION, f"You are talking with {name} about {room}.")
        self._open_if(state, ruling, Scenario.SPECIFIC_ROOM, asked.robot, room)

    def _suggest(self, state: GameState, unsure: Unsure) -> None:
        refused = self._movable(state, unsure.robot)
        if refused is not None:
            self._refuse(Unsure.__name__, refused)
            return
        robot = state.robots[unsure.robot]
        free = [room for room in state.free_rooms if self._talks.spoken_for(room, unsure.robot) is None]
        room = suggest(state.started.costs, robot.at, free, robot.energy, state.started.identify_cost)
        if isinstance(room, Refused):
            self._refuse(Unsure.__name__, room)
        else:
            self._open_if(state, (), Scenario.DONT_KNOW, unsure.robot, room)

    def _discuss(self, state: GameState, discuss: Discuss) -> None:
        room = Room(max(discuss.room, 0))
        scenario = Scenario.TAKE_PICTURE if discuss.matter == "take-picture" else Scenario.TAKE_TREASURE
        ruling: rules.Ruling
        if not state.has_room(room) or state.standing_in(room) != discuss.robot:
            ruling = Refused(rules.Reason.NOBODY_THERE, f"This robot does not stand in {room}.")
        elif scenario is Scenario.TAKE_PICTURE:
            ruling = rules.picture(state, room)
        else:
            # The name is still open; whether naming is allowed and can be paid is not.
            ruling = rules.identify(state, room, "", 0)
        self._open_if(state, ruling, scenario, discuss.robot, room)

    def _answer(self, answer: Answer) -> None:
        refused = self._talks.answer(answer.dialogue, answer.turn, answer.choice)
        if refused is not None:
            self._refuse(Answer.__name__, refused)

    def _call_back(self, state: GameState, robot: int) -> None:
        if state.has_robot(robot) and state.robots[robot].bound_for is not None:
            # SimR stops the robot and reports how far it came; that report ends the move.
            self._recalled.add(robot)
        else:
            self._take(CallBack.__name__, rules.fail(state, robot, "", 0.0))

    def _play_again(self, state: GameState, finished: int) -> None:
        if state.ended is None or state.started.game != finished or self._team is None:
            return
        costs = costs_of(self._team.costs)
        if isinstance(costs, CostMatrix):
            self._start(self._team.robots, costs)

    def _movable(self, state: GameState, robot: int) -> Refused | None:
        """Why this robot cannot be talked into any move, or None."""
        if state.treasures is None and self._hider_ready:
            return Refused(Reason.NOT_READY, "The treasures are not hidden yet.")
        ruling = rules.move(state, robot, next(iter(state.free_rooms), Room(1)))
        about_the_room = {rules.Reason.NOT_ENOUGH_ENERGY, rules.Reason.ALREADY_VISITED, rules.Reason.NOT_A_MOVE}
        return ruling if isinstance(ruling, Refused) and ruling.reason not in about_the_room else None

    def _open_if(self, state: GameState, ruling: rules.Ruling, scenario: Scenario, robot: int, room: Room) -> None:
        refused = ruling if isinstance(ruling, Refused) else self._talks.open(state, scenario, robot, room)
        if refused is not None:
            self._refuse(MATTERS[scenario], refused)

    # Events

    def _take(self, request: str, ruling: rules.Ruling) -> bool:
        """Let happen what the rules allow; tell of what they refuse. Whether it was allowed."""
        if isinstance(ruling, Refused):
            self._refuse(request, ruling)
            return False
        self._happen(ruling)
        return True

    def _happen(self, events: Sequence[Event]) -> None:
        for event in events:
            self._apply(event)
            self._events.append(event)
        if events and self._state is not None:
            self._talks.drop_stale(self._state)

    def _apply(self, event: Event) -> None:
        if isinstance(event, Started):
            self._state = game.begin(event)
            self._last_game = event.game
            self._talks = Talks(self._make_engine(event.game))
            self._moves = [0] * event.robots
            self._departures = 0
            self._recalled.clear()
            self._named = None
            self._refusal = None
            self._poses = None
        elif self._state is not None:
            self._state = game.apply(self._state, event)
        if isinstance(event, Departed):
            self._departures += 1
            self._moves[event.robot] = self._departures
        if isinstance(event, Arrived | Failed):
            self._recalled.discard(event.robot)

    def _refuse(self, request: str, refused: Refused) -> None:
        self._refusals += 1
        self._refusal = RefusalView(self._refusals, request, refused.reason, refused.sentence)

    def _see_to_end(self) -> None:
        """Programs of 2016 never say that they give a treasure up, so nobody waits for them to."""
        state = self._state
        if state is not None:
            self._happen(rules.ending(state, wait_for_decisions=bool(self._participants)))

    # What the keeper says

    def _tell(self, receiver: str, value: Level) -> None:
        self._said.append(tell(self.name, receiver, value))

    def _tell_levels(self) -> None:
        if self._state is None:
            return
        if self._team is not None:
            self._give_orders(with_poses=False)
        view = view_of(self._state, self._talks, self._refusal, robots_ready=self._team is not None)
        if view != self._shown:
            self._shown = view
            for participant in self._participants:
                self._said.append(notice(self.name, participant, View.__name__, **view.to_json()))

    def _give_orders(self, *, with_poses: bool) -> None:
        state = self._state
        if state is None:
            return
        moves = tuple(
            None
            if robot.bound_for is None or number in self._recalled
            else Order(self._moves[number], robot.bound_for.people)
            for number, robot in enumerate(state.robots)
        )
        energy = tuple(robot.energy for robot in state.robots)
        at = tuple(robot.at.people for robot in state.robots)
        orders = Orders(state.started.game, moves, energy, at, self._poses if with_poses else None)
        if with_poses or self._ordered is None or replace(self._ordered, poses=None) != orders:
            self._ordered = orders
            self._tell(legacy.SIMR, orders)


def costs_of(rows: Sequence[Sequence[float | None]]) -> CostMatrix | Refused:
    """The cost matrix that `plain_costs` wrote."""
    try:
        return CostMatrix(tuple(tuple(math.inf if cost is None else cost for cost in row) for row in rows))
    except ValueError as error:
        return Refused("bad-costs", str(error))


def _unfit(state: GameState, robots: RobotsReady) -> str:
    return (
        f"A game with {len(state.robots)} robots and {len(state.rooms)} rooms is under way; these are {robots.robots} "
        f"robots on the map {robots.map} with {len(robots.costs) - 1} rooms. Start SimR as before, or end that game "
        "by starting the server with --new-game."
    )
