import dataclasses
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.parameters import OdometryNoise, RobotParameters, WorldParameters
from thbridge.files.disk.inside import fault_of_path
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.load import load_text
from thbridge.files.yaml.tree import parse
from thbridge.recording.bag.options import Compression, DefinitionTexts, RecordingDetail, SplitLimits
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.study.built_in import STANDARD
from thbridge.study.noise import NoisePreset
from thbridge.study.study_file import (
    GameSection,
    ParticipantSection,
    ShowsSection,
    Study,
    load_study,
    load_study_tree,
    read_study_text,
)
from thbridge.study.text import commented_study, resolved

STUDY = Path("study.yaml")


def refusal(text: str) -> str:
    with pytest.raises(BadFile) as caught:
        read_study_text(STUDY, text)
    return str(caught.value)


class TestDefaults:
    def test_an_empty_file_is_the_default_study(self) -> None:
        assert read_study_text(STUDY, "") == Study()
        assert read_study_text(STUDY, "# only words\n") == Study()

    def test_a_section_whose_lines_are_all_commented_out_keeps_its_defaults(self) -> None:
        assert read_study_text(STUDY, "game:\n  # energy: 5\nrobots: 3\n") == Study(robots=3)

    def test_the_defaults_are_those_of_2016(self) -> None:
        study = Study()
        assert (study.map, study.game.energy, study.server.port) == ("arena8", 100.0, 6009)
        planner = study.robot.TrajectoryPlannerROS
        assert (planner.max_vel_x, planner.min_vel_x) == (1.0, 0.1)
        assert (planner.path_distance_bias, planner.goal_distance_bias) == (0.8, 0.6)
        assert study.robot.global_costmap.inflation_layer.inflation_radius == 0.5

    def test_every_field_tells_its_meaning(self) -> None:
        def check(section: type) -> None:
            for field in dataclasses.fields(section):
                assert field.metadata.get("help"), f"{section.__name__}.{field.name} has no help"
                value = getattr(section(), field.name)
                if dataclasses.is_dataclass(value):
                    check(type(value))

        check(Study)


class TestRoundTrip:
    def test_the_commented_file_is_the_standard_study_and_names_every_field(self) -> None:
        text = commented_study()
        assert read_study_text(STUDY, text) == STANDARD
        assert "  # energy of each robot at the start of the game [0.01 to 1000000]\n  energy: 100.0\n" in text
        assert "    # maximum forward velocity [0 to 20 m/s]\n    max_vel_x: 1.0\n" in text
        assert "truth and fake_localization are the same [amcl, ekf, ukf, truth or fake_localization]" in text

    @given(
        # Paths that no file can have are refused.
        st.text(st.characters(codec="utf-8"), min_size=1).filter(lambda name: not fault_of_path(name)),
        st.floats(0.01, 1e6),
        st.integers(0, 2**31 - 1),
        st.sampled_from(["amcl", "ekf", "ukf", "truth"]),
    )
    def test_a_resolved_study_reads_back_equal(self, name: str, energy: float, seed: int, localization: str) -> None:
        study = Study(
            map=name,
            seed=seed,
            game=GameSection(energy=energy, costs=Path(name)),
            robot=replace(RobotParameters(), localization=localization),
        )
        assert read_study_text(STUDY, resolved(study)) == study

    def test_a_resolved_study_has_every_key(self) -> None:
        text = resolved(Study())
        assert "map: arena8\n" in text
        assert "  footprint: [[0.25, 0.25], [-0.25, 0.25], [-0.25, -0.25], [0.25, -0.25], [0.35, 0.0]]\n" in text
        assert "#" not in text

    def test_words_that_yaml_takes_for_truth_stay_text(self) -> None:
        assert read_study_text(STUDY, "map: no\n").map == "no"
        assert read_study_text(STUDY, resolved(Study(map="no"))).map == "no"
        assert read_study_text(STUDY, resolved(Study(map="null"))).map == "null"


class TestValues:
    def test_numbers_in_the_ways_people_write_them(self) -> None:
        study = read_study_text(STUDY, "game: {energy: 1e3, picture_cost: 5, identify_cost: .5, wrong_share: 0}")
        assert (study.game.energy, study.game.picture_cost, study.game.identify_cost) == (1000.0, 5.0, 0.5)
        assert isinstance(study.game.picture_cost, float)

    def test_lists_of_points(self) -> None:
        text = "world:\n  footprint:\n  - [0.3, 0]\n  - [-0.2, 0.2]\n  - [-0.2, -0.2]\n"
        assert read_study_text(STUDY, text).world.footprint == ((0.3, 0.0), (-0.2, 0.2), (-0.2, -0.2))

    def test_what_participants_see_and_choose(self) -> None:
        assert Study().participant == ParticipantSection(BotStrategy.SUGGESTION, shows=ShowsSection(way=True))
        text = "participant: {consent: terms.txt, robots: [1, 4], shows: {way: false, uncertainty: true, truth: true}}"
        participant = read_study_text(STUDY, text).participant
        assert (participant.consent, participant.robots) == (Path("terms.txt"), (1, 4))
        assert participant.shows == ShowsSection(way=False, uncertainty=True, truth=True)
        assert read_study_text(STUDY, resolved(read_study_text(STUDY, text))).participant == participant

    def test_a_path_may_be_absent(self) -> None:
        assert read_study_text(STUDY, "game: {costs: null}").game.costs is None
        assert read_study_text(STUDY, "game: {costs: my/mapTimes}").game.costs == Path("my/mapTimes")


BROKEN = {
    "a misspelt key": (
        "game:\n  energie: 50\n",
        "study.yaml, line 2, game.energie: unknown key. The nearest name is energy.",
    ),
    "a key of another section": (
        "robots: 2\nmax_vel_theta: 1\n",
        "study.yaml, line 2, max_vel_theta: unknown key. "
        "This key belongs at world.max_vel_theta or robot.TrajectoryPlannerROS.max_vel_theta or"
        " robot.DWAPlannerROS.max_vel_theta.",
    ),
    "a key like no other": (
        "server: {quux: 1}",
        "study.yaml, line 1, server.quux: unknown key. Its keys are host, port, dialect, tell_refusals.",
    ),
    "a key twice": (
        "seed: 1\nrobots: 2\nseed: 2\n",
        "study.yaml, line 3, seed: this key is written twice, first in line 1. Keep one of the two.",
    ),
    "too large": (
        "robot:\n  TrajectoryPlannerROS:\n    max_vel_x: 25\n",
        "study.yaml, line 3, robot.TrajectoryPlannerROS.max_vel_x: 25 is out of range. Write a number, 0 to 20 m/s.",
    ),
    "too small": ("robots: 0", "study.yaml, line 1, robots: 0 is out of range. Write a whole number, 1 to 250."),
    "far too large": ("seed: 99999999999999999999", "line 1, seed: 99999999999999999999 is out of range."),
    "not whole": ("robots: 2.5", "study.yaml, line 1, robots: '2.5' is not a whole number."),
    "words for a number": ("robots: two", "study.yaml, line 1, robots: 'two' is not a number."),
    "a comma for a point": (
        "game:\n  wrong_share: 0,2\n",
        "study.yaml, line 2, game.wrong_share: '0,2' is not a number. Write a point: 0.2.",
    ),
    "a path as a key": (
        "game.energy: 50\n",
        "study.yaml, line 1, game.energy: unknown key. Write game: {energy: 50}.",
    ),
    "a longer path as a key": ("robot.amcl.kld_err: 0.1\n", "Write robot: {amcl: {kld_err: 0.1}}."),
    "no-break spaces": ("game:\n\u00a0energy: 5\n", "line 2: a no-break space in the indentation. Indent with blanks."),
    "a comma within braces": (
        "game: {wrong_share: 0,2}",
        "study.yaml, line 1, game.wrong_share: '0,2' is not a number. Write a point: 0.2.",
    ),
    "a comma within braces, of a whole number": (
        "game: {energy: 52,5}",
        "study.yaml, line 1, game.energy: '52,5' is not a number. Write a point: 52.5.",
    ),
    "a comma within braces, before another key": (
        "game: {energy: 52,5, picture_cost: 1}",
        "study.yaml, line 1, game.energy: '52,5' is not a number. Write a point: 52.5.",
    ),
    "a comma for thousands": ("seed: 1,000", "seed: '1,000' is not a number. Write the number without a comma."),
    "truth for a number": ("robots: true", "study.yaml, line 1, robots: 'true' is not a number."),
    "quotes": ("robots: '2'", "robots: '2' in quotes is text, not a number. Delete the quotes."),
    "infinite": ("game: {energy: .inf}", "game.energy: .inf is not a finite number."),
    "not a number": ("game: {energy: NaN}", "game.energy: NaN is not a finite number."),
    "overflow": ("game: {energy: 1e999}", "game.energy: 1e999 is out of range."),
    "octal": ("server: {port: 010}", "server.port: 010 begins with 0, which can mean octal."),
    "hexadecimal": ("server: {port: 0x10}", "server.port: '0x10' is not a number."),
    "yes for true": (
        "robot: {NavfnROS: {allow_unknown: yes}}",
        "robot.NavfnROS.allow_unknown: 'yes' is a word, not a truth value. Write true or false, without quotes.",
    ),
    "no such choice": (
        "participant: {strategy: nearset}",
        "participant.strategy: 'nearset' is not a valid choice. Write suggestion, nearest or random.",
    ),
    "no value": ("robots:\nseed: 1\n", "line 1, robots: no value. Write a whole number, 1 to 250, or delete the line."),
    "a value for a section": ("game: 5", "game: a section of 'key: value' lines is needed. Its keys are energy,"),
    "a list for a value": ("seed: [1]", "seed: a list is written where one value is needed. Write a whole number,"),
    "a value for a list": ("world: {footprint: 3}", "world.footprint: a list is needed."),
    "half a point": (
        "world:\n  footprint:\n  - [1, 2]\n  - [1]\n",
        "study.yaml, line 4, world.footprint[1]: 1 values where 2 are needed.",
    ),
    "a tab": ("game:\n\tenergy: 5\n", "study.yaml, line 2: a tab in the indentation. Indent with blanks."),
    "an open bracket": ("game: {energy: 5\nrobots: 3\n", "study.yaml, line 2: not YAML:"),
    "an anchor": ("game: &a {}\nserver: *a\n", "study.yaml, line 1, a: anchors and aliases (& and *) are not allowed"),
    "a tag": ("map: !!python/name:os.system\n", "study.yaml, line 1, tag:yaml.org,2002:python/name:os.system: tags"),
    "two documents": ("seed: 1\n---\nseed: 2\n", "study.yaml, line 2, ---: a second document begins."),
    "brackets without end": ("[" * 10000, "study.yaml, line 1: nested deeper than 32 levels."),
    "a control character": ("seed: 1\nmap: \x07\n", "line 2: this line has an invisible control character. Delete it."),
    "no section at all": ("- 1\n- 2\n", "study.yaml, line 1: a section of 'key: value' lines is needed."),
    "a section as a key": ("? {a: 1}\n: 2\n", "study.yaml, line 1: a list or section is used as a key."),
    "sweeps between the ticks": (
        "world:\n  laser:\n    rate: 15\n",
        "study.yaml, line 3, world.laser.rate: 15 is not a divisor of 50, the number of simulation steps per second. "
        "Write one of 1, 2, 5, 10, 25, 50.",
    ),
    "probabilities of error below 0": (
        "dialogue:\n  adviser_error_rate: 0.2\n  confidence_spread: 0.3\n",
        "study.yaml, line 3, dialogue.confidence_spread: the probability of a wrong suggestion would be -0.1 to 0.5. "
        "Write at most 0.2, or change adviser_error_rate.",
    ),
    "probabilities of error above 1": (
        "dialogue: {adviser_error_rate: 0.9, confidence_spread: 0.2}",
        "study.yaml, line 1, dialogue.confidence_spread: the probability of a wrong suggestion would be 0.7 to 1.1. "
        "Write at most 0.1, or change adviser_error_rate.",
    ),
    "a minimum above the default maximum": (
        "robot:\n  amcl:\n    min_particles: 2000\n",
        "study.yaml, line 3, robot.amcl.min_particles: 2000 is above robot.amcl.max_particles, which is 1000.",
    ),
    "a compression that the format does not have": (
        "recording:\n  format: mcap\n  compression: bz2\n",
        "study.yaml, line 3, recording.compression: recordings with `recording.format: mcap` cannot have the "
        "compression bz2. Write none, lz4, zstd, or change the format.",
    ),
    "a footprint beside the robot": (
        "world: {footprint: [[1, 0], [2, 0], [1, 1]]}",
        "study.yaml, line 1, world.footprint: the polygon of these corners does not contain the robot's center (0, 0).",
    ),
}


class TestBroken:
    @pytest.mark.parametrize(("text", "told"), BROKEN.values(), ids=BROKEN)
    def test_the_message_says_where_and_what_to_do(self, text: str, told: str) -> None:
        assert told in refusal(text)

    def test_all_faults_are_told_at_once_in_the_order_of_the_file(self) -> None:
        text = "robots: many\ngame:\n  energie: 3\n  picture_cost: -1\nrobot:\n  amcl:\n    kld_err: yes\n"
        lines = refusal(text).splitlines()
        assert [line.split(",")[1] for line in lines] == [" line 1", " line 3", " line 4", " line 7"]

    def test_contradictions_are_told_together_too(self) -> None:
        text = "world: {laser: {rate: 3}}\nrobot: {amcl: {max_particles: 50}}\n"
        with pytest.raises(BadFiles) as caught:
            read_study_text(STUDY, text)
        assert [fault.key for fault in caught.value.faults] == ["world.laser.rate", "robot.amcl.min_particles"]

    @given(st.text(max_size=200))
    def test_any_text_is_read_or_refused(self, text: str) -> None:
        try:
            read_study_text(STUDY, text)
        except BadFile as error:
            assert str(error)


class TestNoise:
    def test_without_the_section_nothing_changes(self) -> None:
        assert read_study_text(STUDY, "noise: {preset: none}") == Study()

    @pytest.mark.parametrize("preset", NoisePreset)
    def test_a_preset_reads_back_equal_from_a_bag(self, preset: NoisePreset) -> None:
        study = read_study_text(STUDY, f"noise: {{preset: {preset}}}")
        assert (study == Study()) == (preset == NoisePreset.NONE)
        assert read_study_text(STUDY, resolved(study)) == study

    def test_a_preset_sets_the_world_and_what_is_believed_of_it(self) -> None:
        study = read_study_text(STUDY, "noise: {preset: perfect}")
        assert study.world.odometry == OdometryNoise(0, 0, 0, 0)
        assert (study.world.laser.range_noise, study.world.laser.dropout, study.world.gyro_noise) == (0, 0, 0)
        assert study.robot.amcl.odom_alpha1 == 0.01
        assert study.robot.ekf.gyro_noise == 0

    def test_what_is_written_wins_over_the_preset(self) -> None:
        text = "noise: {preset: bad wheels, odometry: {alpha3: 0.3}, believed: {amcl: {odom_alpha2: 0.7}}}"
        study = read_study_text(STUDY, text)
        assert study.world.odometry == OdometryNoise(0.1, 0.1, 0.3, 0.1, 1.05, 1.1)
        assert (study.robot.amcl.odom_alpha1, study.robot.amcl.odom_alpha2) == (0.05, 0.7)

    def test_a_number_may_stand_at_its_home_instead(self) -> None:
        study = read_study_text(STUDY, "noise: {preset: bad wheels}\nrobot: {amcl: {odom_alpha2: 0.7}}")
        assert (study.robot.amcl.odom_alpha1, study.robot.amcl.odom_alpha2) == (0.05, 0.7)
        assert read_study_text(STUDY, resolved(study)) == study

    def test_two_words_for_one_number_are_told(self) -> None:
        text = "robot:\n  amcl: {odom_alpha1: 0.1}\nnoise:\n  believed: {amcl: {odom_alpha1: 0.3}}\n"
        assert refusal(text) == (
            "study.yaml, line 4, noise.believed.amcl.odom_alpha1: "
            "the value is 0.3 here, but 0.1 as robot.amcl.odom_alpha1 in line 2. Keep one of the two."
        )

    def test_the_same_number_twice_is_no_contradiction(self) -> None:
        text = "world: {gyro_noise: 0.5}\nnoise: {gyro_noise: 0.5}\n"
        assert read_study_text(STUDY, text).world.gyro_noise == 0.5

    def test_the_commented_file_leaves_room_for_a_preset(self) -> None:
        text = commented_study().replace("  preset: none\n", "  preset: bad wheels\n")
        short = f"templates: {STANDARD.templates}\nnoise: {{preset: bad wheels}}"
        assert read_study_text(STUDY, text) == read_study_text(STUDY, short)
        assert text.count("odom_alpha1:") == 2

    @pytest.mark.parametrize("text", ["noise:\n", "noise: {preset: [1]}", "noise: 3", "noise: {preset: worse wheels}"])
    def test_any_section_is_read_or_refused(self, text: str) -> None:
        try:
            assert read_study_text(STUDY, text) == Study()
        except BadFile as error:
            assert "study.yaml, line 1, noise" in str(error)


class TestEach:
    TEXT = "robots: 3\nrobot: {amcl: {min_particles: 200}}\neach:\n  2: {localization: ekf, amcl: {kld_z: 0.5}}\n  3:\n"

    def test_a_robot_differs_in_what_is_written_for_it(self) -> None:
        study = read_study_text(STUDY, self.TEXT)
        own = study.software(2)
        assert (own.localization, own.amcl.kld_z, own.amcl.min_particles) == ("ekf", 0.5, 200)
        assert study.software(1) == study.software(3) == study.robot

    def test_its_place_in_the_file_does_not_matter(self) -> None:
        sections = self.TEXT.split("\n", 2)
        turned = "\n".join((sections[2].rstrip(), sections[1], sections[0]))
        assert read_study_text(STUDY, turned) == read_study_text(STUDY, self.TEXT)

    def test_it_reads_back_equal_and_short(self) -> None:
        study = read_study_text(STUDY, self.TEXT)
        assert read_study_text(STUDY, resolved(study)) == study
        assert "each:\n  2:\n    localization: ekf\n    amcl:\n      kld_z: 0.5\n  3:\n" in resolved(study)

    def test_it_believes_of_noise_what_all_do_unless_it_says_otherwise(self) -> None:
        text = "noise: {preset: bad wheels}\neach: {2: {amcl: {odom_alpha1: 0.1}}}"
        amcl = read_study_text(STUDY, text).software(2).amcl
        assert (amcl.odom_alpha1, amcl.odom_alpha2) == (0.1, 0.02)

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            ("each: {3: {}}", "each.3: there is no robot 3: the study has 2. Write a number from 1 to 2, or increase"),
            ("each: {0: {}}", "each.0: '0' is not a valid number. Write a whole number, at least 1."),
            ("each: {1: {}, 1: {}}", "each.1: this key is written twice, first in line 1. Keep one of the two."),
            ("each: [1]", "each: a section is needed. Write 'NUMBER: {...}' lines."),
            ("each: {1: {localisation: ekf}}", "each.1.localisation: unknown key. The nearest name is local"),
            ("each: {1: {amcl: {min_particles: 9000}}}", "each.1.amcl.min_particles: 9000 is above each.1.amcl.max_p"),
        ],
    )  # fmt: skip
    def test_faults_are_told_as_elsewhere(self, text: str, told: str) -> None:
        assert f"study.yaml, line 1, {told}" in refusal(text)

    def test_a_fault_that_all_share_is_told_once(self) -> None:
        assert refusal("robot: {amcl: {min_particles: 9000}}\neach: {2: {localization: ekf}}").count("is above") == 1


def test_names_that_only_ros_knows_are_told_of(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    path.write_text("robot: {fake_localization: {odom_frame_id: odom, delta_x: 1.0}}")
    loaded = load_study(path)
    assert loaded.value.robot.fake_localization.delta_x == 1.0
    (notice,) = loaded.notices
    assert notice.startswith(f"{path}, line 1: robot.fake_localization.odom_frame_id has no effect here")


class TestFiles:
    def test_a_missing_file(self, tmp_path: Path) -> None:
        with pytest.raises(BadFile, match="there is no such file"):
            load_study(tmp_path / "none.yaml")

    def test_a_folder(self, tmp_path: Path) -> None:
        with pytest.raises(BadFile, match="cannot be read"):
            load_study(tmp_path)

    @pytest.mark.parametrize(
        ("encoding", "letters", "told", "iconv"),
        [
            ("latin-1", "ö", "line 2: byte 0xf6 is not UTF-8; the file was probably saved as Latin-1. ", "ISO-8859-1"),
            (
                "cp1252",
                "„ö“",
                "line 2: byte 0x84 is not UTF-8; the file was probably saved as Windows-1252. ",
                "WINDOWS-1252",
            ),
            ("utf-16", "ö", "line 1: byte 0xff is not UTF-8; the file was probably saved as UTF-16. ", "UTF-16"),
            ("utf-16-le", "ö", "line 1: the text is not UTF-8; it was probably saved as UTF-16LE. ", "UTF-16LE"),
            ("utf-16-be", "ö", "line 1: the text is not UTF-8; it was probably saved as UTF-16BE. ", "UTF-16BE"),
        ],
    )
    def test_another_encoding(self, tmp_path: Path, encoding: str, letters: str, told: str, iconv: str) -> None:
        path = tmp_path / "other.yaml"
        path.write_bytes(f"seed: 1\nmap: gr{letters}ße\n".encode(encoding))
        with pytest.raises(BadFile) as refused:
            load_study(path)
        assert told in str(refused.value)
        assert f"iconv -f {iconv} -t UTF-8" in str(refused.value)
        converted = subprocess.run(["iconv", "-f", iconv, "-t", "UTF-8", path], capture_output=True, check=True)
        assert converted.stdout.decode().removeprefix("\ufeff") == f"seed: 1\nmap: gr{letters}ße\n"

    def test_an_encoding_that_is_not_known(self, tmp_path: Path) -> None:
        path = tmp_path / "other.yaml"
        path.write_bytes("map: größe Ê\n".encode("mac-roman") + b"# \x8d")
        with pytest.raises(BadFile, match="the file was probably saved as an encoding of another system") as refused:
            load_study(path)
        assert "iconv" not in str(refused.value)

    def test_a_byte_order_mark_and_windows_line_ends_do_no_harm(self, tmp_path: Path) -> None:
        path = tmp_path / "windows.yaml"
        path.write_bytes(b"\xef\xbb\xbfseed: 7\r\nrobots: 3\r\n")
        assert load_study(path).value == Study(seed=7, robots=3)

    def test_a_huge_file(self, tmp_path: Path) -> None:
        path = tmp_path / "huge.yaml"
        path.write_bytes(b"#" * ((1 << 20) + 1))
        with pytest.raises(BadFile, match="larger than 1048576 bytes"):
            load_study(path)


def test_a_required_key_that_is_missing_is_named() -> None:
    with pytest.raises(BadFile, match=r"line 1, size: missing. Add the line 'size: ...'. Write a whole number there"):
        load_text(STUDY, "name: x\n", _Parcel)


@dataclass(frozen=True)
class _Parcel:
    name: str
    size: int


def test_worlds_and_robots_are_the_simulators_own() -> None:
    study = Study()
    assert isinstance(study.world, WorldParameters)
    assert isinstance(study.robot, RobotParameters)


def test_software_may_come_from_files_of_ros(tmp_path: Path) -> None:
    """Before the study's own section, and into the study that a bag holds."""
    (tmp_path / "ros").mkdir()
    (tmp_path / "ros" / "amcl.yaml").write_text("max_particles: 700\nkld_err: 0.02\n")
    study_file = tmp_path / "study.yaml"
    study_file.write_text("ros_parameters: [ros/amcl.yaml]\nrobot: {amcl: {kld_err: 0.03}}\n")
    study = load_study(study_file).value
    assert (study.robot.amcl.max_particles, study.robot.amcl.kld_err) == (700, 0.03)
    assert read_study_text(tmp_path / "elsewhere" / "study.yaml", resolved(study)) == study


def test_what_files_of_ros_leave_out_is_as_in_ros_and_told(tmp_path: Path) -> None:
    """Below presets and lines of the study; what the study has itself is not told."""
    (tmp_path / "ros.yaml").write_text("local_costmap: {static_map: true}\namcl: {kld_z: 0.9}\n")
    text = "ros_parameters: [ros.yaml]\nnoise: {preset: perfect}\nrobot: {amcl: {max_particles: 700}}\n"
    (tmp_path / "study.yaml").write_text(text)
    loaded = load_study(tmp_path / "study.yaml")
    robot = loaded.value.robot
    assert (robot.amcl.kld_err, robot.amcl.laser_sigma_hit, robot.amcl.max_particles) == (0.01, 0.05, 700)
    assert (robot.move_base.oscillation_timeout, robot.local_costmap.width) == (0.0, 10.0)
    (of_amcl,) = [notice for notice in loaded.notices if notice.startswith("amcl: parameters left out")]
    assert "kld_err 0.01 (0.05)" in of_amcl
    assert not [word for word in ("max_particles", "laser_sigma_hit", "kld_z") if word in of_amcl]
    assert robot.local_costmap.obstacle_layer.observation_sources == ()
    assert read_study_text(tmp_path / "elsewhere" / "study.yaml", resolved(loaded.value)) == loaded.value


def test_a_study_without_files_of_ros_begins_as_hunts_do() -> None:
    loaded = load_study_tree(STUDY, parse(STUDY, "robot: {amcl: {kld_z: 0.9}}\n"))
    assert loaded.notices == ()
    assert loaded.value.robot == dataclasses.replace(
        RobotParameters(), amcl=dataclasses.replace(RobotParameters().amcl, kld_z=0.9)
    )


def test_a_fault_in_a_file_of_ros_is_told_there(tmp_path: Path) -> None:
    (tmp_path / "amcl.yaml").write_text("max_particles: 700\nkld_er: 0.02\n")
    (tmp_path / "study.yaml").write_text("ros_parameters: [amcl.yaml]\n")
    with pytest.raises(BadFile, match=r"amcl\.yaml, line 2, amcl\.kld_er: .*kld_err"):
        load_study(tmp_path / "study.yaml")


@pytest.mark.parametrize("written", ["amcl.yaml", "[[a]]", "{a: 1}", "[nowhere.yaml]"])
def test_ros_parameters_that_name_no_files(tmp_path: Path, written: str) -> None:
    (tmp_path / "study.yaml").write_text(f"ros_parameters: {written}\n")
    with pytest.raises(BadFile):
        load_study(tmp_path / "study.yaml")


class TestRecording:
    def test_sizes_are_in_megabytes_and_times_in_seconds(self) -> None:
        text = "recording: {compression: lz4, split_size: 1.5, split_duration: 60}"
        recording = read_study_text(STUDY, text).recording
        assert recording.compression is Compression.LZ4
        assert recording.splitting == SplitLimits(3 * 2**19, 60_000_000_000)

    def test_by_default_a_recording_is_one_file_packed_with_lz4(self) -> None:
        recording = read_study_text(STUDY, "").recording
        assert (recording.compression, recording.splitting) == (Compression.LZ4, SplitLimits())

    @pytest.mark.parametrize(
        ("written", "ending"),
        {
            "{}": ".bag",
            "{compression: bz2}": ".bag",
            "{compression: zstd}": ".mcap",
            "{format: mcap}": ".mcap",
            "{format: bag, compression: none}": ".bag",
        }.items(),
    )
    def test_format_and_compression_give_the_ending_of_names(self, written: str, ending: str) -> None:
        assert read_study_text(STUDY, f"recording: {written}").recording.ending == ending

    def test_all_costmaps_are_recorded_on_request(self) -> None:
        assert read_study_text(STUDY, "recording: {detail: all}").recording.detail is RecordingDetail.ALL

    def test_texts_of_an_installed_ros_are_taken_on_request(self) -> None:
        assert read_study_text(STUDY, "").recording.definitions is DefinitionTexts.OWN
        chosen = read_study_text(STUDY, "recording: {definitions: installed}").recording
        assert chosen.definitions is DefinitionTexts.INSTALLED

    @pytest.mark.parametrize(
        "line", ["compression: zip", "format: db3", "detail: some", "split_size: 0", "split_duration: 0.5"]
    )
    def test_what_cannot_be_is_refused(self, line: str) -> None:
        assert f"recording.{line.split(':', maxsplit=1)[0]}" in refusal(f"recording: {{{line}}}")


@pytest.mark.parametrize("section", ["server", "watch"])
@pytest.mark.parametrize("host", ["a\\0b", "", "a\\nb", "x" * 300])
def test_a_host_that_no_machine_can_have_is_refused(section: str, host: str) -> None:
    assert f"line 1, {section}.host: this is not an address" in refusal(f'{section}: {{host: "{host}"}}')
