"""Studies of `thbridge.api`: keys, checks, and what is told."""

from pathlib import Path

import pytest

from thbridge import api


def test_keys_win_over_the_file_and_the_rest_of_it_stays(tmp_path: Path) -> None:
    (tmp_path / "hunt.yaml").write_text("robots: 3\nseed: 8\ngame:\n  energy: 50\n  picture_cost: 2\n")
    study = api.HuntStudy(tmp_path / "hunt.yaml", {"game.energy": 70}, robots=2)
    assert (study.robots, study.seed) == (2, 8)
    text = study.yaml()
    assert "  energy: 70.0\n" in text and "  picture_cost: 2.0\n" in text


def test_a_built_in_study_is_named_and_what_is_left_out_is_as_in_2016() -> None:
    assert "\ntemplates: everyday-things\n" in api.HuntStudy("standard", robots=3).yaml()
    assert api.HuntStudy().yaml() == api.HuntStudy("original-2016").yaml()


def test_the_text_of_a_study_is_a_file_of_the_same_study(tmp_path: Path) -> None:
    study = api.HuntStudy(robots=2, things=[{"name": "crate", "shape": "crate", "at": [0.0, 0.0, 0.0]}])
    (tmp_path / "same.yaml").write_text(study.yaml())
    assert api.HuntStudy(tmp_path / "same.yaml").yaml() == study.yaml()


def test_another_seed_changes_nothing_else() -> None:
    study = api.HuntStudy(robots=2)
    assert study.changed(seed=5).yaml() == api.HuntStudy(robots=2, seed=5).yaml()
    assert study.changed(seed=5, robots=3).robots == 3


@pytest.mark.parametrize(
    ("text", "keys", "told", "line", "key"),
    [
        ("robots: 2\nseeed: 3\n", {}, "seeed: unknown key. The nearest name is seed.", 2, "seeed"),
        ("robots: 2\n", {"seed": -1}, "changes, line 1, seed: ", 1, "seed"),
        ("robots: 2\nmap: nowhere\n", {}, "no map has this name", 2, "map"),
        ("robots_from: ros\n", {}, "robots_from: this study is for real robots", None, "robots_from"),
        ("robots_from: ros2\n", {}, "robots_from: this study is for real robots", None, "robots_from"),
        ("external_nodes: both\n", {}, "external_nodes: other ROS nodes drive these robots", None, "external_nodes"),
    ],
)
def test_a_fault_names_file_line_key_and_remedy(
    tmp_path: Path, text: str, keys: dict[str, int], told: str, line: int | None, key: str
) -> None:
    (tmp_path / "hunt.yaml").write_text(text)
    with pytest.raises(api.HuntError) as caught:
        api.HuntStudy(tmp_path / "hunt.yaml", **keys)
    assert told in str(caught.value)
    assert (caught.value.line, caught.value.key) == (line, key)


def test_prices_of_another_map_are_warned_of() -> None:
    with pytest.warns(api.HuntWarning, match="on the map office come from this file for the map arena8"):
        api.HuntStudy(map="office", game={"costs": "original-2016"})


def test_all_faults_of_a_file_are_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "hunt.yaml").write_text("seed: -1\nrobots: 0\n")
    with pytest.raises(api.HuntError) as caught:
        api.HuntStudy(tmp_path / "hunt.yaml")
    assert len(str(caught.value).splitlines()) == 2


def test_a_file_that_is_not_there_is_told() -> None:
    with pytest.raises(api.HuntError, match=r"^nowhere\.yaml: there is no such file"):
        api.HuntStudy("nowhere.yaml")
