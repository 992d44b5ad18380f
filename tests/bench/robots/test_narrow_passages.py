"""Our local planner beside ROS's own in sixty fields of cylinders, by the values of the BARN challenge's files.

ROS's stands beside ours only with a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from tests.support.robots.narrow_passages import TIME_LIMIT, Passage, build_peer, drive, driven_by, field_of, robot

pytestmark = pytest.mark.bench

SEEDS = range(1, 61)
LONGEST = 600.0
"""Simulated seconds in which each of our goals ends."""


def reached_in_time(one: Passage) -> bool:
    return one.end == "reached" and one.seconds <= TIME_LIMIT


def told(name: str, drives: Sequence[Passage]) -> str:
    ends = Counter(one.end if one.seconds <= TIME_LIMIT else f"{one.end} later" for one in drives)
    seconds = [one.seconds for one in drives if reached_in_time(one)]
    return (
        f"{name:>4}: {dict(sorted(ends.items()))}; median {np.median(seconds):.1f} s, 95 % "
        f"{np.percentile(seconds, 95):.1f} s; the last goal ended after {max(one.seconds for one in drives):.0f} s"
    )


@pytest.mark.timeout(3600)
def test_fields_of_cylinders(navigation: Path | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    software, fields = robot(), [field_of(seed) for seed in SEEDS]
    ours = [drive(each, software, LONGEST) for each in fields]
    with capsys.disabled():
        print(f"\n{told('ours', ours)}")
    assert not [one for one in ours if one.end in ("collided", "under way")]
    reached = sum(map(reached_in_time, ours))
    assert reached >= 42
    if navigation is None:
        return
    program, theirs = build_peer(navigation, tmp_path), []
    for each in fields:
        with driven_by(program, software):
            theirs.append(drive(each, software))
    with capsys.disabled():
        print(f"{told('ROS', theirs)}")
    assert reached >= sum(map(reached_in_time, theirs))
