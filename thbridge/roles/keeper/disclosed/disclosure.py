"""Construction of the participant's view from the state of a game."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.properties import TreasureProperty
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.dialogues import GameDialogues
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.shared.view import Debrief, IdentificationVerdict, RefusalView, RobotView, RoomView, View

_HAVE_LAST_WORD: Mapping[DialogueCondition, Literal["both", "participant", "robot"]] = {
    DialogueCondition.COLLABORATOR: "both",
    DialogueCondition.ADVISER: "participant",
    DialogueCondition.AUTONOMOUS: "robot",
}


def view_of(
    state: GameState,
    dialogues: GameDialogues,
    refusal: RefusalView | None,
    briefing: Briefing,
    *,
    robots_ready: bool,
    asks: bool,
    asked_back: Collection[int] = (),
    debrief: Debrief | None = None,
    names_energy: bool = True,
) -> View:
    """Return the participant's view. It contains only known facts about the treasures.

    `asks` is True if the game waits for the participant's consent. If `names_energy` is False, sentences of dialogues
    contain no amounts of energy.
    """
    sensed = any(room.sensed is not None for room in state.rooms)
    return View(
        game=state.started.game,
        ready=robots_ready,
        costs=plain_costs(state.started.costs),
        robots=tuple(_robot(state, number, number in asked_back) for number in range(len(state.robots))),
        rooms=tuple(_room(state, room) for room in state.started.costs.rooms),
        dialogues=dialogues.views(names_energy=names_energy),
        consents=dialogues.agreements.all,
        score=state.score,
        over=None if state.ended is None else state.ended.reason.value,
        picture_cost=state.started.picture_cost,
        identify_cost=state.started.identify_cost,
        refusal=refusal,
        names=briefing.names if sensed else (),
        called=_called(briefing, briefing.names if sensed else _debriefed(debrief)),
        consent=briefing.consent if asks else None,
        thinking=dialogues.asked_for_advice,
        by_position=state.by_position,
        debrief=debrief,
        worth=briefing.worth if sensed else (),
        wrong_share=state.started.wrong_share if briefing.worth else None,
        sound=briefing.sound,
        properties=_with_words(state, briefing),
        last_words=(dialogues.last_words if names_energy else dialogues.last_words_without_energy).all,
        has_last_word=_HAVE_LAST_WORD.get(briefing.condition),
    )


def _called(briefing: Briefing, names: Iterable[str]) -> dict[str, str]:
    """Return the words for the names that the view reveals."""
    return {name: briefing.called[name] for name in names if name in briefing.called}


def _debriefed(debrief: Debrief | None) -> tuple[str, ...]:
    """Return the names of treasures in a debrief."""
    return () if debrief is None else tuple(room.name for room in debrief.rooms)


def _with_words(state: GameState, briefing: Briefing) -> tuple[TreasureProperty, ...]:
    """Return the properties of the game, with words only for declared and known values."""
    if not briefing.words or briefing.properties != state.started.properties:
        return state.started.properties
    known = [room.known for room in state.rooms]

    def revealed(words: TreasureProperty) -> TreasureProperty:
        values = words.values or tuple(of_room[words.name] for of_room in known if words.name in of_room)
        return replace(words, words={value: words.words[value] for value in values if value in words.words})

    return tuple(map(revealed, briefing.words))


def plain_costs(costs: CostMatrix) -> tuple[tuple[float | None, ...], ...]:
    """Return a cost matrix as JSON values. None means that there is no move."""
    return tuple(plain_row(row) for row in costs.rows)


def plain_row(row: Sequence[float]) -> tuple[float | None, ...]:
    """Return a row of a cost matrix as JSON values. None means that there is no move."""
    return tuple(None if math.isinf(cost) else cost for cost in row)


def _robot(state: GameState, number: int, asked_back: bool) -> RobotView:
    robot = state.robots[number]
    moving_to = None if robot.bound_for is None else robot.bound_for.people
    command = robot.command
    return RobotView(
        robot=number,
        place=robot.at.people,
        moving_to=moving_to,
        energy=robot.energy,
        blocked=robot.is_blocked,
        condition=robot.condition,
        commander=command.by,
        # Participants do not see the names of researchers' programs.
        commander_name=command.name if command.by is Commander.GROUND_STATION else "",
        asked_back=asked_back,
        costs=() if robot.costs is None else plain_row(robot.costs),
    )


def _room(state: GameState, room: Room) -> RoomView:
    known = state.room(room)
    going = state.reserved_by(room)
    return RoomView(
        room=room.people,
        state="visited" if known.visited else "unvisited" if going is None else "reserved",
        robot=state.decider(room) if going is None else going,
        sensed=known.sensed,
        picture=known.image,
        verdict=None if known.points is None else IdentificationVerdict(known.name or "", known.points),
        left=known.left,
        told=known.told,
    )
