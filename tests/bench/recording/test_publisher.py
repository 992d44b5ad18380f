"""How many messages a second of CPU makes, from what the robots did in a tick to packed bytes; nothing is written."""

from dataclasses import replace

import numpy as np
import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.snapshot import TeamSnapshot
from tests.bench.budget import Budgets, best
from tests.support.bags.drawn_team import MOUNT, SCAN_PERIOD, records, snapshots
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
def test_messages_from_snapshots_to_bytes(robots: int, budgets: Budgets) -> None:
    film = filmed(robots)
    count = size = 0

    def publish() -> None:
        nonlocal count, size
        publisher = TeamPublisher(robots, MOUNT, SCAN_PERIOD)
        count = size = 0
        for snapshot in film:
            messages = publisher.tick(snapshot, records(snapshot.tick))
            count += len(messages)
            size += sum(len(message.data) for message in messages)

    spent = best(publish, 5)
    share = 100 * spent / SECONDS
    print(
        f"{robots} robots: {count / spent:,.0f} messages per CPU second"
        f" ({count / SECONDS:,.0f} a second of the session, {size / SECONDS / 1e6:.2f} MB; {share:.1f} % of a core)"
    )
    assert count > 0
    budgets.time(f"messages: a second of {robots} robots", spent / SECONDS)
