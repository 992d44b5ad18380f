"""Builders of the robots: the simulated team, and the role of the robots."""

from collections.abc import Sequence

import numpy as np

from sim.common.observations import TICKS_PER_SECOND
from sim.common.robot_numbers import number_of
from sim.inputs import ScheduledInput, SendGoal
from sim.robot.costmap.footprint import radii
from sim.robot.navigator.goals import Goal
from sim.team import Team
from thbridge.app.compose.setting import StudySetting
from thbridge.offline.plan import costmap
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.simr.game_moves import GameMap
from thbridge.roles.simr.pose_telemetry import TelemetryOptions
from thbridge.roles.simr.simr import RESPONSE_TIMEOUT, SimR
from thbridge.roles.simr.team import RobotTeam
from thbridge.roles.simr.travel_times import TravelTimes
from thbridge.study.seats import seats_of
from thbridge.study.things import schedule_of

REHEARSAL = 5 * TICKS_PER_SECOND
"""Length of a rehearsal, ticks. In a rehearsal, robots localize, plan around each other, turn and drive."""
REHEARSERS = 10
"""Maximum number of robots with common parameters in one rehearsal. More robots would not compile more kernels."""


def build_team(setting: StudySetting) -> Team:
    """Return the simulated robots at their start poses."""
    study = setting.study
    return _team(setting, range(study.robots), schedule_of(study.things, study.mishaps))


def _team(setting: StudySetting, robots: Sequence[int], schedule: Sequence[ScheduledInput]) -> Team:
    """Return some of the study's robots at their start poses."""
    study = setting.study
    starts = [setting.map.starts[robot] for robot in robots]
    software = [study.software(number_of(robot)) for robot in robots]
    return Team(
        setting.map.grid, study.world, software, starts, study.seed, study.game.energy, schedule, parts=setting.parts
    )


def rehearse(setting: StudySetting) -> None:
    """Drive simulated robots for a few seconds, so that numba compiles all kernels before the session begins.

    In a large team, all robots with separate parameters drive, but only some of the robots with the common parameters.
    """
    study, rooms = setting.study, setting.map.rooms
    robots = [robot for robot in range(study.robots) if robot < REHEARSERS or number_of(robot) in study.each]
    team = _team(setting, robots, schedule_of(study.things, ()))
    orders = [SendGoal(robot, Goal(0, rooms[robot % len(rooms)].goal)) for robot in range(team.size)]
    for tick in range(REHEARSAL):
        team.step(orders if tick == 0 else [])


def build_simr(
    setting: StudySetting, robots: RobotTeam | None = None, response_timeout: int = RESPONSE_TIMEOUT
) -> SimR:
    """Return the role of the robots. If `robots` is None, the robots are simulated.

    `SimR` describes `response_timeout`; the unit is ticks.
    """
    field = GameMap(
        name=setting.map.name,
        goals=tuple(room.goal for room in setting.map.rooms),
        starts=setting.map.starts[: setting.study.robots],
        costs=plain_costs(setting.costs),
        travel=build_travel_times(setting) if setting.by_position else None,
    )
    shown = setting.study.participant.shows
    shows = TelemetryOptions(shown.way, shown.uncertainty, shown.truth)
    seats = seats_of(setting.study.seats)
    return SimR(robots or build_team(setting), field, setting.study.server.dialect, response_timeout, shows, seats)


def build_travel_times(setting: StudySetting) -> TravelTimes:
    """Return the travel times of the study's robots from any place of the map."""
    place, study = setting.map, setting.study
    inscribed, _ = radii(np.array(study.world.footprint))
    inflation = study.software(number_of(0)).global_costmap.inflation_layer.inflation_radius
    return TravelTimes(
        place.grid,
        costmap(place.grid, inscribed, inflation),
        [room.goal for room in place.rooms],
        place.starts[: study.robots],
        plain_costs(setting.costs),
    )
