"""View of the participant: the part of a game that a person may know."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.common.robot_numbers import number_of
from thbridge.api.snapshot import Booleans, Floats, Integers
from thbridge.roles.shared.team_notices import DecisionView
from thbridge.roles.shared.view import View, objections_of


@dataclass(frozen=True, slots=True)
class HuntObjection:
    """Objection of the participant of another seat in a dialogue.

    Attributes:
        seat: seat of that participant.
        reason: reason, such as "too-far"; see `HuntParticipant.object_to`.
        text: own words of that participant; may be empty.
    """

    seat: str
    reason: str
    text: str


@dataclass(frozen=True, slots=True)
class HuntDialogue:
    """A dialogue between a robot and the participant, or the participant of another seat.

    Attributes:
        robot: number of the robot, from 1.
        matter: "select-room", "take-picture" or "take-treasure".
        room: number of the room that the dialogue is about.
        said: all sentences so far, oldest first.
        choices: answers that the participant may give. The first is the most agreeable. Empty during the robot's turn.
        objections: objections of other seats so far, oldest first.
    """

    robot: int
    matter: str
    room: int
    said: tuple[str, ...]
    choices: tuple[str, ...]
    objections: tuple[HuntObjection, ...] = ()


@dataclass(frozen=True, slots=True)
class HuntAgreement:
    """Agreement between a robot and the participant, which the participant may carry out.

    Attributes:
        robot: number of the robot, from 1.
        matter: "select-room", "take-picture" or "take-treasure", as in the dialogue.
        room: number of the room that the agreement is about.
    """

    robot: int
    matter: str
    room: int


@dataclass(frozen=True, slots=True)
class HuntVote:
    """Open vote of the participants on a decision, in a game with several seats.

    Attributes:
        decision: number of the decision, from 1.
        seat: seat of the participant who proposed it, and so agrees.
        kind: "send" (send a robot to a room), "name" (name a treasure) or "end" (end the game).
        robot: number of the robot that is sent; None for other kinds.
        room: number of the destination, or of the treasure's room; None for the end of the game.
        name: proposed name of the treasure; empty for other kinds.
        needs: number of participants who must agree.
        agree: seats whose participants agree.
        disagree: seats whose participants do not agree.
    """

    decision: int
    seat: str
    kind: str
    robot: int | None
    room: int | None
    name: str
    needs: int
    agree: tuple[str, ...]
    disagree: tuple[str, ...]


@dataclass(frozen=True, eq=False, repr=False)
class HuntView:
    """Part of the game that a person may know, as arrays with one row per robot or room, in the order of the numbers.

    Attributes:
        ready: True as soon as robots accept requests.
        consent: text to which the participant must agree first. If None, no consent is needed.
        score: points.
        over: reason why the game ended; None before the end.
        names: possible names of treasures; empty until a treasure is found.
        refusal: reason for the last refusal of a request by the participant; None if no request was refused.
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
        """(n,) remaining energy of each robot."""
        return np.array([robot.energy for robot in self._view.robots])

    @cached_property
    def places(self) -> Integers:
        """(n,) number of the last room of each robot: where it is, or from where it departed; 0 is the corridor."""
        return np.array([robot.place for robot in self._view.robots], dtype=np.int64)

    @cached_property
    def bound_for(self) -> Integers:
        """(n,) number of the room to which each robot is driving; 0 if the robot is at rest."""
        return np.array([robot.moving_to or 0 for robot in self._view.robots], dtype=np.int64)

    @property
    def conditions(self) -> tuple[str, ...]:
        """Condition of each robot: "well", "lost", "silent", or "blocked" (no energy)."""
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
        """(rooms,) True for each visited room whose treasure is not named and not left."""
        return np.array([room.undecided for room in self._view.rooms], dtype=np.bool_)

    @property
    def known(self) -> tuple[Mapping[str, str], ...]:
        """Known properties of the treasure in each room; empty if no property is known."""
        return tuple(room.known for room in self._view.rooms)

    @property
    def pictures(self) -> tuple[str | None, ...]:
        """File name of the picture taken in each room; None if there is no picture."""
        return tuple(room.picture for room in self._view.rooms)

    @property
    def named(self) -> tuple[str | None, ...]:
        """Name given to the treasure in each room; None if no name was given yet."""
        return tuple(None if room.verdict is None else room.verdict.name for room in self._view.rooms)

    @property
    def points(self) -> tuple[int | None, ...]:
        """Points won or lost by the name given in each room; None if no name was given."""
        return tuple(None if room.verdict is None else room.verdict.points for room in self._view.rooms)

    @property
    def dialogues(self) -> tuple[HuntDialogue, ...]:
        """Open dialogues of robots with the participant, and those of other seats that the participant sees."""
        raised = objections_of(self._view)
        return tuple(
            HuntDialogue(
                number_of(each.robot),
                each.matter,
                each.room,
                each.said,
                each.choices,
                tuple(HuntObjection(it.seat, it.reason, it.text) for it in raised if it.dialogue == each.dialogue),
            )
            for each in self._view.dialogues
        )

    @property
    def agreements(self) -> tuple[HuntAgreement, ...]:
        """Agreements that the participant has not carried out yet."""
        return tuple(HuntAgreement(number_of(each.robot), each.matter, each.room) for each in self._view.consents)

    @cached_property
    def commanded(self) -> Booleans:
        """(n,) True for each robot that this participant commands now."""
        return np.array([not robot.has_other_commander for robot in self._view.robots], dtype=np.bool_)

    @property
    def asked_for(self) -> Mapping[int, str]:
        """Robots of this participant that another seat asks for, by number, with the name of that seat."""
        asked = () if self._view.team is None else self._view.team.asked_for
        return {number_of(robot): seat for robot, seat in asked}

    @property
    def votes(self) -> tuple[HuntVote, ...]:
        """Open votes on decisions of the team, oldest first."""
        team = self._view.team
        return () if team is None else tuple(map(_vote_of, team.decisions))

    def __repr__(self) -> str:
        return f"<HuntView score {self.score}, {int(self.visited.sum())} rooms visited, over: {self.over}>"


def _vote_of(vote: DecisionView) -> HuntVote:
    agree = [vote.seat, *(each.seat for each in vote.votes if each.agrees)]
    return HuntVote(
        decision=vote.decision,
        seat=vote.seat,
        kind=vote.kind,
        robot=None if vote.robot is None else number_of(vote.robot),
        room=vote.room,
        name=vote.name,
        needs=vote.needs,
        agree=tuple(agree),
        disagree=tuple(each.seat for each in vote.votes if not each.agrees),
    )


def view_of(view: View) -> HuntView:
    """Convert a view that was sent to the participant into its public form."""
    refusal = None if view.refusal is None else view.refusal.sentence
    return HuntView(view.ready, view.consent, view.score, view.over, view.names, refusal, view)
