import dataclasses
import shutil
from pathlib import Path

import pytest

from sim.team import Team
from thbridge.app.compose.game import build_briefing
from thbridge.app.compose.recording import build_writer
from thbridge.app.compose.robots import REHEARSERS, build_simr, rehearse
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.dialogue.wording.lines import LineKey
from thbridge.files.errors import BadFile
from thbridge.files.game_files import SHIPPED_GAMES
from thbridge.files.resources import shipped
from thbridge.files.yaml.load import Loaded
from thbridge.recording.bag.options import DefinitionTexts
from thbridge.recording.bag.reading.reader import recorded
from thbridge.roles.shared.notices import Subscribe
from thbridge.ros.messages.types import STRING
from thbridge.ros.topics import RosMessage, Topic
from thbridge.study.study_file import (
    CostModel,
    GameSection,
    ParticipantSection,
    RecordingSection,
    ShowsSection,
    Study,
    load_study,
)
from thbridge.text_protocol.wire.notice_format import encode_notice


@pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
def test_a_rehearsal_is_long_enough_for_robots_to_drive(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Whatever it does not come to is compiled in the midst of a session, and holds it up for seconds.
    setting = read_setting(dataclasses.replace(Study(), map=name, robots=2), Path())
    team = rehearsed(setting, monkeypatch)
    # Turning on the spot does not need all of the local planner.
    assert (team.step([]).world.twists[:, 0] > 0.2).all()


def test_of_a_large_team_only_some_rehearse_and_whoever_has_software_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    own = dataclasses.replace(Study().robot, localization="truth")
    setting = read_setting(dataclasses.replace(Study(), map="warehouse12", robots=14, each={2: own, 13: own}), Path())
    monkeypatch.setattr("thbridge.app.compose.robots.REHEARSAL", 1)
    software = [parameters.localization for parameters in rehearsed(setting, monkeypatch).parameters]
    assert software == ["amcl", "truth", *["amcl"] * (REHEARSERS - 2), "truth"]


def rehearsed(setting: StudySetting, monkeypatch: pytest.MonkeyPatch) -> Team:
    """The team of a rehearsal, after it."""
    teams: list[Team] = []

    def made(*arguments: object, **named: object) -> Team:
        teams.append(Team(*arguments, **named))  # type: ignore[arg-type]
        return teams[0]

    monkeypatch.setattr("thbridge.app.compose.robots.Team", made)
    rehearse(setting)
    return teams[0]


@pytest.mark.parametrize("texts", DefinitionTexts)
def test_bags_have_the_texts_of_an_installed_ros_only_where_the_study_says_so(
    texts: DefinitionTexts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "std_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "std_msgs" / "msg" / "String.msg").write_text("# said\nstring data\n")
    monkeypatch.setattr("thbridge.app.compose.recording.ROS_SHARES", (tmp_path,))
    study = dataclasses.replace(Study(), recording=RecordingSection(definitions=texts))
    with build_writer(read_setting(study, Path()), tmp_path / "a.bag") as writer:
        writer.write(RosMessage(Topic("/said", STRING), 1_000_000_000, bytes(4)))
    ((publisher, _, _),) = recorded(tmp_path / "a.bag")
    assert publisher.definition == ("string data\n" if texts is DefinitionTexts.OWN else "# said\nstring data\n")


def test_participants_are_briefed_with_the_study_s_map_pictures_and_consent(tmp_path: Path) -> None:
    (tmp_path / "terms.txt").write_text("\ufeffWe record you.\n", encoding="utf-8")
    participant = ParticipantSection(consent=Path("terms.txt"))
    briefing = build_briefing(read_setting(dataclasses.replace(Study(), participant=participant), tmp_path))
    assert briefing.consent == "We record you."
    assert briefing.names == ("Blue Bottle", "Orange Bottle", "Pink can", "Yellow can")
    assert {name: data[:3] for name, data in briefing.pictures.items()} == {
        f"rsz_t{number}.jpg": b"\xff\xd8\xff" for number in range(1, 5)
    }
    assert briefing.floor_plan is not None
    assert [room.room for room in briefing.floor_plan.rooms] == list(range(1, 9))
    assert build_briefing(read_setting(Study(), Path())).consent is None


def test_participants_are_told_points_answers_and_a_farewell_as_the_study_says(tmp_path: Path) -> None:
    told = build_briefing(read_setting(Study(), Path()))
    assert told.worth == (20, 10, 30, 20)
    assert (told.answers, told.farewell, told.sound) == (True, "", True)
    (tmp_path / "bye.txt").write_text("Thanks.\nPlease ring.\n", encoding="utf-8")
    participant = ParticipantSection(
        sound=False, farewell=Path("bye.txt"), shows=ShowsSection(points=False, answers=False)
    )
    silent = build_briefing(read_setting(Study(participant=participant), tmp_path))
    assert (silent.worth, silent.answers, silent.farewell, silent.sound) == ((), False, "Thanks.\nPlease ring.", False)


@pytest.mark.parametrize("truth", [False, True])
def test_the_truth_about_robots_is_told_only_where_the_study_says_so(truth: bool) -> None:
    participant = ParticipantSection(shows=ShowsSection(truth=truth, uncertainty=truth, way=truth))
    simr = build_simr(read_setting(dataclasses.replace(Study(), participant=participant), Path()))
    subscribed = encode_notice("Window", simr.name, Subscribe())
    said = [message.line() for tick in range(10) for message in simr.step(tick, [subscribed] if tick == 0 else [])]
    told = [line for line in said if "SimR Window" in line]
    assert told
    for word in ('truth":[', 'ellipses":[', "Ways"):
        assert any(word in line for line in told) == truth


OF_2016, MEASURED = (17.0, 14.0, 17.0), (20.0, 16.0, 19.0)
"""Energy from the corridor of arena8 to its first rooms: the matrix of 2016, and the map's own."""


@pytest.mark.parametrize(
    ("templates", "game", "costs", "by_position"),
    [
        ("original-2016", GameSection(), OF_2016, False),
        ("original-2016", GameSection(cost_model=CostModel.POSITION), MEASURED, True),
        ("original-2016", GameSection(cost_model=CostModel.MATRIX), OF_2016, False),
        ("sklar-azhar-2015", GameSection(), MEASURED, True),
        ("everyday-things", GameSection(), MEASURED, True),
        ("sklar-azhar-2015", GameSection(cost_model=CostModel.MATRIX), MEASURED, False),
        ("sklar-azhar-2015", GameSection(costs=Path("original-2016")), OF_2016, False),
        ("sklar-azhar-2015", GameSection(costs=Path("my.times"), cost_model=CostModel.POSITION), OF_2016, True),
    ],
)
def test_the_matrix_of_2016_is_the_default_of_its_templates_alone_and_one_key_away(
    templates: str, game: GameSection, costs: tuple[float, ...], by_position: bool, tmp_path: Path
) -> None:
    shutil.copy(shipped().root / "templates" / "original-2016" / "mapTimes", tmp_path / "my.times")
    setting = read_setting(Study(templates=templates, game=game), tmp_path)
    assert setting.costs.rows[0][1:4] == costs
    assert setting.by_position is by_position


def test_a_set_without_costs_is_played_by_those_of_the_map_that_its_set_yaml_names(tmp_path: Path) -> None:
    shutil.copytree(shipped().root / "templates" / "original-2016", tmp_path / "set")
    (tmp_path / "set" / "mapTimes").unlink()
    setting = read_setting(Study(templates="./set"), tmp_path)
    assert setting.costs.rows[0][1:4] == MEASURED
    assert setting.by_position


def test_moves_without_any_costs_are_told_with_the_folder_and_the_remedy(tmp_path: Path) -> None:
    shutil.copytree(shipped().root / "maps" / "arena8", tmp_path / "map")
    (tmp_path / "map" / "mapTimes").unlink()
    told = r"sklar-azhar-2015/mapTimes: moves have no costs, because neither .*`thbridge maps measure .*/map --out "
    with pytest.raises(BadFile, match=told):
        read_setting(Study(map="./map", templates="sklar-azhar-2015"), tmp_path)


def test_moves_on_a_map_are_not_priced_by_a_set_for_another_map(tmp_path: Path) -> None:
    shutil.copytree(shipped().root / "maps" / "arena8", tmp_path / "mine")
    (tmp_path / "mine" / "mapTimes").unlink()
    study = Study(map="./mine", templates="original-2016")
    with pytest.raises(BadFile, match=r"original-2016/mapTimes: these costs are for the map arena8, and "):
        read_setting(study, tmp_path)
    asked_for = dataclasses.replace(study, game=GameSection(costs=Path("original-2016")))
    assert read_setting(asked_for, tmp_path).costs.rows[0][1:4] == OF_2016


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A building of a lab, of as many rooms as arena8, without times."""
    shutil.copytree(shipped().root / "maps" / "office", tmp_path / "mine", ignore=shutil.ignore_patterns("mapTimes"))
    return tmp_path / "mine"


def test_another_map_with_the_name_of_ours_is_not_priced_as_ours(mine: Path, tmp_path: Path) -> None:
    mine.rename(tmp_path / "arena8")
    with pytest.raises(
        BadFile, match="these costs are for the built-in map arena8, but the study has another map of this name"
    ):
        read_setting(Study(map="./arena8", templates="original-2016"), tmp_path)


def test_a_copy_of_our_map_is_priced_as_ours(tmp_path: Path) -> None:
    shutil.copytree(shipped().root / "maps" / "arena8", tmp_path / "arena8")
    setting = read_setting(Study(map="./arena8", templates="original-2016"), tmp_path)
    assert (setting.costs.rows[0][1:4], setting.doubts) == (OF_2016, ())


def test_prices_that_are_named_for_another_map_are_used_with_a_warning(mine: Path, tmp_path: Path) -> None:
    setting = read_setting(Study(map=f"./{mine.name}", game=GameSection(costs=Path("original-2016"))), tmp_path)
    (doubt,) = setting.doubts
    assert "the costs of moves on the map mine come from this file for the map arena8" in str(doubt)


def test_times_of_another_map_copied_into_a_map_are_used_with_a_warning(mine: Path, tmp_path: Path) -> None:
    shutil.copy(shipped().root / "maps" / "arena8" / "mapTimes", mine)
    (doubt,) = read_setting(Study(map="./mine"), tmp_path).doubts
    assert "trips take less time than the study's robots need: " in str(doubt)


@pytest.mark.parametrize("name", ["arena8", "warehouse12", "office", "practice"])
def test_times_that_were_measured_on_a_map_are_used_without(name: str, tmp_path: Path) -> None:
    assert read_setting(Study(map=name, robots=1), tmp_path).doubts == ()


def test_a_set_that_names_no_map_has_prices_for_any_with_a_warning(tmp_path: Path) -> None:
    shutil.copytree(shipped().root / "maps" / "arena8", tmp_path / "mine")
    (tmp_path / "mine" / "mapTimes").unlink()
    shutil.copytree(shipped().root / "templates" / "original-2016", tmp_path / "set")
    (tmp_path / "set" / "set.yaml").write_text("language: en\n")
    setting = read_setting(Study(map="./mine", templates="./set"), tmp_path)
    assert setting.costs.rows[0][1:4] == OF_2016
    (doubt,) = setting.doubts
    assert "set.yaml does not name the file's map. If the file is for this map, write `map: mine` into" in str(doubt)


def test_dialogue_games_of_a_study_are_checked_before_anything_starts(tmp_path: Path) -> None:
    written = load_study_text(tmp_path, "dialogue: {games: games}\n")
    with pytest.raises(BadFile, match=r"study\.yaml, line 1, dialogue\.games: .*there is no such folder"):
        read_setting(written.value, tmp_path, written=written)
    shutil.copytree(SHIPPED_GAMES, tmp_path / "games")
    read_setting(written.value, tmp_path, written=written)
    game = tmp_path / "games" / "persuasion.yaml"
    game.write_text(game.read_text().replace("next: countered", "next: counterd"))
    with pytest.raises(BadFile, match=r"games/persuasion\.yaml, line 15, .*The nearest name is countered"):
        read_setting(written.value, tmp_path, written=written)


def test_words_of_a_study_are_checked_before_anything_starts(tmp_path: Path) -> None:
    written = load_study_text(tmp_path, "dialogue: {language: nl, words: words}\n")
    with pytest.raises(BadFile, match=r"study\.yaml, line 1, dialogue\.words: .*there is no such folder"):
        read_setting(written.value, tmp_path, written=written)
    language = tmp_path / "words" / "nl" / "ours.yaml"
    language.parent.mkdir(parents=True)
    language.write_text("language: {title: Nederlands, falls_back_on: en}\nlines: [{key: back, say: [Terug.]}]\n")
    setting = read_setting(written.value, tmp_path, written=written)
    assert setting.language.line(LineKey.BACK) == ("Terug.",)
    language.write_text(language.read_text().replace("key: back", "key: bakc"))
    with pytest.raises(BadFile, match=r"words/nl/ours\.yaml, line 2, lines\[0\]\.key: .*The nearest name is back"):
        read_setting(written.value, tmp_path, written=written)
    language.write_text("lines: []\n")
    language.rename(language.parent.parent / "ours.yaml")
    with pytest.raises(BadFile, match=r"dialogue\.words: .*this folder has no language"):
        read_setting(written.value, tmp_path, written=written)


def test_a_language_that_is_not_there_is_told_with_the_line_of_the_study(tmp_path: Path) -> None:
    written = load_study_text(tmp_path, "dialogue:\n  language: dee\n")
    told = r"study\.yaml, line 2, dialogue\.language: .*language dee does not exist\. The nearest name is de"
    with pytest.raises(BadFile, match=told):
        read_setting(written.value, tmp_path, written=written)


def load_study_text(folder: Path, text: str) -> Loaded[Study]:
    path = folder / "study.yaml"
    path.write_text(text)
    return load_study(path)
