"""The participant's view: everything that a person may know about a game, and nothing else."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.common.robot_numbers import number_of
from thbridge.api.snapshot import Booleans, Floats, Integers
from thbridge.roles.shared.view import View


@dataclass(frozen=True, slots=True)
class HuntDialogue:
    """A dialogue between a robot and the participant.

    Attributes:
        robot: number of the robot, from 1.
        matter: "select-room", "take-picture" or "take-treasure".
        room: number of the room that it is about.
        said: all sentences so far, oldest first.
        choices: answers that the participant may give; the first agrees most. Empty while it is the robot's turn.
    """

    robot: int
    matter: str
    room: int
    said: tuple[str, ...]
    choices: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class HuntAgreement:
    """An agreement between a robot and the participant that the participant may act on.

    Attributes:
        robot: number of the robot, from 1.
        matter: "select-room", "take-picture" or "take-treasure", as in the dialogue.
        room: number of the room that it is about.
    """

    robot: int
    matter: str
    room: int


@dataclass(frozen=True, eq=False, repr=False)
class HuntView:
    """Part of the game that a person may know, as arrays. Robots have one row each, robot 1 first; so do rooms.

    Attributes:
        ready: True once robots accept requests.
        consent: text that the participant has to agree to first. If None, no consent is needed.
        score: points.
        over: reason of the game's end; None until then.
        names: possible names of treasures; empty until a treasure is found.
        refusal: reason of the last refused request of the participant; None if there was none.
    """

    ready: bool
    consent: str | None
    score: int
    over: str | None
    names: tuple[str, ...]
    refusal: str | None
    _view: View

    @cached_property
    def energy(self) -> Floats:
        """(n,) energy left."""
        return np.array([robot.energy for robot in self._view.robots])

    @cached_property
    def places(self) -> Integers:
        """(n,) number of the room where each robot stands, or from which it departed; 0 is the corridor."""
        return np.array([robot.place for robot in self._view.robots], dtype=np.int64)

    @cached_property
    def bound_for(self) -> Integers:
        """(n,) number of the room to which each robot is driving; 0 if none."""
        return np.array([robot.moving_to or 0 for robot in self._view.robots], dtype=np.int64)

    @property
    def conditions(self) -> tuple[str, ...]:
        """Condition of each robot ("well", "lost", "silent", or "blocked" without energy)."""
        return tuple("blocked" if robot.blocked else robot.condition.value for robot in self._view.robots)

    @cached_property
    def costs(self) -> Floats:
        """(n, rooms) energy of a move of each robot to each room; infinite if no move is possible."""
        rows = [self._view.costs_from(robot)[1:] for robot in self._view.robots]
        return np.array([[np.inf if cost is None else cost for cost in row] for row in rows])

    @cached_property
    def visited(self) -> Booleans:
        """(rooms,) True for each room that a robot has reached."""
        return np.array([room.state == "visited" for room in self._view.rooms], dtype=np.bool_)

    @cached_property
    def undecided(self) -> Booleans:
        """(rooms,) True for each visited room whose treasure is neither named nor left."""
        return np.array([room.undecided for room in self._view.rooms], dtype=np.bool_)

    @property
    def known(self) -> tuple[Mapping[str, str], ...]:
        """Known properties of the treasure of each room; empty if none are known."""
        return tuple(room.known for room in self._view.rooms)

    @property
    def pictures(self) -> tuple[str | None, ...]:
        """File name of the picture taken in each room; None without a picture."""
        return tuple(room.picture for room in self._view.rooms)

    @property
    def named(self) -> tuple[str | None, ...]:
        """Name given to the treasure of each room; None if it has no name yet."""
        return tuple(None if room.verdict is None else room.verdict.name for room in self._view.rooms)

    @property
    def points(self) -> tuple[int | None, ...]:
        """Points won or lost by the name given in each room; None if no name was given."""
        return tuple(None if room.verdict is None else room.verdict.points for room in self._view.rooms)

    @property
    def dialogues(self) -> tuple[HuntDialogue, ...]:
        """Open dialogues."""
        return tuple(
            HuntDialogue(number_of(each.robot), each.matter, each.room, each.said, each.choices)
            for each in self._view.dialogues
        )

    @property
    def agreements(self) -> tuple[HuntAgreement, ...]:
        """Agreements that the participant has not acted on yet."""
        return tuple(HuntAgreement(number_of(each.robot), each.matter, each.room) for each in self._view.consents)

    def __repr__(self) -> str:
        return f"<HuntView score {self.score}, {int(self.visited.sum())} rooms visited, over: {self.over}>"


def view_of(view: View) -> HuntView:
    """Return the public form of a view that was sent to the participant."""
    refusal = None if view.refusal is None else view.refusal.sentence
    return HuntView(view.ready, view.consent, view.score, view.over, view.names, refusal, view)
