"""Trial of a program that chooses robots' moves: it plays conversations of all kinds, and its faults are collected."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Self, TypeVar

from sim.numerics import noise
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.examples import Exchange, jhri2015
from thbridge.dialogue.exchange_play import acts, turn_in
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.strategies import Attitude, GameStrategy
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.moves import Dialogue, DialogueTopic, Move, Scenario, Speaker
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.dialogue.robot_strategies import StrategyFactory, choose_by, own_strategy
from thbridge.dialogue.trials.faults import TrialFault
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue

MOST_ACTS = 60
"""A conversation is stopped after this number of moves and openings."""
_ROOMS = tuple(map(Room, range(1, 9)))
_NAMES = ("cup", "hat", "key", "vase")
T = TypeVar("T")


class StrategyOpponent(StrEnum):
    """Opponent of a strategy on trial."""

    ITSELF = "itself"
    RANDOM = "random"
    OWN = "own"
    """The built-in strategy of robots."""


@dataclass(slots=True)
class StrategyTrial:
    """Trial of a strategy.

    Attributes:
        factory: makes the strategy.
        conversations: number of conversations played.
        moves: number of moves that the strategy had to choose.
        faults: faults by their problems.
    """

    factory: StrategyFactory
    conversations: int = 0
    moves: int = 0
    faults: dict[str, TrialFault] = field(default_factory=dict)

    def on_trial(self, manner: Manner, seed: int, /) -> GameStrategy:
        """Return the strategy, wrapped so that its faults are collected; see `StrategyFactory`."""
        return _OnTrial(self, manner, seed)

    def choose(self, manner: Manner, seed: int, conversation: Conversation, number: int) -> DialogueMove:
        """Return the strategy's move, or the built-in strategy's move if the strategy fails."""
        self.moves += 1
        first, again = (choose_by(self.factory, manner, seed, conversation, number) for _ in range(2))
        if fault := first.fault or again.fault:
            remedy = "Correct the strategy for the position below: it must return one of conversation.legal(number)"
            self._note(fault, remedy, _position(conversation, number))
        elif first != again:
            remedy = (
                "Keep no state between calls, draw random numbers only from the seed, and sort sets before you go "
                "through them: only manner, seed and conversation may decide"
            )
            chose = f"It chose {first.move}, then {again.move}"
            position = (*_position(conversation, number), chose)
            self._note("two requests for the same position gave different moves", remedy, position)
        return first.move

    def _note(self, problem: str, remedy: str, position: Iterable[str]) -> None:
        fault = self.faults.get(problem) or TrialFault(problem, remedy, tuple(position), 0)
        self.faults[problem] = replace(fault, times=fault.times + 1)


@dataclass(frozen=True, slots=True)
class _OnTrial:
    trial: StrategyTrial
    manner: Manner
    seed: int

    def choose(self, conversation: Conversation, number: int) -> DialogueMove:
        return self.trial.choose(self.manner, self.seed, conversation, number)


def try_strategy(factory: StrategyFactory, rulebook: Rulebook, conversations: int, seed: int) -> StrategyTrial:
    """Return the trial of a strategy in the worked example, in all games about its topics, and in situations of hunts.

    Args:
        factory: makes the strategy.
        rulebook: locutions and games.
        conversations: number of conversations of each kind.
        seed: random seed.
    """
    trial = StrategyTrial(factory)
    kinds = [
        (exchange, game, opponent)
        for exchange in jhri2015(rulebook)
        for game in (None, *rulebook.games)
        for opponent in StrategyOpponent
    ]
    for at in range(conversations):
        for number, (exchange, game, opponent) in enumerate(kinds):
            _play_exchange(trial, exchange, game, opponent, _Draws(seed, "exchange", str(number), str(at)))
        for number in range(len(kinds)):
            _play_hunt(trial, rulebook, _Draws(seed, "hunt", str(number), str(at)))
        trial.conversations += 2 * len(kinds)
    return trial


def moves_of_robots(rulebook: Rulebook, conversations: int, seed: int) -> tuple[DialogueMove, ...]:
    """Return the moves of robots with the built-in strategy in a trial's conversations.

    Each move is returned once, in the order in which robots first make the moves.
    """
    said: dict[DialogueMove, None] = {}

    @dataclass(frozen=True, slots=True)
    class Heard:
        strategy: GameStrategy

        def choose(self, conversation: Conversation, number: int) -> DialogueMove:
            move = self.strategy.choose(conversation, number)
            said[move] = None
            return move

    try_strategy(lambda manner, chance: Heard(own_strategy(manner, chance)), rulebook, conversations, seed)
    return tuple(said)


class _Draws:
    """Random draws of one conversation."""

    def __init__(self, seed: int, *names: str) -> None:
        self._key, self._drawn = noise.key(seed, "strategy-check", *names), 0

    def below(self, limit: int) -> int:
        self._drawn += 1
        return int(noise.uniform(self._key, self._drawn, 0) * limit)

    def one_of(self, things: Sequence[T]) -> T:
        return things[self.below(len(things))]

    def some_of(self, things: Sequence[T]) -> list[T]:
        return [thing for thing in things if self.below(2)]

    def manner(self) -> Manner:
        conditions = [condition for condition in DialogueCondition if condition.argues]
        return Manner(
            self.one_of(conditions), self.one_of(list(Attitude)), persistence=self.below(4), talkative=self.below(2) > 0
        )


def _play_exchange(
    trial: StrategyTrial, exchange: Exchange, game: str | None, opponent: StrategyOpponent, draws: _Draws
) -> None:
    """Play the robot's side of an exchange with the strategy on trial; dialogues are opened at random."""
    now, strategy = exchange.start, trial.on_trial(draws.manner(), draws.below(2**31))
    by_itself = {StrategyOpponent.ITSELF: strategy, StrategyOpponent.OWN: own_strategy(draws.manner())}
    programs = {Side.ROBOT: strategy, Side.HUMAN: by_itself.get(opponent)}
    for _ in range(MOST_ACTS):
        turn = turn_in(now)
        if turn is not None and (program := programs[turn[1]]) is not None:
            now = now.say(turn[0], program.choose(now, turn[0]))
            continue
        sides = list(Side) if turn is None else [turn[1]]
        possible = [(side, act) for side in sides for act in acts(exchange, now, side, game)]
        if not possible:
            return
        side, act = draws.one_of(possible)
        now = act.done(now, side)


def _play_hunt(trial: StrategyTrial, rulebook: Rulebook, draws: _Draws) -> None:
    """Play a dialogue of a hunt, in a random situation, with a person who chooses at random."""
    engine = ArguingEngine(rulebook, {None: draws.manner()}, _FormalPhrasing(), draws.below(2**31))
    engine = replace(engine, strategies={None: trial.on_trial})
    step = engine.open(1, _topic(draws))
    for _ in range(MOST_ACTS):
        if step.outcome is not None:
            return
        step = engine.move(step.dialogue, draws.one_of(engine.choices(step.dialogue)).move)


@dataclass(frozen=True, slots=True)
class _FormalPhrasing:
    names_energy: bool = True

    def without_energy(self) -> Self:
        return self

    def say(self, _dialogue: Dialogue, move: Move, _speaker: Speaker) -> str:
        return str(move)

    def authored(self, _dialogue: Dialogue, _move: Move) -> None:
        return None


def _topic(draws: _Draws) -> DialogueTopic:
    energy = float(50 + draws.below(400))
    if draws.below(3) == 0:
        treasure = WhatFacts(draws.one_of(_ROOMS), energy, 5.0, 1.0, tuple(draws.some_of(_NAMES)) or _NAMES, True)
        scenario = draws.one_of([Scenario.TAKE_PICTURE, Scenario.TAKE_TREASURE])
        return DialogueTopic(scenario, 0, treasure.room, treasure.picture_cost, energy, facts=treasure)
    left = tuple(draws.some_of(_ROOMS)) or _ROOMS
    costs = {room: float(1 + draws.below(300)) for room in left}
    facts = WhereFacts(
        robot=0,
        here=Room(0),
        energy=energy,
        costs=costs,
        left=left,
        under_way=dict.fromkeys(draws.some_of(left[2:]), 1),
        values={room: PlanValue(1 + draws.below(5), costs[room]) for room in left if costs[room] <= energy},
        others={room: (1, float(1 + draws.below(300))) for room in draws.some_of(left)},
        failed=frozenset(draws.some_of(left[3:])),
    )
    scenario, room = draws.one_of([Scenario.SPECIFIC_ROOM, Scenario.DONT_KNOW]), draws.one_of(left)
    return DialogueTopic(scenario, 0, room, costs[room], energy, facts=facts)


def _position(conversation: Conversation, number: int) -> Iterator[str]:
    play = conversation.play(number)
    yield f"{play.game.name} about {play.topic}, in the state {play.stage or play.game.opening}"
    yield from (f"{side}: {move}" for side, move in play.moves)
    yield f"The {play.speaker} may say: {'; '.join(map(str, conversation.legal(number)))}"
