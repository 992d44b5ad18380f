"""The command line from the user's seat: exit codes, the one message, the one JSON object."""

import json
import logging
import os
import re
import socket
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.bags.small_bags import write_hundred_messages
from tests.support.programs.commands import invoke, refusal
from tests.support.project import ROOT
from thbridge.app.compose.setting import StudySetting
from thbridge.app.consent import ParticipantDeclined
from thbridge.recording.digest import digest_of
from thbridge.study.study_file import load_study
from ui.cli import NoteHandler

COSTS = str(ROOT / "templates" / "original-2016" / "mapTimes")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def json_of(*arguments: str | Path) -> dict:
    """Return the output of a command with --json: one object on one line."""
    done = invoke(*arguments, "--json")
    assert done.exit_code == 0, (done.output, done.exception)
    assert done.stdout.count("\n") == 1
    return json.loads(done.stdout)


# A file that is not what it should be, by how it came about.
WRONG: dict[str, Callable[[Path], object]] = {
    "missing": lambda path: None,
    "directory": lambda path: path.mkdir(),
    "binary": lambda path: path.write_bytes(bytes(range(256)) * 20),
    "text": lambda path: path.write_text("hello\n"),
}


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize(
    "command",
    [
        ("play", "FILE"),
        ("server", "FILE"),
        ("simr", "FILE"),
        ("simr", "--study", "FILE"),
        ("hider", "FILE"),
        ("tabui", "FILE", "--json"),
        ("tabui", "--study", "FILE", "--participant", "person"),
        ("study", "check", "FILE"),
        ("report", "FILE"),
        ("bag", "info", "FILE"),
        ("bag", "info", "FILE", "--json"),
        ("bag", "reindex", "FILE"),
        ("maps", "check", "./FILE"),
        ("hider", "--treasures", "./FILE"),
        ("tabui", "--templates", "./FILE"),
        ("suggest", "--at", "0", "--unvisited", "1", "--costs", "FILE"),
    ],
    ids=" ".join,
)
def test_a_wrong_file_is_named_and_told_in_one_message(command: tuple[str, ...], wrong: str) -> None:
    WRONG[wrong](Path("FILE"))
    message = refusal(*command)
    assert message.startswith("FILE")
    assert message.count("\n") == 1


@pytest.mark.parametrize("command", [("report",), ("bag", "info"), ("bag", "reindex")], ids=" ".join)
def test_an_empty_file_is_no_bag(command: tuple[str, ...]) -> None:
    Path("a.bag").touch()
    assert refusal(*command, "a.bag") == (
        "a.bag: this is not a ROS 1 bag. Name a file that rosbag or thbridge recorded.\n"
    )


def test_a_bag_that_was_cut_is_mended_as_the_message_says() -> None:
    whole = write_hundred_messages(Path("a.bag"))
    Path("a.bag").write_bytes(whole[: len(whole) // 2])
    for command in (("bag", "info"), ("report",)):
        assert "Run `thbridge bag reindex a.bag`." in refusal(*command, "a.bag")
    mended = json_of("bag", "reindex", "a.bag")
    assert mended["path"] == "a.bag"
    assert mended["backup"] == "a.orig.bag"
    assert json_of("bag", "info", "a.bag")["messages"] == mended["messages"] > 0
    assert "the repair would overwrite it" in refusal("bag", "reindex", "a.bag")


def test_a_report_never_takes_the_place_of_its_bag() -> None:
    whole = write_hundred_messages(Path("a.html"))
    assert "the bag itself" in refusal("report", "a.html")
    assert Path("a.html").read_bytes() == whole


@pytest.mark.parametrize("place", ["/proc/a.html", "file/a.html", "none/a.html", "."])
def test_a_report_that_cannot_be_written_says_so(place: str) -> None:
    Path("file").touch()
    write_hundred_messages(Path("a.bag"))
    assert "it cannot be written" in refusal("report", "a.bag", "--to", place)


@pytest.mark.parametrize("place", ["/proc/a.bag", "file/a.bag", "folder.bag", "a.txt"])
def test_a_recording_that_has_no_place_is_refused_before_anything_starts(place: str) -> None:
    Path("file").touch()
    Path("folder.bag").mkdir()
    assert place in refusal("play", "--port", "0", "--bag", place)
    assert place in refusal("simr", "--bag", place)


@pytest.mark.parametrize("place", ["file", "/proc/journal"])
def test_a_server_that_cannot_keep_a_journal_does_not_start(place: str) -> None:
    Path("file").touch()
    assert refusal("server", "--port", "0", "--journal", place).startswith(f"{place}: journals cannot be kept here")


@pytest.mark.parametrize(
    "address", ["", "localhost", "localhost:", ":6009", "localhost:0", "localhost:65536", "localhost:six"]
)
@pytest.mark.parametrize("program", ["simr", "hider", "tabui", "serve"])
def test_an_address_is_host_and_port(program: str, address: str) -> None:
    assert refusal(program, "--server", address) == (
        f"--server: {address!r} is not an address. Write HOST:PORT, such as 127.0.0.1:6009.\n"
    )


@pytest.mark.parametrize("program", ["simr", "hider", "tabui"])
def test_a_port_of_the_study_that_is_any_free_one_must_be_told(program: str) -> None:
    Path("study.yaml").write_text("server: {port: 0}\n")
    assert "Add the actual port: --server HOST:PORT." in refusal(program, "--study", "study.yaml")


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--robots", "0"),
        ("--robots", "65"),
        ("--robots", "two"),
        ("--seed", "-1"),
        ("--seed", str(2**31)),
        ("--port", "-1"),
        ("--port", "65536"),
        ("--rate", "-1"),
        ("--rate", "nan"),
        ("--rate", "1e9"),
        ("--rate", "inf"),
        ("--max-seconds", "0"),
        ("--participant", "nobody"),
        ("--outside", "SimR"),
        ("--outside", "TabUI,Tabby"),
    ],
)
def test_an_option_out_of_range_is_named(option: str, value: str) -> None:
    assert option in refusal("play", option, value)


def test_a_team_too_large_for_the_map_is_refused_with_both_numbers() -> None:
    message = refusal("play", "--robots", "60")
    assert "rooms.yaml, starts: there are start poses for 15 robots, but the study has 60." in message


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("arena", "nearest name is arena8"),
        ("nonsense", "names are: arena8, office, practice, warehouse12"),
        ("", "write a slash in your own path"),
    ],
)
def test_an_unknown_map_is_answered_with_the_known(name: str, remedy: str) -> None:
    assert remedy in refusal("play", "--map", name)
    if name:
        assert remedy in refusal("maps", "check", name)


@pytest.mark.parametrize("rooms", ["", ",", "1,,2", "0", "9", "-1", "1 2", "a", "²"])
def test_rooms_that_are_none_are_refused_with_those_there_are(rooms: str) -> None:
    message = refusal("suggest", "--costs", COSTS, "--at", "0", "--unvisited", rooms)
    assert message.startswith("--unvisited: ")
    assert "1 to 8" in message


def test_a_robot_stands_at_a_place_of_the_cost_file() -> None:
    assert refusal("suggest", "--costs", COSTS, "--at", "9", "--unvisited", "1").startswith("--at: 9 ")


def test_a_suggestion_is_the_first_room_of_the_cheapest_tour() -> None:
    assert json_of("suggest", "--costs", COSTS, "--at", "0", "--unvisited", "1,2,5") == {
        "next": 1,
        "tour": [1, 2, 5],
        "cost": 49,
        "at_least": 49,
        "proven": True,
    }
    message = invoke("suggest", "--costs", COSTS, "--at", "0", "--unvisited", "1,2,5").stdout
    assert message == "Next room: 1. The cheapest tour is 1 2 5 and costs 49.\n"


def test_maps_are_listed_and_without_fault() -> None:
    names = invoke("maps", "list").stdout.split()
    assert names == ["arena8", "office", "practice", "warehouse12"]
    for name in names:
        found = json_of("maps", "check", name)
        assert (found["ok"], found["findings"]) == (True, [])


def test_a_map_with_faults_gives_them_all_and_exit_code_2() -> None:
    Path("mine").mkdir()
    for file in ("map.yaml", "map.pgm"):
        Path("mine", file).write_bytes((ROOT / "maps" / "arena8" / file).read_bytes())
    rooms = (ROOT / "maps" / "arena8" / "rooms.yaml").read_text()
    Path("mine", "rooms.yaml").write_text(rooms.replace("goal: [", "goal: [99, ", 2))
    done = invoke("maps", "check", "mine", "--json")
    assert done.exit_code == 2
    found = json.loads(done.stdout)
    assert not found["ok"]
    assert len(found["findings"]) >= 2
    assert all("rooms.yaml" in finding["message"] for finding in found["findings"])
    assert invoke("maps", "check", "mine").exit_code == 2


def test_the_study_that_is_written_is_without_fault_and_says_the_defaults() -> None:
    assert invoke("study", "init", "study.yaml").exit_code == 0
    assert invoke("study", "check", "study.yaml").stdout == "study.yaml: no faults\n"
    assert load_study(Path("study.yaml")).value.seed == 1
    assert "this file already exists" in refusal("study", "init", "study.yaml")


@pytest.mark.parametrize(
    ("arguments", "templates"),
    [((), "everyday-things"), (("original-2016",), "original-2016"), (("--outside", "TabUI"), "original-2016")],
)
def test_a_hunt_is_the_standard_study_unless_another_is_named_or_programs_of_others_play(
    arguments: tuple[str, ...], templates: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    played: list[StudySetting] = []

    async def play(setting: StudySetting, *_: object) -> None:
        played.append(setting)
        raise ParticipantDeclined(True)

    monkeypatch.setattr("thbridge.app.play.play", play)
    assert invoke("play", *arguments, "--headless", "--rate", "0").exit_code == 3
    assert [setting.study.templates for setting in played] == [templates]
    assert played[0].by_position is (templates == "everyday-things")


def test_a_language_is_chosen_for_one_run(monkeypatch: pytest.MonkeyPatch) -> None:
    played: list[StudySetting] = []

    async def play(setting: StudySetting, *_: object) -> None:
        played.append(setting)
        raise ParticipantDeclined(True)

    monkeypatch.setattr("thbridge.app.play.play", play)
    assert invoke("play", "--language", "de", "--headless", "--rate", "0").exit_code == 3
    assert [setting.texts.language for setting in played] == ["de"]
    assert "no language 'xx'. Choose one of de, en." in refusal("play", "--language", "xx")


@pytest.mark.parametrize("option", [("play", "--rate", "0,2"), ("plan", "--map", "m.yaml", "--start", "0,2", "0")])
def test_a_decimal_comma_is_refused_with_its_remedy(option: tuple[str, ...]) -> None:
    assert "'0,2' is not a number. Use a decimal point: 0.2." in " ".join(refusal(*option).replace("│", "").split())


@pytest.mark.parametrize(
    ("option", "told"),
    [
        (("--robots", "100"), "'100' is out of range. Write a whole number, 1 to 64."),
        (("--robots", "2.5"), "'2.5' is not a whole number. Write a whole number, 1 to 64."),
        (("--rate", "1e9"), "'1e9' is out of range. Write a number, 0 to 1000."),
        (("--rate", "fast"), "'fast' is not a number. Write a number, 0 to 1000."),
    ],
)
def test_numbers_that_options_take_are_told_as_in_files(option: tuple[str, ...], told: str) -> None:
    assert told in " ".join(refusal("play", *option).replace("│", "").split())


@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("plan --map m.yaml --start 0 x", "'x' is not a number. Write a number."),
        (
            "study power f --score s --factor f --people 3 --people 1",
            "'1' is out of range. Write a whole number, at least 2.",
        ),
        ("play --look Dark", "'Dark' is not one of 'system', 'light', 'dark'."),
        ("argue a.apx --semantics xx", "'xx' is not one of 'gr', 'co', 'pr', 'st'."),
    ],
)
def test_values_that_options_do_not_take_are_told(command: str, told: str) -> None:
    assert told in " ".join(refusal(*command.split()).replace("│", "").split())


@pytest.mark.parametrize("place", ["none/a.yaml", "file/a.yaml", "/proc/a.yaml"])
def test_a_study_that_cannot_be_written_says_so(place: str) -> None:
    Path("file").touch()
    assert "it cannot be written" in refusal("study", "init", place)


def test_ros_messages_are_a_package() -> None:
    assert invoke("ros", "messages", "src").exit_code == 0
    assert Path("src/thbridge_msgs/package.xml").is_file()
    assert Path("src/thbridge_msgs/msg/Session.msg").is_file()
    assert "uint64[] payload64" in Path("src/mavros_msgs/msg/Mavlink.msg").read_text()  # where ROS has no mavros
    Path("file").touch()
    assert "it cannot be written" in refusal("ros", "messages", "file")


def test_a_master_that_cannot_listen_says_so() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        message = refusal("ros", "master", "--port", str(port))
    assert f"cannot listen on 127.0.0.1:{port}: Address already in use" in message


def test_all_that_a_study_names_wrongly_is_told_at_once() -> None:
    text = "robots: 60\ntemplates: ./nix\nparticipant:\n  consent: none.txt\n  farewell: gone.txt\n"
    Path("study.yaml").write_text(text)
    message = refusal("study", "check", "study.yaml")
    lines = re.findall(r"^study\.yaml, line (\d), ([\w.]+): ", message, re.MULTILINE)
    assert lines == [("1", "robots"), ("2", "templates"), ("4", "participant.consent"), ("5", "participant.farewell")]


def test_a_value_that_an_option_gives_is_not_told_as_one_of_the_file() -> None:
    Path("study.yaml").write_text("map: arena8\n")
    assert "maps, nowhere: no map has this name" in refusal("play", "study.yaml", "--map", "nowhere")


@pytest.mark.parametrize(
    ("study", "message"),
    [
        ("robts: 3\n", "line 1, robts: unknown key"),
        ("robots: three\n", "line 1, robots: 'three' is not a number"),
        ("robots: 0\n", "line 1, robots:"),
        ("seed: 1\nseed: 2\n", "line 2, seed:"),
        ("map: nowhere\n", "study.yaml, line 1, map: no map has this name"),
        ("map: ./nowhere\n", "study.yaml, line 1, map: nowhere: there is no such folder"),
        ("templates: nobody\n", "study.yaml, line 1, templates: no set of templates has this name"),
        ("game:\n  costs: none\n", "study.yaml, line 2, game.costs: none: there is no such file"),
        ("game:\n\tcosts: none\n", "line 2: a tab in the indentation"),
        ("map: warehouse12\ngame:\n  costs: COSTS\n", "9 nodes, but the map warehouse12 has 12 rooms"),
        ("server:\n  port: 70000\n", "line 2, server.port:"),
        ("participant:\n  strategy: guess\n", "line 2, participant.strategy: 'guess' is not a valid choice"),
        (
            "participant:\n  consent: none.txt\n",
            "line 2, participant.consent: none.txt: there is no such file",
        ),
        ("participant:\n  consent: empty.txt\n", "empty.txt: the consent text is empty"),
        ("participant:\n  consent: long.txt\n", "long.txt: the file is larger than 8000 bytes"),
        ("participant:\n  robots: [4, 1]\n", "line 2, participant.robots: 4 is above 1"),
        ("participant:\n  robots: [0, 4]\n", "line 2, participant.robots[0]: 0 is out of range"),
        ("participant:\n  robots: 3\n", "line 2, participant.robots: a list is needed"),
        ("participant:\n  robots: [1, 60]\n", "study.yaml, line 2, participant.robots: "),
        ("seed: 1\nrobots: 60\n", "study.yaml, line 2, robots: "),
        (
            "participant:\n  shows: {truth: maybe}\n",
            "participant.shows.truth: 'maybe' is neither true nor false",
        ),
        ("world: {laser: {rate: 15}}\n", "line 1, world.laser.rate: 15 is not a divisor"),
        ("- a\n- b\n", "line 1: a section of 'key: value' lines is needed"),
        ("robots: [1\n", "line 1: not YAML"),
    ],
)
def test_a_broken_study_is_told_with_its_line(study: str, message: str) -> None:
    Path("study.yaml").write_text(study.replace("COSTS", COSTS))
    Path("empty.txt").write_text(" \n")
    Path("long.txt").write_text("a" * 8001)
    for command in (("play",), ("study", "check")):
        assert message in refusal(*command, "study.yaml")


def test_names_without_effect_are_told_where_a_study_is_read() -> None:
    Path("study.yaml").write_text("robot:\n  fake_localization:\n    odom_frame_id: odom\n")
    checked = invoke("study", "check", "study.yaml")
    assert checked.exit_code == 0
    assert "study.yaml, line 3: robot.fake_localization.odom_frame_id has no effect here" in checked.stderr


def test_a_person_needs_no_templates_and_no_seed() -> None:
    message = refusal("tabui", "--participant", "person", "--templates", "./nowhere", "--seed", "3")
    assert "--templates has no effect here: it applies only to simulated participants.\n" in message
    assert "--seed has no effect here" in message
    assert "standard input is a file" in message, "it would start otherwise"


def test_real_robots_are_not_simulated_and_not_hurried() -> None:
    for source in ("ros", "ros2"):
        given = ("simr", "--robots-from", source)
        for graph in ("--ros", "--ros2"):
            message = f"{graph}: real robots ({source}) are always on their own graph"
            assert message in refusal(*given, graph)
        assert "--rate: real robots run in real time" in refusal(*given, "--rate", "2")
        assert "--watch: this option needs simulated robots" in refusal(*given, "--watch", "6010")
        assert "--foxglove: this option needs simulated robots" in refusal(*given, "--foxglove", "0")
        Path("study.yaml").write_text(f"robots_from: {source}\n")
        for command in ("play", "serve"):
            assert f"this study is for real robots, but `{command}` simulates them" in refusal(command, "study.yaml")
    assert "--carrier requires a ROS 2 graph" in refusal("simr", "--robots-from", "ros", "--carrier", "dds")
    assert "--carrier requires a ROS 2 graph" in refusal("play", "--headless", "--carrier", "zenoh")
    assert "--ros2-domain requires a ROS 2 graph" in refusal("play", "--headless", "--ros2-domain", "42")
    Path("study.yaml").write_text("robots: 1\nrobots_from: ros\nfleet: {robot: {namespace: ''}}\n")
    assert "/odom is both odom of robot 1 and odom of robot 2" in refusal(
        "simr", "--study", "study.yaml", "--robots", "2"
    )


def test_robots_of_external_nodes_need_a_graph_and_are_not_played() -> None:
    Path("study.yaml").write_text("external_nodes: move_base\n")
    assert "Add --ros or --ros2, or set external_nodes: none." in refusal("simr", "study.yaml")
    for command in ("play", "serve"):
        assert f"but `{command}` drives robots itself. Start `simr --ros` (or --ros2)" in refusal(command, "study.yaml")


def test_robots_by_themselves_are_no_vehicles() -> None:
    Path("study.yaml").write_text("mavlink: {on: true}\n")
    message = refusal("simr", "--study", "study.yaml", "--ros", "--ros-master", "nonsense")
    assert "mavlink has no effect here: robots are MAVLink vehicles only in `thbridge play`." in message


def test_fewer_robots_than_the_study_has_software_for_are_refused() -> None:
    Path("study.yaml").write_text("robots: 2\neach: {2: {localization: truth}}\n")
    assert "--robots 1: the study configures robot 2 under `each`" in refusal("play", "study.yaml", "--robots", "1")


def test_play_gives_one_object_and_exit_code_1_when_time_is_up(caplog: pytest.LogCaptureFixture) -> None:
    done = invoke("play", "--json", "--port", "0", "--max-seconds", "1", "--bag", "new/a.bag")
    assert done.exit_code == 1
    assert "The game did not end within 1 simulated seconds." in done.stderr
    assert json.loads(done.stdout)["sim_seconds"] == 1.0
    assert Path("new/a.bag").is_file()
    assert not Path("new/a.html").exists()
    again = invoke("play", "--json", "--report", "--port", "0", "--max-seconds", "1", "--bag", "new/a.bag")
    assert "The older recording was renamed to new/a-1.bag." in caplog.messages
    assert json.loads(again.stdout)["bag"] == "new/a.bag"
    assert Path("new/a.html").is_file()


def test_the_rate_of_the_study_is_the_one_played_at() -> None:
    Path("study.yaml").write_text("rate: 4\n")
    options = ("play", "study.yaml", "--json", "--port", "0", "--max-seconds", "1")
    assert json.loads(invoke(*options).stdout)["wall_seconds"] >= 0.2
    assert json.loads(invoke(*options, "--rate", "0").stdout)["seed"] == 1
    older, newer = Path("bags/arena8-2robots-seed1-1.bag"), Path("bags/arena8-2robots-seed1.bag")
    assert older.read_bytes() == newer.read_bytes(), "how fast it was played leaves no trace"
    invoke(*options, "--rate", "0", "--with", "recording.format=mcap")
    assert newer.with_suffix(".mcap").is_file()


def test_an_unreadable_file_is_told(folder: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("root reads everything")
    path = folder / "study.yaml"
    path.touch(mode=0)
    assert "Permission denied" in refusal("study", "check", path)


def test_measuring_refuses_a_file_that_is_there_before_it_drives(folder: Path) -> None:
    (folder / "mapTimes").write_text("mine\n")
    assert "mapTimes" in refusal("maps", "measure", "arena8", "--out", "mapTimes")
    assert (folder / "mapTimes").read_text() == "mine\n"
    assert "cannot be written" in refusal("maps", "measure", "arena8", "--out", "no/such/folder/mapTimes")


def test_where_nobody_can_watch_is_refused_and_so_is_a_key_that_is_none(folder: Path) -> None:
    for nowhere in ("door", "70000", ":6010", "here:"):
        assert f"--watch: {nowhere!r} is not an address" in refusal("play", "--headless", "--watch", nowhere)
    assert "--watch-key requires --watch PORT" in refusal("play", "--headless", "--watch-key", "key.txt")
    assert "key.txt" in refusal("play", "--headless", "--watch", "0", "--watch-key", "key.txt")
    Path("key.txt").write_text("\nsecret\n")
    Path("key.txt").chmod(0o644)
    assert "run: chmod 600 key.txt" in refusal("simr", "--watch", "0", "--watch-key", "key.txt").lower()
    Path("key.txt").chmod(0o600)
    assert "key.txt, line 1: there is no key in this line" in refusal("simr", "--watch", "0", "--watch-key", "key.txt")
    Path("study.yaml").write_text("watch: {port: 0, key: key.txt}\n")
    assert "there is no key in this line" in refusal("play", "study.yaml", "--headless")
    message = "--watch: this option needs simulated robots."
    assert message in refusal("simr", "--robots-from", "ros", "--watch", "6010")


def test_what_is_logged_is_one_line_as_it_is(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    sentence = 'TabUI asked "%%goto TabUI SimR 0 39 39 45", refused: [bold]Room 40[/bold] is not a room of this game.'
    NoteHandler().emit(logging.makeLogRecord({"msg": sentence}))
    assert capsys.readouterr().err == sentence + "\n"


def test_bag_info_tells_the_digest_of_the_messages() -> None:
    write_hundred_messages(Path("a.bag"))
    told = json_of("bag", "info", "a.bag", "--hash")["hash"]
    assert told == digest_of(Path("a.bag"))
    assert f"hash of all messages: {told}\n" in invoke("bag", "info", "a.bag", "--hash").output
    assert "hash" not in json_of("bag", "info", "a.bag")


def test_the_version_is_that_of_the_project() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert invoke("--version").stdout == f"thbridge {version}\n"
