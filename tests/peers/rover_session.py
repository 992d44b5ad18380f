"""A session whose robots are MAVLink rovers, in a process of its own, for other people's ground stations to watch."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from tests.support.programs.processes import Program
from tests.support.project import ROOT
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros.messages import unpack
from thbridge.ros.messages.stamps import START_NS, TICK_NS

PEERS = ROOT / ".peers"
ROBOTS = 3
ORIGIN = (51.5, -0.1, 30.0)
"""Degrees north and east, meters up: where the map's origin lies on earth."""

RATE = "4"
"""Simulated seconds per second. Ground stations go by their own clocks, so that they are in no hurry here."""

STUDY = f"""
robots: {ROBOTS}
robot:
  localization: truth
mavlink:
  origin: [{ORIGIN[0]}, {ORIGIN[1]}, {ORIGIN[2]}]
  lost_after: 60
"""


def needs(client: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(
        not (PEERS / client / "installed").exists(), reason=f"not installed: {client} (see scripts/install_peers.sh)"
    )


@contextmanager
def rovers(
    folder: Path, ports: tuple[int, ...], *options: str, participant: str | None = None, section: str = ""
) -> Iterator[Program]:
    """Three robots in the arena that ground stations at these UDP ports hear; nobody else plays, or such a participant.

    They know where they are, so that what they tell is the truth. What happened is in `a.bag` when it is over.
    `section` is more of the study's section `mavlink`, indented.
    """
    (folder / "study.yaml").write_text(STUDY + section)
    targets = [word for port in ports for word in ("--udp", f"127.0.0.1:{port}")]
    seat = ("--outside", "TabUI") if participant is None else ("--participant", participant)
    alone = ("--headless", *seat, "--port", "0", "--bag", "a.bag", "--no-report", "--rate", RATE)
    play = Program(folder, "play", "study.yaml", "--mavlink", *targets, *alone, *options)
    try:
        yield play
    finally:
        if play.process.poll() is None:
            play.stop()
        play.close()


def truth(bag: Path, system: int) -> dict[int, Pose2]:
    """Where a robot really was, by milliseconds since the start as vehicles count them."""
    topic = f"/robot{system}/base_pose_ground_truth"
    poses: dict[int, Pose2] = {}
    for raw in messages(bag, (topic,)):
        tick = (raw.stamp_ns - START_NS) // TICK_NS
        poses[tick * 1000 // TICKS_PER_SECOND] = unpack.odometry(raw.data).pose
    return poses


def metres(latitude: float, longitude: float) -> tuple[float, float]:
    """East and north of the origin, on the plane that touches WGS84's ellipsoid there; good to a centimeter nearby."""
    east, north = _metres_of_a_degree()
    return (longitude - ORIGIN[1]) * east, (latitude - ORIGIN[0]) * north


def degrees(east: float, north: float) -> tuple[float, float]:
    """Latitude and longitude of a point of the map."""
    of_longitude, of_latitude = _metres_of_a_degree()
    return ORIGIN[0] + north / of_latitude, ORIGIN[1] + east / of_longitude


def _metres_of_a_degree() -> tuple[float, float]:
    """Of longitude and of latitude, at the origin."""
    flattening, radius = 1 / 298.257223563, 6_378_137.0
    eccentricity = flattening * (2 - flattening)
    parallel = math.radians(ORIGIN[0])
    bent = 1 - eccentricity * math.sin(parallel) ** 2
    meridian, vertical = radius * (1 - eccentricity) / bent**1.5, radius / math.sqrt(bent)
    return math.radians(vertical * math.cos(parallel)), math.radians(meridian)
