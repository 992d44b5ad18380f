"""Designs as people write them: conditions, and faults with file, line, key and remedy."""

from pathlib import Path

import pytest

from thbridge.batch.design import SweepDesign, read_design
from thbridge.files.errors import BadFile
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import Study


def design(folder: Path, text: str) -> SweepDesign:
    path = folder / "design.yaml"
    path.write_text(text)
    return read_design(path)


def fault(folder: Path, text: str) -> str:
    with pytest.raises(BadFile) as raised:
        design(folder, text)
    return str(raised.value).replace(f"{folder}/", "")


def test_every_combination_of_levels_is_a_condition_and_its_study_is_that_of_with(tmp_path: Path) -> None:
    read = design(tmp_path, "factors:\n  noise.preset: [none, bad wheels]\n  robots: [1, 2, 3]\n")
    assert [tuple(each.levels.values()) for each in read.conditions] == [
        (noise, robots) for noise in ("none", "bad wheels") for robots in ("1", "2", "3")
    ]
    changes = [StudyChange("noise.preset", "bad wheels"), StudyChange("robots", "2")]
    assert read.conditions[4].study == with_changes(Study(), [], changes)


def test_prices_of_another_map_are_a_doubt_once_for_all_conditions(tmp_path: Path) -> None:
    (doubt,) = design(tmp_path, "base: {map: office, game.costs: original-2016}\nfactors: {robots: [1, 2]}\n").doubts
    assert "the costs of moves on the map office come from this file for the map arena8" in str(doubt)


def test_a_study_file_the_designs_own_keys_and_conditions_lie_over_each_other(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots: 3\ngame: {energy: 30, picture_cost: 2}\n")
    read = design(tmp_path, "study: study.yaml\nbase: {game.energy: 20}\nfactors: {game.picture_cost: [0, 1]}\n")
    games = [condition.study.game for condition in read.conditions]
    assert [(game.energy, game.picture_cost) for game in games] == [(20.0, 0.0), (20.0, 1.0)]
    assert all(condition.study.robots == 3 for condition in read.conditions)


def test_a_range_has_both_ends_and_equal_steps(tmp_path: Path) -> None:
    read = design(tmp_path, "factors: {noise.odometry.alpha1: {from: 0, to: 0.3, steps: 4}}\n")
    assert [each.levels["noise.odometry.alpha1"] for each in read.conditions] == ["0", "0.1", "0.2", "0.3"]
    assert [each.study.world.odometry.alpha1 for each in read.conditions] == [0.0, 0.1, 0.2, 0.3]
    assert read.columns.kinds == {"noise.odometry.alpha1": "double"}


def test_a_level_with_a_name_sets_several_keys(tmp_path: Path) -> None:
    levels = "{weak: {robots: 1, game.energy: 20}, strong: {robots: 3, game: {energy: 60}}}"
    read = design(tmp_path, f"factors:\n  team: {levels}\n")
    assert [(each.levels["team"], each.study.robots, each.study.game.energy) for each in read.conditions] == [
        ("weak", 1, 20.0),
        ("strong", 3, 60.0),
    ]


def test_conditions_that_are_written_out_come_after_the_combinations(tmp_path: Path) -> None:
    read = design(tmp_path, "factors: {robots: [1, 2]}\nconditions:\n  - {robots: 3, map: warehouse12}\n")
    assert [dict(each.levels) for each in read.conditions][2] == {"robots": "3", "map": "warehouse12"}
    assert read.conditions[2].study.map == "warehouse12"
    assert read.columns.levels[1] == {"robots": 1, "map": None}


def test_conditions_alone_need_no_combination(tmp_path: Path) -> None:
    read = design(tmp_path, "conditions:\n  - {robots: 3}\n  - {robots: 1}\n")
    assert [each.study.robots for each in read.conditions] == [3, 1]


def test_without_anything_it_is_one_condition_of_the_default_study(tmp_path: Path) -> None:
    read = design(tmp_path, "")
    assert [each.study for each in read.conditions] == [Study()]
    assert read.seeds == tuple(range(1, 11))


def test_the_study_in_docs_is_a_design(tmp_path: Path) -> None:
    read = read_design(Path(__file__).parents[3] / "docs" / "sweeps" / "odometry-noise.yaml")
    assert (len(read.conditions), read.games) == (20, 2000)
    assert read.columns.kinds["odometry_noise"] == "double"
    assert read.conditions[-1].study.world.odometry.alpha4 == 2.0


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("factor: {robots: [1]}\n", "design.yaml, line 1, factor: unknown key. The nearest name is factors."),
        ("factors:\n  robotz: [1]\n", "design.yaml, line 2, robotz: unknown key. The nearest name is robot."),
        (
            "factors:\n  participant.strategy:\n    - nearest\n    - nearst\n",
            "design.yaml, line 4, participant.strategy: 'nearst' is not a valid choice. Write suggestion, nearest or ",
        ),
        (
            "base: {map: office}\nfactors:\n  robots: [2, 60]\n",
            "design.yaml, line 3, robots: ",
        ),
        (
            "factors:\n  robots: [1, 2]\n  map: [arena9]\n",
            "(condition 1 (robots=1, map=arena9)). ",
        ),
        ("factors: {robots: []}\n", "design.yaml, line 1, factors.robots: the factor has no levels. Write [LEVEL, "),
        ("factors: {robots: [2, 2]}\n", "factors.robots: the level 2 is listed twice. Keep one of the two."),
        (
            "factors: {game.energy: [20, 20.0]}\n",
            "factors.game.energy: the level 20 is listed twice. Keep one of the two.",
        ),
        (
            "factors: {robots: {from: 1}}\n",
            "factors.robots: the range needs a first and a last value. Write {from: A, to: B, steps: N}.",
        ),
        ("factors: {seed: [1, 2]}\n", "design.yaml, line 1, factors.seed: "),
        (
            "base: {seed: 4}\nconditions:\n  - {seed: 3}\n",
            "design.yaml, line 3, seed: a condition cannot have its own seed",
        ),
        (
            "factors: {score: [1, 2]}\n",
            "factors.score: results already have a column with this name. Give the factor another name.",
        ),
        ("measures: [scor]\n", "design.yaml, line 1, measures[0]: 'scor' is not a valid choice. Write score, over, "),
        ("bags: 1 of 5\n", "design.yaml, line 1, bags: '1 of 5' is not a valid choice. Write no, yes, or for example "),
        ("seeds: [1, 2, 1]\n", "design.yaml, line 1, seeds: a seed is listed twice. "),
        ("seeds: [1]\nreplicates: 4\n", "design.yaml, line 2, replicates: `seeds` already lists the seeds. "),
        ("base: {robots_from: ros}\n", "robots_from: a sweep supports only simulated robots. Write sim."),
        ("base: {robots_from: ros2}\n", "robots_from: a sweep supports only simulated robots. Write sim."),
        ("base: {external_nodes: both}\n", "external_nodes: the robots of a sweep cannot use external ROS nodes."),
        (
            "base: {game.energy: 20, game: {energy: 30}}\n",
            "design.yaml, line 1, game.energy: written twice. Keep one of the two.",
        ),
        (
            "base: {game: {energy: 20}}\nfactors: {game: [{energy: 10}, {energy: 30}]}\n",
            "design.yaml, line 2, game.energy: base and game both set this key. Delete the key in one of the two.",
        ),
        (
            "base: {robots: 3}\nfactors: {robots: [1, 2]}\n",
            "design.yaml, line 2, robots: base and robots both set this key. Delete the key in one of the two.",
        ),
        (
            "factors:\n  energy: {low: {game.energy: 9}, high: {game.energy: 99}}\n  game: {a: {game: {energy: 5}}}\n",
            "design.yaml, line 3, game.energy: energy and game both set this key.",
        ),
        ("replicates: 100000000\n", "replicates: 100000000 games, but a sweep may have at most 10000000. "),
        ("study: none.yaml\n", "none.yaml: there is no such file. Check the name and the folder."),
    ],
)
def test_faults_name_place_and_remedy(text: str, told: str, tmp_path: Path) -> None:
    assert told in fault(tmp_path, text)


def test_faults_of_several_conditions_are_told_together(tmp_path: Path) -> None:
    told = fault(tmp_path, "factors:\n  game.energy:\n    - 10\n    - -1\n    - lots\n")
    assert "line 4, game.energy" in told
    assert "line 5, game.energy" in told
