import runpy
from pathlib import Path

import pytest

drawn = runpy.run_path(str(Path(__file__).parents[2] / "scripts" / "draw" / "encounters.py"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "ends"),
    [
        ("two_swap", {"arrived"}),
        ("ten_through_one_door", {"arrived"}),
        ("dead_robot_two_doors", {"arrived"}),
        ("dead_robot_one_door", {"blocked_by_obstacle"}),
    ],
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_encounter_ends_as_it_must_without_a_collision(name, ends, seed):
    encounter = drawn["ENCOUNTERS"][name]()
    course = drawn["play"](encounter, seed)
    assert course.collisions == 0
    for goal, end in zip(encounter.goals, course.ends, strict=True):
        assert (end is None) == (goal is None)
        assert end is None or end[0] in ends
