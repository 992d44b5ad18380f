"""The sections `things` and `mishaps` of a study: what they become, and what is told of their faults."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import KidnapRobot, KillRobot, PutThing, RemoveThing, ReviveRobot, ScheduledInput, SendGoal
from sim.robot.navigator.goals import Goal, GoalReached
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.files.errors import BadFile
from thbridge.study.study_file import read_study_text
from thbridge.study.text import resolved
from thbridge.study.things import schedule_of

STUDY = Path("study.yaml")
EXAMPLE = """\
things:
  - {name: crate, shape: crate, at: [1, 2, 0.5], appears: 12, vanishes: 60}
  - {name: the visitor, shape: person, path: [[1, 1], [4, 1]], back_and_forth: true}
  - {name: slab, shape: polygon, corners: [[0, 0], [1, 0], [0, 1]], at: [3, 3, 0]}
mishaps:
  - {robot: 2, what: dies, time: 30}
  - {robot: 2, what: revives, time: 35.5}
  - {robot: 1, what: carried, time: 40, to: [4.5, 2.45, 0]}
"""


def test_they_become_inputs_at_their_ticks():
    study = read_study_text(STUDY, EXAMPLE)
    crate, gone, visitor, slab, *mishaps = schedule_of(study.things, study.mishaps)
    assert isinstance(crate.input, PutThing) and crate.tick == 600
    assert crate.input.thing.base_in_map == Pose2(1, 2, 0.5)
    assert sorted(crate.input.thing.footprint) == [(-0.3, -0.3), (-0.3, 0.3), (0.3, -0.3), (0.3, 0.3)]
    assert gone == ScheduledInput(3000, RemoveThing("crate"))
    assert isinstance(visitor.input, PutThing) and visitor.input.thing.length == 3.0
    assert visitor.input.thing.back_and_forth
    assert isinstance(slab.input, PutThing) and slab.input.thing.footprint == ((0, 0), (1, 0), (0, 1))
    assert mishaps == [
        ScheduledInput(1500, KillRobot(1)),
        ScheduledInput(1775, ReviveRobot(1)),
        ScheduledInput(2000, KidnapRobot(0, Pose2(4.5, 2.45, 0))),
    ]


def test_the_resolved_study_reads_back_equal():
    study = read_study_text(STUDY, EXAMPLE)
    assert read_study_text(STUDY, resolved(study)) == study


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ("things:\n  - {shape: crate, at: [1, 2, 0]}", "line 2, things[0].name: missing"),
        ("things:\n  - {name: a, shape: box, at: [1, 2, 0]}", "'box' is not a valid choice. Write crate, door, fire"),
        ("things:\n  - {name: a, shape: crate}", "line 2, things[0]: the thing has neither `at` nor `path`. Write at:"),
        ("things:\n  - {name: a, shape: fire, at: [1, 2, 0], path: [[1, 1], [2, 1]]}", "has both `at` and `path`"),
        ("things:\n  - {name: a, shape: person, path: [[1, 1]]}", "things[0].path: a path needs two points"),
        ("things:\n  - {name: a, shape: person, path: [[1, 1], [1, 1]]}", "two consecutive points are the same"),
        (
            "things:\n  - {name: a, shape: door, at: [1, 2, 0], speed: 1}",
            "things[0].speed: a thing with `at` does not walk",
        ),
        (
            "things:\n  - {name: a, shape: door, at: [1, 2, 0], corners: [[0, 0], [1, 0], [0, 1]]}",
            "a door cannot have corners",
        ),
        ("things:\n  - {name: a, shape: polygon, at: [1, 2, 0]}", "things[0].corners: these corners enclose no area"),
        (
            "things:\n  - {name: a, shape: polygon, at: [1, 2, 0], corners: [[0, 0], [2, 2], [2, 0], [0, 1]]}",
            "the polygon's sides cross each other",
        ),
        (
            "things:\n  - {name: a, shape: polygon, at: [1, 2, 0], size: [1, 1], corners: [[0, 0], [1, 0], [0, 1]]}",
            "things[0].size: a polygon cannot have a size, because its corners determine the size",
        ),
        ("things:\n  - {name: a, shape: crate, at: [1, 2, 0], appears: 5, vanishes: 5}", "is not later than `appears`"),
        (
            "things:\n  - {name: a, shape: crate, at: [1, 2, 0]}\n  - {name: a, shape: crate, at: [3, 2, 0]}",
            "line 3, things[1].name: 'a' is also the name of the thing in line 2",
        ),
        ("mishaps:\n  - {robot: 3, what: dies, time: 1}", "mishaps[0].robot: there is no robot 3: the study has 2"),
        (
            "mishaps:\n  - {robot: 1, what: carried, time: 1}",
            "the new place of the robot is missing. Add the key `to: [x, y, yaw]`",
        ),
        ("mishaps:\n  - {robot: 1, what: dies, time: 1, to: [1, 1, 0]}", "a robot that dies does not move"),
        ("mishaps:\n  - {robot: 1, what: dies}", "mishaps[0].time: missing"),
    ],
)
def test_faults_are_told_with_line_key_and_remedy(lines, told):
    with pytest.raises(BadFile) as caught:
        read_study_text(STUDY, lines)
    assert told in str(caught.value)


def test_a_robot_cannot_be_carried_into_a_wall():
    study = read_study_text(STUDY, "mishaps:\n  - {robot: 1, what: carried, time: 1, to: [5, 5, 0]}")
    with pytest.raises(BadFile, match=r"robot 1 would be moved to \(5, 5\), where it does not fit.*mishaps\[0\]\.to"):
        read_setting(study, Path())


def test_a_study_runs_as_it_says():
    study = replace(read_study_text(STUDY, EXAMPLE.replace("12,", "0.1,").replace("time: 30", "time: 0.2")))
    team = build_team(read_setting(study, Path()))
    snapshots = [team.step() for _ in range(20)]
    names = [[presence.thing.name for presence in snapshot.world.things] for snapshot in snapshots]
    assert names[3] == ["the visitor", "slab"]
    assert names[4] == ["the visitor", "slab", "crate"]
    assert [bool(snapshot.dead) for snapshot in snapshots].index(True) == 9


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_robots_among_people_touch_nobody_and_arrive(seed):
    study = read_study_text(
        STUDY,
        f"""\
robots: 4
seed: {seed}
things:
  - {{name: crate, shape: crate, at: [2.0, 1.0, 0.5], appears: 5, vanishes: 60}}
  - {{name: visitor, shape: person, path: [[0, 2.4], [5, 2.4]], back_and_forth: true}}
  - {{name: hurry, shape: person, path: [[5.5, -0.4], [-0.4, -0.4], [-0.4, 4]], back_and_forth: true, speed: 1.2}}
""",
    )
    setting = read_setting(study, Path())
    team = build_team(setting)
    arrived = 0
    inputs = [SendGoal(robot, Goal(0, setting.map.rooms[robot].goal)) for robot in range(4)]
    for number in range(1, 100 * TICKS_PER_SECOND):
        snapshot = team.step(inputs)
        assert snapshot.world.collisions.tolist() == [0] * 4
        ended = [robot for robot, said in enumerate(snapshot.robots) if isinstance(said.navigation.result, GoalReached)]
        arrived += len(ended)
        inputs = [SendGoal(robot, Goal(number, setting.map.rooms[(robot + arrived) % 8].goal)) for robot in ended]
    assert arrived >= 8
