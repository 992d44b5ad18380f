import dataclasses
import difflib
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.project import ROOT
from thbridge.files.game_files import SHIPPED_GAMES
from thbridge.files.yaml.tree import parse
from thbridge.hunt.refusals import RequestRefused
from thbridge.study.noise import NoisePreset, noise_section_of, preset, value_at, with_value
from thbridge.study.study_file import Study, load_study_tree, study_before
from thbridge.study.text import as_yaml, commented_study
from ui.model.study_form.draft import HEADER, StudyDraft, UndoHistory, draft_of, search_fields
from ui.model.study_form.form import FieldKind, FormField, editable_text, form_of, hint_of, typed_as_yaml
from ui.model.study_form.noise import noise_from_form, preview_of
from ui.model.study_form.resources import is_named, is_path, resources_for

PATH = Path("study.yaml")
WRITTEN = """\
# our pilot
robots: 4   # two pairs
noise:
  preset: turtlebot2
  odometry: {alpha1: 0.05}
robot:
  local_costmap: {obstacle_range: 2.2}  # ROS's old place
  TrajectoryPlannerROS:
    pdist_scale: 0.3
each:
  2: {localization: ekf}
things:
  - {name: crate, shape: crate, at: [1, 2, 0]}
world:
  odometry: {alpha2: 0.07}
"""


def quick(text: str) -> StudyDraft:
    """A draft as `draft_of` makes it, without what the study names being read."""
    tree = parse(PATH, text)
    study = load_study_tree(PATH, tree).value
    return StudyDraft(PATH, text, tree, form_of(text, tree, study_before(PATH, tree)), study, (), ())


def text_of(outcome: str | RequestRefused) -> str:
    assert isinstance(outcome, str), outcome
    return outcome


def test_every_parameter_of_a_study_is_a_field_with_words() -> None:
    fields = quick("").fields()
    assert {"robots", "game.energy", "robot.amcl.kld_err", "noise.odometry.alpha1", "fleet.robot.odom"} <= set(fields)
    assert all(field.help and field.written is None for field in fields.values())
    field = fields["robot.amcl.kld_err"]
    assert (field.kind, field.minimum, field.maximum, field.default) == (FieldKind.NUMBER, 0, 1, "0.05")
    assert fields["robot.localization"].choices == ("amcl", "ekf", "ukf", "truth", "fake_localization")
    assert hint_of(fields["rate"]) == "0 to 1000, or null"


def test_a_field_knows_what_is_written_and_where() -> None:
    fields = quick(WRITTEN).fields()
    assert (fields["robots"].written, fields["robots"].line) == ("4", 2)
    assert fields["noise.odometry.alpha2"].place == "world.odometry.alpha2"
    assert fields["robot.TrajectoryPlannerROS.path_distance_bias"].place == "robot.TrajectoryPlannerROS.pdist_scale"
    moved = fields["robot.local_costmap.obstacle_layer.obstacle_range"]
    assert (moved.place, moved.value) == ("robot.local_costmap.obstacle_range", "2.2")


def test_defaults_are_those_of_presets_and_of_all_robots() -> None:
    fields = quick(WRITTEN).fields()
    assert fields["noise.odometry.linear_scale"].default == "1.005"
    assert fields["each.2.TrajectoryPlannerROS.path_distance_bias"].default == "0.3"
    assert fields["each.2.amcl.odom_alpha1"].default == "0.2"


def test_the_commented_file_and_a_new_one_show_the_same_values() -> None:
    all_written, none_written = quick(commented_study()).fields(), quick(HEADER).fields()
    assert {key: editable_text(field) for key, field in all_written.items()} == {
        key: editable_text(field) for key, field in none_written.items()
    }


EDITED = quick(WRITTEN).fields()
KEYS = sorted(
    key
    for key, field in EDITED.items()
    if field.kind in {FieldKind.NUMBER, FieldKind.INTEGER, FieldKind.BOOLEAN, FieldKind.CHOICE}
)


@st.composite
def changes(draw: st.DrawFn) -> tuple[str, str]:
    """A field and something that may stand in it."""
    key = draw(st.sampled_from(KEYS))
    field = EDITED[key]
    if field.kind is FieldKind.CHOICE:
        return key, draw(st.sampled_from(field.choices))
    if field.kind is FieldKind.BOOLEAN:
        return key, draw(st.sampled_from(["true", "false"]))
    low, high = max(field.minimum, -1e6), min(field.maximum, 1e6)
    if field.kind is FieldKind.INTEGER:
        return key, str(draw(st.integers(round(low), round(high))))
    return key, repr(draw(st.floats(low, high, allow_nan=False)))


HELD_APART = {"robots", "seed", "world.laser.rate", "world.laser.range_min", "world.laser.range_max"}


@settings(max_examples=30)
@given(st.lists(changes(), max_size=3), st.sampled_from([WRITTEN, WRITTEN.replace("\n", "\r\n"), "", HEADER]))
def test_a_changed_file_means_what_was_wished_and_keeps_all_other_lines(
    wished: list[tuple[str, str]], text: str
) -> None:
    tree = parse(PATH, text)
    for key, typed in wished:
        form = form_of(text, tree, study_before(PATH, tree))
        fields = {field.key: field for field in form.all_fields()}
        if key not in fields:
            continue
        field = fields[key]
        draft = StudyDraft(PATH, text, tree, form, None, (), ())
        before, text = text, text_of(draft.set(field, typed))
        tree = parse(PATH, text)
        after = {field.key: field for field in form_of(text, tree, study_before(PATH, tree)).all_fields()}
        assert as_number(editable_text(after[key])) == as_number(typed)
        untouched(before, text, field)
        for other, was in fields.items():
            # A preset changes defaults, and so does what all robots have; what is written stays.
            if other != key and was.place != field.place and was.written is not None:
                assert after[other].written == was.written


def untouched(before: str, after: str, field: FormField) -> None:
    """All lines but the field's own are there, to the byte and in order."""
    lines = before.splitlines(keepends=True)
    codes = difflib.SequenceMatcher(None, lines, after.splitlines(keepends=True), autojunk=False).get_opcodes()
    lost = [line + 1 for code in codes if code[0] in {"replace", "delete"} for line in range(code[1], code[2])]
    # A section in brackets takes a new key into its own line.
    assert lost in ([], [field.line]) or (len(lost) == 1 and "{" in lines[lost[0] - 1])


def as_number(typed: str) -> float | str:
    try:
        return float(typed)
    except ValueError:
        return typed


@settings(max_examples=30)
@given(changes())
def test_resetting_takes_back_just_what_was_set(change: tuple[str, str]) -> None:
    key, typed = change
    draft = quick("robots: 2\n# end\n")
    if key not in draft.fields():
        return
    was = draft.fields()[key]
    changed = text_of(draft.set(was, typed))
    if changed == draft.text or was.written is not None:
        return
    tree = parse(PATH, changed)
    form = form_of(changed, tree, study_before(PATH, tree))
    field = next(field for field in form.all_fields() if field.key == key)
    assert text_of(StudyDraft(PATH, changed, tree, form, None, (), ()).reset(field)) == draft.text


def test_typing_nothing_resets_a_number() -> None:
    draft = quick("robots: 3\nseed: 1\n")
    assert draft.set(draft.fields()["robots"], " ") == "seed: 1\n"


def test_words_are_quoted_where_they_must_be() -> None:
    fields = quick("").fields()
    assert typed_as_yaml(fields["map"], "./my map: new") == '"./my map: new"'
    assert typed_as_yaml(fields["map"], "arena8") == "arena8"
    assert typed_as_yaml(fields["map"], "true") == '"true"'
    assert typed_as_yaml(fields["robots"], "#3") == '"#3"'
    assert typed_as_yaml(fields["rate"], "null") == "null"


def test_faults_are_told_at_their_fields() -> None:
    draft = draft_of(PATH, "robots: many\nworld: {laser: {rate: 7}}\nrobt: 1\n")
    assert draft.study is None
    assert [draft.field_of(fault) and draft.field_of(fault).key for fault in draft.faults] == ["robots", None]
    assert draft.faults_of(draft.fields()["robots"])[0].line == 1
    told_at_home = draft_of(PATH, "world: {odometry: {alpha1: -1}}\n")
    assert told_at_home.faults_of(told_at_home.fields()["noise.odometry.alpha1"])


def test_what_a_study_names_is_checked_too() -> None:
    draft = draft_of(PATH, "map: nowhere\n")
    assert len(draft.faults) == 1
    assert "nowhere" in str(draft.faults[0])


def test_paths_start_from_the_files_folder(tmp_path: Path) -> None:
    (tmp_path / "amcl.yaml").write_text("amcl: {kld_err: 0.02}\n")
    draft = draft_of(tmp_path / "study.yaml", "ros_parameters: [amcl.yaml]\n")
    assert draft.faults == ()
    assert draft.fields()["robot.amcl.kld_err"].default == "0.02"


def test_a_text_that_is_no_yaml_has_a_fault_with_its_line() -> None:
    draft = draft_of(PATH, "robots: 2\ngame: {\n")
    assert draft.tree is None
    assert draft.faults[0].line is not None


def test_items_are_added_and_removed() -> None:
    draft = quick("")
    one = quick(text_of(draft.add(draft.groups()["things"])))
    two = quick(text_of(one.add(one.groups()["things"])))
    assert [
        field.value for field in two.form.all_fields() if field.key.endswith(".name") and "things" in field.key
    ] == [
        '"thing 1"',
        '"thing 2"',
    ]
    again = quick(text_of(two.remove(two.groups()["things[0]"])))
    assert again.study is not None
    assert [thing.name for thing in again.study.things] == ["thing 2"]
    assert quick(text_of(draft.add(draft.groups()["mishaps"]))).study != Study()


def test_a_robot_gets_software_of_its_own() -> None:
    draft = quick("robots: 3\n")
    own = quick(text_of(draft.add(draft.groups()["each"], 3)))
    changed = quick(text_of(own.set(own.fields()["each.3.localization"], "ekf")))
    assert changed.study is not None
    assert changed.study.software(3).localization == "ekf"
    assert changed.study.software(1).localization == "amcl"


@pytest.mark.parametrize("words", ["kld_err", "kld err", "maximum error between", "KLD_ERR", "amcl kld"])
def test_search_finds_by_name_and_by_meaning(words: str) -> None:
    assert "robot.amcl.kld_err" in [field.key for field in search_fields(quick("").form.all_fields(), words)]


def test_search_puts_exact_names_first_and_knows_old_ones() -> None:
    form = quick(WRITTEN).form
    assert search_fields(form.all_fields(), "alpha1")[0].key == "noise.odometry.alpha1"
    assert search_fields(form.all_fields(), "pdist_scale")[0].key == "robot.TrajectoryPlannerROS.path_distance_bias"
    assert [field.key for field in search_fields(quick("").form.all_fields(), "pdist")] == [
        "robot.TrajectoryPlannerROS.path_distance_bias"
    ]
    assert search_fields(form.all_fields(), "  ") == ()


def test_history_goes_back_and_forth_and_takes_typing_together() -> None:
    history = UndoHistory("a").changed("ab", "k").changed("abc", "k")
    assert history.undone().text == "a"
    assert history.undone().redone() == dataclasses.replace(history, key="")
    apart = UndoHistory("a").changed("ab", "k").settled().changed("abc", "k")
    assert apart.undone().text == "ab"
    assert history.undone().changed("x").redone().text == "x"


def test_as_it_stands_the_value_of_a_field_is_the_loaders() -> None:
    draft = quick(commented_study())
    for key in ("robots", "world.footprint", "robot.amcl.min_particles", "fleet.robot.recorded"):
        assert draft.fields()[key].value == as_yaml(value_at(draft.study, key))


def test_noise_is_what_is_typed_before_it_is_in_the_file() -> None:
    draft = quick("noise: {odometry: {alpha1: 0.3}}\n")
    fields = list(draft.groups()["noise"].all_fields())
    typing = noise_from_form(fields, {"noise.odometry.alpha2": "0.4", "noise.laser.dropout": "much"})
    assert (typing.odometry.alpha1, typing.odometry.alpha2, typing.laser.dropout) == (0.3, 0.4, 0.005)
    chosen = noise_from_form(fields, {"noise.preset": "bad wheels"})
    assert (chosen.odometry.alpha1, chosen.odometry.alpha2, chosen.odometry.angular_scale) == (0.3, 0.1, 1.1)


def test_a_verdict_tells_a_belief_that_fits_from_one_that_does_not() -> None:
    quiet = preview_of(Study(), preset(NoisePreset.PERFECT, noise_section_of(Study())))
    assert "too little noise" not in quiet.straight.verdict
    sure = noise_from_form([], {})
    sure = with_value(with_value(sure, "believed.amcl.odom_alpha2", 0.0), "believed.amcl.odom_alpha1", 0.0)
    assert "too little noise" in preview_of(Study(), with_value(sure, "odometry.alpha2", 0.5)).straight.verdict


def named(key: str, beside: Path, text: str = "") -> dict[str, str]:
    return {each.value: each.words for each in resources_for(key, draft_of(beside / "study.yaml", text))}


class TestWhatADialogueMayName:
    """Shipped ones, folders beside the study, and programs that are installed."""

    @pytest.fixture(autouse=True)
    def beside(self, tmp_path: Path) -> None:
        games = tmp_path / "games"
        (games / "nl").mkdir(parents=True)
        brief = (SHIPPED_GAMES / "persuasion-in-brief.yaml").read_text()
        (games / "mine.yaml").write_text(brief.replace("name: persuasion-in-brief", "name: haggling"))
        (games / "nl" / "dutch.yaml").write_text("language: {title: Nederlands, falls_back_on: en}\n")
        (tmp_path / "broken" / "en").mkdir(parents=True)
        (tmp_path / "broken" / "a.yaml").write_text("name: haggling\nstages: []\n")
        (tmp_path / "broken" / "en" / "a.yaml").write_text("lines: [{key: nothing, say: [Hello]}]\n")
        shutil.copytree(ROOT / "maps" / "practice", tmp_path / "maps" / "practice")
        shutil.copytree(ROOT / "templates" / "practice", tmp_path / "templates")

    def test_folders_of_games_and_of_words_and_no_others(self, tmp_path: Path) -> None:
        assert named("dialogue.games", tmp_path) == {
            "./broken": "has faults",
            "./games": "dialogue games: haggling",
        }
        assert named("dialogue.words", tmp_path) == {"./broken": "has faults", "./games": "nl: Nederlands"}

    def test_languages_that_come_with_the_project_and_those_of_the_studys_words(self, tmp_path: Path) -> None:
        shipped = {"de": "Deutsch", "en": "English"}
        assert named("dialogue.language", tmp_path) == shipped
        own = {**shipped, "nl": "Nederlands, with words from the folder games"}
        assert named("dialogue.language", tmp_path, "dialogue: {words: ./games}") == own
        assert list(own) == list(named("dialogue.language", tmp_path, "dialogue: {words: ./games}"))
        assert named("dialogue.language", tmp_path, "dialogue: {words: ./missing}") == shipped
        assert named("dialogue.language", tmp_path, "dialogue: {words: broken}")["en"] == "has faults"

    def test_programs_that_are_installed_and_are_not_loaded_for_it(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        own = {"manner": "the built-in strategy of robots, according to their manner"}
        assert named("dialogue.strategy", tmp_path) == own
        assert named("dialogue.author", tmp_path) == {}
        folder = tmp_path / "lab_of_forms-1.0.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-forms\nVersion: 1.0\n")
        (folder / "entry_points.txt").write_text(
            "[thbridge.wordings]\npolite = no_such_module:polite\n[thbridge.strategies]\nhard = no_such_module:Hard\n"
            "[thbridge.participants]\nmodel = no_such_module:Model\n"
        )
        monkeypatch.syspath_prepend(str(tmp_path))
        told = "of the package lab-of-forms 1.0"
        assert named("dialogue.author", tmp_path) == {"polite": f"no_such_module:polite, {told}"}
        for key in ("dialogue.strategy", "dialogue.manner.strategy", "dialogue.each.2.strategy"):
            assert is_named(key) and not is_path(key)
            assert named(key, tmp_path) == {**own, "hard": f"no_such_module:Hard, {told}"}
        choices = draft_of(tmp_path / "study.yaml", "").fields()["participant.strategy"].choices
        assert choices == ("suggestion", "nearest", "random", "model")

    @pytest.mark.parametrize("key", ["dialogue.games", "dialogue.words", "dialogue.language", "dialogue.strategy"])
    def test_what_is_offered_is_right_in_the_study(self, tmp_path: Path, key: str) -> None:
        shutil.rmtree(tmp_path / "broken")
        start = "dialogue: {condition: adviser}"
        for value in named(key, tmp_path, start):
            draft = draft_of(tmp_path / "study.yaml", start)
            text = draft.set(draft.fields()[key], value)
            assert isinstance(text, str)
            assert draft_of(draft.path, text).faults == ()
