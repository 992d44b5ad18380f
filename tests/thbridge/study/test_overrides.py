import re
from dataclasses import replace
from pathlib import Path

import pytest

from sim.parameters import RobotParameters
from thbridge.files.errors import BadFile
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import Study, read_study_text

RECORDED = read_study_text(
    Path("study.yaml"),
    "seed: 5\nnoise: {preset: turtlebot2}\nrobot: {amcl: {max_particles: 700}}\n"
    "robots: 3\neach: {2: {localization: ekf}, 3: {amcl: {max_particles: 900}}}\n"
    "things:\n  - {name: crate, shape: crate, at: [1, 2, 0.5]}\n",
)


def test_nothing_changed_is_the_same_study() -> None:
    assert with_changes(RECORDED, [], []) == RECORDED
    assert with_changes(RECORDED, [], [StudyChange("seed", "5")]) == RECORDED


def test_one_key_changes_and_nothing_else() -> None:
    assert with_changes(RECORDED, [], [StudyChange("seed", "6")]) == replace(RECORDED, seed=6)
    assert with_changes(Study(), [], [StudyChange("map", "office")]) == replace(Study(), map="office")


def test_robots_with_software_of_their_own_follow_where_they_had_not_another() -> None:
    study = with_changes(RECORDED, [], [StudyChange("robot.amcl.max_particles", "300")])
    assert [study.software(number).amcl.max_particles for number in (1, 2, 3)] == [300, 300, 900]
    assert study.software(2).localization == "ekf"


def test_a_number_of_noise_may_change_at_its_own_place_too() -> None:
    at_home = with_changes(RECORDED, [], [StudyChange("world.odometry.alpha1", "0.4")])
    assert at_home == with_changes(RECORDED, [], [StudyChange("noise.odometry.alpha1", "0.4")])
    assert at_home.world.odometry.alpha1 == 0.4


def test_one_robot_alone() -> None:
    study = with_changes(
        RECORDED, [], [StudyChange("each.2.localization", "truth"), StudyChange("each.1.localization", "ekf")]
    )
    assert [study.software(number).localization for number in (1, 2, 3)] == ["ekf", "truth", "amcl"]
    assert study.software(3).amcl.max_particles == 900


def test_a_number_of_noise_is_changed_once_and_named_where_it_was_written(tmp_path: Path) -> None:
    changes = tmp_path / "changes.yaml"
    for text, fault in (
        ("noise: {gyro_noise: 0.1}\nnoise: {gyro_noise: 0.2}\n", "line 2, noise: this key is written twice, first in"),
        ("noise:\n  gyro_noise: 0.1\n  gyro_noise: 0.2\n", "gyro_noise: this key is written twice, first in line 2"),
        ("noise: {odometry: {alpha1: -1}}\n", "line 1, noise.odometry.alpha1: -1 is out of range"),
        ("noise: {gyro_noise: 0.1}\nworld:\n  gyro_noise: 0.2\n", "the value is 0.1 here, but 0.2 as"),
    ):
        changes.write_text(text)
        with pytest.raises(BadFile, match=re.escape(fault)):
            with_changes(RECORDED, [changes], [])


def test_another_preset_brings_its_own_numbers() -> None:
    study = with_changes(RECORDED, [], [StudyChange("noise.preset", "perfect")])
    assert study == replace(with_changes(RECORDED, [], []), world=study.world, robot=study.robot, each=study.each)
    fresh = read_study_text(Path("study.yaml"), "noise: {preset: perfect}\nrobot: {amcl: {max_particles: 700}}")
    assert (study.world, study.robot) == (fresh.world, fresh.robot)


def test_values_that_only_fit_together() -> None:
    both = [StudyChange("robot.amcl.min_particles", "2000"), StudyChange("robot.amcl.max_particles", "3000")]
    amcl = with_changes(Study(), [], both).robot.amcl
    assert (amcl.min_particles, amcl.max_particles) == (2000, 3000)


def test_files_come_first_in_their_order(tmp_path: Path) -> None:
    for name, text in (("a.yaml", "seed: 8\nrobots: 1\neach: {}\n"), ("b.yaml", "seed: 9\n")):
        (tmp_path / name).write_text(text)
    study = with_changes(Study(), [tmp_path / "a.yaml", tmp_path / "b.yaml"], [StudyChange("robots", "4")])
    assert (study.seed, study.robots) == (9, 4)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (StudyChange("seeds", "1"), "--with, line 1, seeds: unknown key. The nearest name is seed."),
        (StudyChange("seed", "many"), "--with, line 1, seed: 'many' is not a number."),
        (StudyChange("seed", ""), "--with, line 1, seed: no value."),
        (StudyChange("robot.amcl.min_particles", "2000"), "2000 is above robot.amcl.max_particles"),
        (StudyChange("seed", "[1"), "not YAML"),
        (StudyChange("seed..x", "1"), "--with, line 1, seed"),
    ],
)
def test_faults_are_told_by_the_key(change: StudyChange, told: str) -> None:
    with pytest.raises(BadFile) as caught:
        with_changes(Study(), [], [change])
    assert told in str(caught.value)


def test_files_of_ros_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("ros_parameters: [amcl.yaml]\n")
    with pytest.raises(BadFile, match=r"line 1, ros_parameters: ROS files have no effect here"):
        with_changes(Study(), [tmp_path / "a.yaml"], [])


def test_a_study_that_is_no_section_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("- 1\n")
    with pytest.raises(BadFile, match=r"a\.yaml, line 1"):
        with_changes(Study(), [tmp_path / "a.yaml"], [])


def test_the_software_of_the_defaults_is_kept() -> None:
    assert with_changes(Study(), [], [StudyChange("seed", "3")]).robot == RobotParameters()


@pytest.mark.parametrize("second", [StudyChange("game.energy", "3"), StudyChange("game", "{energy: 3}")])
def test_a_key_is_given_once(second: StudyChange) -> None:
    with pytest.raises(BadFile, match=r"--with, game\.energy: game\.energy is given twice\. Keep one of the two"):
        with_changes(Study(), [], [StudyChange("game.energy", "2"), StudyChange("robots", "2"), second])


def test_two_keys_of_a_section_are_no_clash() -> None:
    changes = [StudyChange("game.energy", "2"), StudyChange("game", "{picture_cost: 3}")]
    changed = with_changes(Study(), [], changes)
    assert (changed.game.energy, changed.game.picture_cost) == (2.0, 3.0)
