"""Trial of a localizer in simulated drives with realistic sensors and all kinds of requests."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import (
    GlobalLocalization,
    KidnapRobot,
    NomotionUpdate,
    SendGoal,
    SetPoseEstimate,
    SetSoftwareParameters,
    TeamInput,
)
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.installed_parts import InstalledParts
from sim.robot.localization.amcl import Amcl
from sim.robot.localization.estimate import Localizer
from sim.robot.navigator.goals import Goal
from sim.team import START_COVARIANCE, Team
from sim.world.sensors import mount_of
from thbridge.app.compose.installed_parts import installed_parts
from thbridge.app.trials.plugin_trial import PluginTrial

_SECONDS = 4
_START = Pose2(2.0, 2.0, 0.0)
_SENT = SendGoal(0, Goal(0, Pose2(6.0, 2.5, 0.0)))


def try_localizer(name: str, seed: int, seconds: float) -> PluginTrial:
    """Return the trial of a localizer; `try_participant` describes arguments and errors."""
    trial = PluginTrial("particle filter")
    software = replace(RobotParameters(), localization=name)
    parts = installed_parts([software], trial.caller(seconds))
    slower = replace(software, move_base=replace(software.move_base, controller_frequency=5.0))
    drives: Mapping[str, tuple[bool, Mapping[int, Sequence[TeamInput]]]] = {
        "A drive in a room": (True, {1: [_SENT]}),
        "A drive in which the laser sees no obstacle": (False, {1: [_SENT]}),
        "A drive with a requested update, a new initial pose and new parameters": (
            True,
            {
                1: [_SENT],
                50: [NomotionUpdate(0)],
                80: [SetPoseEstimate(0, Pose2(3.0, 2.0, 0.5), START_COVARIANCE)],
                110: [SetSoftwareParameters(0, slower)],
            },
        ),
        "A robot that is moved by hand, and then must search its pose on the whole map": (
            True,
            {1: [_SENT], 60: [KidnapRobot(0, Pose2(6.5, 1.0, 1.5))], 100: [GlobalLocalization(0)]},
        ),
    }
    for title, (walls, inputs) in drives.items():
        trial.twice(title, lambda: _drive(trial, title, software, parts, walls, inputs, seed))  # noqa: B023 - at once
    trial.end()
    return trial


def _drive(
    trial: PluginTrial,
    title: str,
    software: RobotParameters,
    parts: InstalledParts,
    walls: bool,
    inputs: Mapping[int, Sequence[TeamInput]],
    seed: int,
) -> Iterator[str]:
    """Drive once, and yield the localizer's estimates at scans."""
    grid, world = _room(walls), WorldParameters()
    team = Team(grid, world, [software], [_START], seed, 100.0, parts=parts)
    amcl: Localizer = Amcl(software.amcl, grid, mount_of(world.laser), seed, "robot1")
    amcl.start(_START, START_COVARIANCE)
    for tick in range(_SECONDS * TICKS_PER_SECOND):
        output = team.step(inputs.get(tick, ())).robots[0]
        sensed, estimate = output.observations, output.estimate
        trial.built_in.measure(lambda: amcl.update(sensed.odometry, sensed.imu, sensed.scan))  # noqa: B023 - at once
        if estimate.fault:
            remedy = "For this tick, return an Estimate with finite numbers"
            scan = "a scan" if sensed.scan is not None else "no scan"
            trial.note(estimate.fault, remedy, (title, f"After {tick / TICKS_PER_SECOND:.2f} s, with {scan}"))
        if sensed.scan is not None or estimate.fault:
            result = (estimate.base_in_map, estimate.covariance.tolist(), estimate.lost, estimate.updated)
            yield f"{tick}: {result!r} {estimate.particles.tobytes().hex()}"


def _room(walls: bool) -> OccupancyGrid:
    """Return a map of a room with a pillar, or of a hall too large for the laser's range."""
    cells = np.full((100, 160) if walls else (400, 400), FREE, np.int8)
    if walls:
        cells[[0, -1]] = cells[:, [0, -1]] = OCCUPIED
        cells[60:66, 80:86] = OCCUPIED
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))
