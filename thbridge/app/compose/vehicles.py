"""Builder of the robots' MAVLink vehicles. Sessions without vehicles do not import this module."""

from collections.abc import Callable

from sim.common.robot_numbers import number_of
from thbridge.app.compose.game import room_outlines, treasure_names
from thbridge.app.compose.setting import StudySetting
from thbridge.mavlink.role.parameters import VehicleParameters
from thbridge.mavlink.role.pilot import GameSetup, Pilot
from thbridge.mavlink.role.speed_limit import SpeedLimit
from thbridge.mavlink.role.vehicles import RequestSink, Vehicles
from thbridge.roles.shared.role import Role
from thbridge.roles.simr.simr import SimR


def build_game_setup(setting: StudySetting) -> GameSetup:
    """Return the facts that the robots' pilots know before the game begins."""
    study = setting.study
    software = [study.software(number_of(robot)) for robot in range(study.robots)]
    planners = [each for one in software for each in (one.NavfnROS, one.GlobalPlanner)]
    return GameSetup(
        setting.floor(),
        room_outlines(setting),
        treasure_names(setting),
        study.game.energy,
        plans_end_apart=any(planner.default_tolerance > 0.0 for planner in planners),
    )


def vehicle_factory(setting: StudySetting, simr: Role) -> Callable[[RequestSink], Vehicles] | None:
    """Return the factory of the robots' MAVLink vehicles, or None if there are no vehicles.

    The argument of the factory receives the requests of the vehicles. Only the simulated robots of `SimR` can be
    vehicles.
    """
    study = setting.study
    if not study.mavlink.on or not isinstance(simr, SimR):
        return None
    setup = build_game_setup(setting)

    def made(ask: RequestSink) -> Vehicles:
        pilots = []
        for robot, start in enumerate(setting.map.starts[: study.robots]):
            speed_limit = SpeedLimit(robot, study.software(number_of(robot)), simr)
            pilots.append(Pilot(robot, setup, start, speed_limit, VehicleParameters(robot, simr), ask))
        return Vehicles(pilots, study.mavlink.options)

    return made
