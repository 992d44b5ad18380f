"""Plans of `thbridge suggest --team`."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from statistics import mean

from rich.table import Table

from sim.common.robot_numbers import number_of, robot_name
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import StudySetting
from thbridge.hunt.costs import energy_text
from thbridge.hunt.planners import PLANNERS
from thbridge.hunt.rooms import CORRIDOR, Room, RoomNames
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import PlanValue, TourStart, alternatives, best_team_tours, most_rooms_shared_out
from thbridge.hunt.tour import Tour
from ui.command_line.terminal import out, show


@dataclass(frozen=True, slots=True)
class SuggestedPlan:
    """Suggested plan of a team.

    Attributes:
        planner: planner that made the plan.
        tours: one tour per robot.
        points: average value of the treasure in an unvisited room, if it is identified correctly.
        best: value of the best plan. If None, there are too many rooms to find the best plan.
        alternatives: for each robot, the value of each possible next room; empty if the plan is not proven best.
    """

    planner: TeamPlanner
    tours: tuple[Tour, ...]
    points: float
    best: PlanValue | None
    alternatives: tuple[Mapping[Room, PlanValue], ...]

    @property
    def value(self) -> PlanValue:
        """Visited rooms, and the energy of all moves."""
        return PlanValue.of(self.tours)

    @property
    def is_proven(self) -> bool:
        """True if the plan was proven to be the best."""
        return self.planner is TeamPlanner.JOINT and self.best is not None


def plan_of(setting: StudySetting, rooms: Collection[Room], planner: TeamPlanner) -> SuggestedPlan:
    """Return a planner's plan: the robots of a study start at their start poses and visit these rooms.

    Raises:
        ValueError: there are more rooms than this planner can compare.
    """
    starts = team_starts(setting)
    question = (setting.costs, starts, rooms, setting.study.game.identify_cost)
    tours = PLANNERS[planner](*question)
    # In each room, all kinds of treasures are equally likely.
    points = mean(kind.points for kind in setting.templates.kinds)
    if len(set(rooms)) > most_rooms_shared_out(len(starts)):
        return SuggestedPlan(planner, tours, points, None, ())
    if planner is TeamPlanner.JOINT:
        return SuggestedPlan(planner, tours, points, PlanValue.of(tours), alternatives(*question))
    return SuggestedPlan(planner, tours, points, PlanValue.of(best_team_tours(*question)), ())


def team_starts(setting: StudySetting) -> tuple[TourStart, ...]:
    """Return the start of each robot's tour, with the costs of moves and the energy that the study's game uses."""
    study, corridor = setting.study, tuple(setting.costs.rows[CORRIDOR.people])
    if not setting.by_position:
        return (TourStart(corridor, study.game.energy),) * study.robots
    travel = build_travel_times(setting)
    rows = (travel.costs_from(start) for start in setting.map.starts[: study.robots])
    return tuple(
        TourStart(tuple(math.inf if cost is None else cost for cost in row), study.game.energy) for row in rows
    )


def plan_as_json(plan: SuggestedPlan) -> dict[str, object]:
    """Return the plan as a JSON object."""
    robots: list[dict[str, object]] = [
        {"robot": number_of(robot), "tour": [room.people for room in tour.rooms], "cost": tour.cost}
        for robot, tour in enumerate(plan.tours)
    ]
    for robot, of_robot in zip(robots, plan.alternatives, strict=bool(plan.alternatives)):
        robot["alternatives"] = [{"next": room.people, **_as_json(value)} for room, value in of_robot.items()]
    best = None if plan.best is None else _as_json(plan.best)
    return {
        "planner": plan.planner,
        "proven": plan.is_proven,
        "points_of_a_room": plan.points,
        **_as_json(plan.value),
        "best": best,
        "robots": robots,
    }


def show_plan(plan: SuggestedPlan, names: RoomNames) -> None:
    """Print each robot's tour and, for a proven plan, the extra cost of each other next room."""
    table = Table(title=_in_words(plan.value), title_justify="left")
    for heading in ("", "tour", "energy"):
        table.add_column(heading)
    if plan.alternatives:
        table.add_column("extra cost for the team if the robot first visits another room")
    for robot, tour in enumerate(plan.tours):
        way = " ".join(str(room.people) for room in tour.rooms) or "stays"
        losses = [_losses(plan, robot)] if plan.alternatives else []
        table.add_row(robot_name(robot), way, energy_text(tour.cost), *losses)
    out.print(table)
    sent = [(at, tour.rooms[0].people) for at, tour in enumerate(plan.tours) if tour.rooms]
    moves = "; ".join(f"{robot_name(at)} to {names.titled(room)}" for at, room in sent)
    show(f"Next moves: {moves or 'none, all robots stay'}.")
    show(f"Each room is worth {plan.points:.3g} points on average, if its treasure is identified correctly.")
    if plan.best is None:
        show("There are too many rooms to prove that this plan is the best. A better plan may exist.")
    elif plan.best != plan.value:
        show(f"Best plan: {_in_words(plan.best)}.")


def _as_json(value: PlanValue) -> dict[str, object]:
    return {"rooms": value.rooms, "cost": value.cost}


def _in_words(value: PlanValue) -> str:
    return f"{value.rooms} rooms for {energy_text(value.cost)} energy"


def _losses(plan: SuggestedPlan, robot: int) -> str:
    first, value = plan.tours[robot].rooms[:1], plan.value
    others = {room: worth for room, worth in plan.alternatives[robot].items() if (room,) != first}
    return ", ".join(f"{room.people}: {_loss(worth, value.rooms, value.cost)}" for room, worth in others.items())


def _loss(value: PlanValue, rooms: int, spent: float) -> str:
    fewer = rooms - value.rooms
    if fewer:
        return f"{fewer} room{'s' if fewer > 1 else ''} fewer"
    more = value.cost - spent
    return f"{energy_text(more)} energy" if more > 0.0 else "nothing"
