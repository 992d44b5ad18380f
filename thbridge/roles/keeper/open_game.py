"""The book of the game under way: its state, what was decided in this step, the talks, the last refusal."""

from collections.abc import Callable, Iterable, Sequence
from enum import StrEnum

from thbridge.dialogue.engine import Engine
from thbridge.hunt import game, rules
from thbridge.hunt.events import Arrived, AskedBack, Commanded, Departed, Event, Failed, Started
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.failure_reasons import CALLED_BACK
from thbridge.roles.keeper.dialogues import GameDialogues
from thbridge.roles.keeper.handback_requests import HandbackRequests
from thbridge.roles.notices import MoveOrder
from thbridge.roles.view import RefusalView


class KeeperReason(StrEnum):
    """Why the keeper refuses what the rules would allow."""

    NO_CONSENSUS = "no-consensus"
    NOT_READY = "not-ready"
    UNDER_DISCUSSION = "under-discussion"
    NO_PATH = "no-path"
    NOT_AGREED = "not-agreed"
    STOPPED = "stopped"


class OpenGame:
    """Everything the keeper knows of the game; all changes are events and go through here.

    Args:
        engine: how robots and the participant talk, given the game's number.
        last_game: the number of the last game there ever was.
    """

    def __init__(self, engine: Callable[[int], Engine], last_game: int) -> None:
        self._engine = engine
        self.last_game = last_game
        self.state: GameState | None = None
        self.dialogues = GameDialogues(engine(last_game))
        self.handback_requests = HandbackRequests()
        self.refusal: RefusalView | None = None
        self._refusals = 0
        # The number of each robot's latest move in this game, and how many moves there were.
        self._moves: list[int] = []
        # Likewise, those that the robots were told of.
        self._ordered: list[int] = []
        self._departures = 0
        self._recalled: set[int] = set()
        self._events: list[Event] = []

    def restore(self, history: Iterable[Event]) -> None:
        """Take in the events of a game that was cut off; they are not decided anew."""
        for event in history:
            self._apply(event)

    def record(self, events: Sequence[Event]) -> None:
        """These events are decided."""
        for event in events:
            self._apply(event)
            self._events.append(event)
        if events and self.state is not None:
            self.dialogues.drop_stale(self.state)

    def apply_ruling(self, request: str, ruling: rules.Ruling) -> bool:
        """Let happen what the rules allow; remember what they refuse. Whether it was allowed."""
        if isinstance(ruling, RequestRefused):
            self.refuse(request, ruling)
            return False
        self.record(ruling)
        return True

    def refuse(self, request: str, refused: RequestRefused) -> None:
        """Remember that a wish was not granted, and why."""
        self._refusals += 1
        self.refusal = RefusalView(self._refusals, request, refused.reason, refused.sentence)

    def recall(self, robot: int) -> None:
        """A robot under way shall stop; its move ends when SimR reports how far it came, or now if it never set out."""
        if self.state is not None and self._ordered[robot] != self._moves[robot]:
            self.apply_ruling("Failed", rules.fail(self.state, robot, CALLED_BACK, 0.0))
        else:
            self._recalled.add(robot)

    def is_recalled(self, robot: int) -> bool:
        """Whether a robot under way was told to stop."""
        return robot in self._recalled

    def is_executing(self, robot: int, move: int) -> bool:
        """Whether a robot is under way by the move of this number."""
        return (
            self.state is not None
            and self.state.has_robot(robot)
            and self.state.robots[robot].bound_for is not None
            and self._moves[robot] == move
        )

    def orders(self, state: GameState) -> tuple[MoveOrder | None, ...]:
        """What each robot shall do; they are told of it now."""
        self._ordered = list(self._moves)
        return tuple(
            None
            if robot.bound_for is None or number in self._recalled
            else MoveOrder(self._moves[number], robot.bound_for.people)
            for number, robot in enumerate(state.robots)
        )

    def take_events(self) -> tuple[Event, ...]:
        """What was decided since the last call, in order."""
        events = tuple(self._events)
        self._events.clear()
        return events

    def _apply(self, event: Event) -> None:
        if isinstance(event, Started):
            self.state = game.begin(event)
            self.last_game = event.game
            self.dialogues = GameDialogues(self._engine(event.game), self.dialogues.puppets)
            self.handback_requests.clear()
            self.refusal = None
            self._moves, self._ordered = [0] * event.robots, [0] * event.robots
            self._departures = 0
            self._recalled.clear()
        elif self.state is not None:
            self.state = game.apply(self.state, event)
        if isinstance(event, Departed):
            self._departures += 1
            self._moves[event.robot] = self._departures
        if isinstance(event, AskedBack):
            self.handback_requests.add(event.robot)
        if isinstance(event, Commanded):
            self.handback_requests.forget(event.robot)
        if isinstance(event, Arrived | Failed):
            self._recalled.discard(event.robot)
