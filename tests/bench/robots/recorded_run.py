"""A robot's tour of a map, as its filter would see it, with the truth beside: what localizers are compared on."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.common.observations import TICKS_PER_SECOND, Imu, LaserMount, Odometry, Scan, Twist
from sim.inputs import DriveManually, PutThing, SendGoal, TeamInput
from sim.numerics.float_array import FloatArray
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import LaserParameters, OdometryNoise, RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal
from sim.team import Team
from sim.world.sensors import mount_of
from sim.world.thing import Thing
from thbridge.files.map_files import Map

DEGRADED = WorldParameters(
    odometry=OdometryNoise(linear_scale=1.05, angular_scale=1.10),
    laser=LaserParameters(beams=541, range_max=10.0),
)
"""Wheels that report 5 % too much distance and 10 % too much turning, beside their noise."""


@dataclass(frozen=True, slots=True)
class Run:
    """One tour.

    Attributes:
        mount: the laser.
        observations: odometry, imu and scan of every tick that had a scan.
        truth: (n, 3) of the base in the map, at each of them.
    """

    mount: LaserMount
    observations: tuple[tuple[Odometry, Imu, Scan], ...]
    truth: FloatArray


LONGEST_DRIVE = 120 * TICKS_PER_SECOND
"""Ticks after which a goal that unmapped things keep the robot from is given up for the next one."""
SPIN_TICKS = 6 * TICKS_PER_SECOND


def tour(
    place: Map, seed: int, rooms: int = 8, world: WorldParameters = DEGRADED, bodies: Sequence[Thing] = (),
    spin: float = 0.0,
) -> Run:  # fmt: skip
    """Drive through so many rooms in an order that the seed draws; the driver knows the truth, its odometry is bad.

    Args:
        place: the world, without the bodies.
        seed: of order and noise.
        rooms: how many.
        world: how sensors err.
        bodies: what no map shows.
        spin: rad/s at which the robot turns for some seconds in each room.
    """
    order = np.argsort(NoiseStream.named(seed, "tour").uniforms(0, len(place.rooms)))[:rooms]
    team = Team(place.grid, world, [RobotParameters(localization="truth")], place.starts[:1], seed, 1e9)
    observations, truth = [], []

    def step(inputs: Sequence[TeamInput]) -> bool:
        """Do one tick; return True when the goal is reached or given up."""
        output = team.step(inputs).robots[0]
        seen = output.observations
        if seen.scan is not None:
            observations.append((seen.odometry, seen.imu, seen.scan))
            truth.append(output.estimate.base_in_map.array())
        return output.navigation.result is not None

    inputs: list[TeamInput] = [PutThing(body) for body in bodies]
    for number, room in enumerate(order):
        inputs.append(SendGoal(0, Goal(number, place.rooms[room].goal)))
        for _ in range(LONGEST_DRIVE):
            ended = step(inputs)
            inputs = []
            if ended:
                break
        if spin:
            step([DriveManually(0, Twist(0.0, spin), SPIN_TICKS)])
            for _ in range(SPIN_TICKS):
                step([])
    return Run(mount_of(world.laser), tuple(observations), np.array(truth))


def part(run: Run, begin: int, scans: int) -> Run:
    """So many scans of a run."""
    return replace(run, observations=run.observations[begin : begin + scans], truth=run.truth[begin : begin + scans])


def kidnapped(run: Run, seed: int, before: int = 150, after: int = 600, least: float = 4.0) -> Run:
    """Two parts of a run, `before` scans and `after`: between them the robot is carried, and its wheels do not notice.

    Where from and where to the seed draws; at least so many meters lie between.
    """
    for first, second in NoiseStream.named(seed, "kidnapping").uniforms(0, 2000).reshape(-1, 2):
        lifted = before + int(first * (len(run.truth) - before))
        put = int(second * (len(run.truth) - after))
        if np.hypot(*(run.truth[lifted - 1] - run.truth[put])[:2]) > least:
            break
    head, tail = part(run, lifted - before, before), part(run, put, after)
    wheels, there = head.observations[-1][0], tail.observations[0][0]
    later = wheels.tick + 1 - there.tick
    moved = [
        (
            replace(
                odometry,
                tick=odometry.tick + later,
                base_in_odom=wheels.base_in_odom.compose(there.base_in_odom.between(odometry.base_in_odom)),
            ),
            imu,
            scan,
        )
        for odometry, imu, scan in tail.observations
    ]
    return Run(run.mount, (*head.observations, *moved), np.concatenate((head.truth, tail.truth)))


def write_for_peer(run: Run, grid: OccupancyGrid, folder: Path) -> tuple[Path, Path]:
    """The map and the run as amcl_peer.cpp reads them."""
    mount = run.mount
    drawn, log = folder / "map", folder / "log"
    head = struct.pack("<ii3d", grid.rows, grid.cols, grid.resolution, grid.origin.x, grid.origin.y)
    drawn.write_bytes(head + grid.cells.tobytes())
    laser = mount.laser_in_base
    parts = [
        struct.pack("<i", mount.beams),
        struct.pack("<3d", mount.angle_min, mount.angle_increment, mount.range_max),
        struct.pack("<3d", laser.x, laser.y, laser.theta),
    ]
    for odometry, _, scan in run.observations:
        parts += [odometry.base_in_odom.array().astype("<f8").tobytes(), scan.ranges.astype("<f4").tobytes()]
    log.write_bytes(b"".join(parts))
    return drawn, log
