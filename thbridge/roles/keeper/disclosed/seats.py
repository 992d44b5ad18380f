"""Participants of the seats, and what each seat sees of a game."""

from collections.abc import Collection
from dataclasses import replace

from msgspec import UNSET, structs

from thbridge.hunt.events import Commander, ConsentGiven
from thbridge.hunt.game import GameState
from thbridge.hunt.rules import RuleReason
from thbridge.hunt.seats import DialogueSight, PlayedBy, Seat
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.consent import ConsentAnswer
from thbridge.roles.keeper.disclosed.participants import Participants
from thbridge.roles.keeper.team.game_team import GameTeam
from thbridge.roles.shared.notices import KEEPER
from thbridge.roles.shared.seat_programs import is_researchers
from thbridge.roles.shared.seat_rights import may_discuss
from thbridge.roles.shared.view import (
    Debrief,
    DialogueMatter,
    RefusalView,
    RobotView,
    RoomView,
    Teammate,
    TeamView,
    View,
)


class ParticipantSeat:
    """A seat, with the programs and the consent of its participant.

    Args:
        seat: the seat.
        briefing: briefing of the study.

    Attributes:
        seat: the seat.
        participants: programs of the participant.
        consent: consent of the participant.
        is_away: True while the participant is away from their front end.
        is_simulated: True if the participant is a program.
    """

    def __init__(self, seat: Seat, briefing: Briefing) -> None:
        self.seat = seat
        seen = briefing if seat.sees_map else replace(briefing, floor_plan=None)
        self.participants = Participants(KEEPER, seen)
        self.is_away = self.is_simulated = False
        self.consent = ConsentAnswer(briefing.consent is not None, seat.name)

    @property
    def played_by(self) -> PlayedBy | None:
        """Present player of the seat: its participant, else a researcher; None if there is none."""
        programs = self.participants.reachable
        if not self.is_away and programs and not all(map(is_researchers, programs)):
            return PlayedBy.PROGRAM if self.is_simulated else PlayedBy.PERSON
        return PlayedBy.RESEARCHER if any(map(is_researchers, programs)) else None

    def first_events(self, former: GameState | None) -> tuple[ConsentGiven, ...]:
        """Return the event of consent directly after the start of a game; see `ConsentAnswer.first_events`."""
        return tuple(structs.replace(event, seat=self.seat.name) for event in self.consent.first_events(former))


def view_of_seat(
    view: View,
    state: GameState,
    seat: Seat,
    joined: Collection[str],
    team: GameTeam,
    *,
    talk_is_open: bool = False,
    room_names: tuple[str, ...] = (),
) -> View:
    """Return the part of a view that a seat may see.

    Args:
        view: view of a participant who sees everything.
        state: state of the game.
        seat: the seat.
        joined: names of the seats whose participants are present.
        team: the participants, with their texts, votes and objections.
        talk_is_open: True if participants may send texts to each other now.
        room_names: names of the map's rooms. People talk about rooms by these names, also with people who see no map.
    """
    seats = state.started.seats
    commanders = [robot.command for robot in state.robots]
    own = [robot.by is Commander.PARTICIPANT and robot.name == seat.name for robot in commanders]

    def is_mine(robot: int, matter: DialogueMatter) -> bool:
        return own[robot] if matter != "take-treasure" else seat.names_treasures

    sees_all = seat.sees_dialogues is DialogueSight.ALL
    labels = {each.name: each.label for each in seats}

    def partner(robot: int, matter: DialogueMatter) -> str:
        able = (each.name for each in seats if may_discuss(state, each, robot, matter) is None)
        return next(able, "")

    shown = [each for each in view.dialogues if sees_all or is_mine(each.robot, each.matter)]
    last_words = tuple(each for each in view.last_words if sees_all or is_mine(each.robot, each.matter))
    objections = team.objections.views({*(each.dialogue for each in shown), *(each.dialogue for each in last_words)})
    view = structs.replace(
        view,
        robots=tuple(_robot_of_seat(robot, state, seat, labels) for robot in view.robots),
        dialogues=tuple(
            each if is_mine(each.robot, each.matter) and seat.talks else replace(each, choices=(), acts=())
            for each in shown
        ),
        consents=tuple(each for each in view.consents if is_mine(each.robot, each.matter)),
        thinking=tuple(robot for robot in view.thinking if sees_all or own[robot]),
        last_words=last_words,
        team=TeamView(
            own=seat,
            teammates=tuple(Teammate(each, each.name in joined) for each in seats if each != seat),
            asked_for=tuple(
                (number, robot.asked_by)
                for number, robot in enumerate(state.robots)
                if own[number] and robot.asked_by not in {"", seat.name}
            ),
            partners=tuple(
                (each.dialogue, partner(each.robot, each.matter))
                for each in shown
                if not is_mine(each.robot, each.matter)
            ),
            decisions=team.decisions.views(),
            settled=team.decisions.settled,
            talk_is_open=talk_is_open,
            room_names=() if seat.sees_map else room_names,
            read=team.talk.read_until(seat.name),
            objections=objections or UNSET,
        ),
    )
    if not seat.sees_energy:
        view = _without_energy(view)
    return view if seat.sees_score else _without_score(view)


def _robot_of_seat(robot: RobotView, state: GameState, seat: Seat, labels: dict[str, str]) -> RobotView:
    command, asker = state.robots[robot.robot].command, state.robots[robot.robot].asked_by
    robot = replace(robot, asked_back=robot.asked_back and asker == seat.name)
    if command.by is not Commander.PARTICIPANT or command.name == seat.name:
        return robot
    return replace(robot, commander=Commander.TEAMMATE, commander_name=labels.get(command.name, ""))


def _without_energy(view: View) -> View:
    def hidden(costs: tuple[float | None, ...]) -> tuple[float | None, ...]:
        return tuple(None if cost is None else 0.0 for cost in costs)

    return structs.replace(
        view,
        costs=tuple(map(hidden, view.costs)),
        robots=tuple(
            replace(robot, energy=0.0 if robot.blocked else 1.0, costs=hidden(robot.costs)) for robot in view.robots
        ),
        picture_cost=0.0,
        identify_cost=0.0,
        refusal=_without_numbers(view.refusal),
        properties=tuple(replace(each, cost=0.0) if each.is_measured else each for each in view.properties),
    )


def _without_numbers(refusal: RefusalView | None) -> RefusalView | None:
    """Return a refusal without the energy and costs in its sentence."""
    if refusal is None or refusal.reason != RuleReason.NOT_ENOUGH_ENERGY:
        return refusal
    return replace(refusal, sentence="The robot does not have enough energy for this.")


def _without_score(view: View) -> View:
    def hidden(room: RoomView) -> RoomView:
        return room if room.verdict is None else replace(room, verdict=replace(room.verdict, points=0))

    return structs.replace(
        view, score=0, rooms=tuple(map(hidden, view.rooms)), worth=(), wrong_share=None, debrief=_thanks_only(view)
    )


def _thanks_only(view: View) -> Debrief | None:
    return None if view.debrief is None else Debrief(farewell=view.debrief.farewell)
