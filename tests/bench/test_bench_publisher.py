"""How many messages a second of CPU makes, from what the robots did in a tick to packed bytes; nothing is written."""

import time
from dataclasses import replace

import numpy as np
import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.team import TeamSnapshot
from tests.thbridge.ros.drive import MOUNT, SCAN_PERIOD, records, snapshots
from thbridge.ros.publisher import TeamPublisher

pytestmark = pytest.mark.bench

SECONDS = 20
FOOTPRINT = np.array([[0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.25, -0.2]])


def filmed(robots: int) -> list[TeamSnapshot]:
    return [
        replace(
            snapshot,
            robots=tuple(
                replace(robot, neighbour=replace(robot.neighbour, footprint=FOOTPRINT)) for robot in snapshot.robots
            ),
        )
        for snapshot in snapshots(robots, SECONDS * TICKS_PER_SECOND)
    ]


@pytest.mark.parametrize("robots", [3, 10])
def test_messages_from_snapshots_to_bytes(robots: int) -> None:
    film = filmed(robots)
    best, count, size = float("inf"), 0, 0
    for _ in range(5):
        publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
        count = size = 0
        begin = time.process_time()
        for snapshot in film:
            messages = publisher.tick(snapshot, records(snapshot.tick))
            count += len(messages)
            size += sum(len(message.data) for message in messages)
        best = min(best, time.process_time() - begin)
    share = 100 * best / SECONDS
    print(
        f"{robots} robots: {count / best:,.0f} messages per CPU second"
        f" ({count / SECONDS:,.0f} a second of the session, {size / SECONDS / 1e6:.2f} MB; {share:.1f} % of a core)"
    )
    assert count > 0
