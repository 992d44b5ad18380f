import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw
from typer.testing import Result

from sim.common.grid import OCCUPIED
from tests.support.maps.floor_plans import WALL, plan
from tests.support.maps.small_arenas import two_rooms
from tests.support.programs.commands import invoke
from tests.support.slow import slow
from thbridge.files.grid_files import read_grid, write_grid
from thbridge.hunt.rooms import Room
from thbridge.offline.kept_trips import KeptTrips
from thbridge.offline.measure import TripResult, TripTimes
from ui.commands.maps.drawing import read_left_out, unreached_words

ROOMS = """\
rooms:
  - number: 1
    name: West
    region: [[0, 0], [3, 4]]
    goal: [1.5, 2, 0]
  - number: 2
    name: East
    region: [[5, 0], [8, 4]]
    goal: [6.5, 2, 1.57]
starts:
  poses: [[4, 1, 0], [4, 2.2, 0]]
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that commands run in, with a map `two` without fault and without travel times."""
    monkeypatch.chdir(tmp_path)
    write_grid(tmp_path / "two", two_rooms())
    (tmp_path / "two" / "rooms.yaml").write_text(ROOMS, encoding="utf-8")
    return tmp_path


def maps(*words: object) -> Result:
    return invoke("maps", *words)


@pytest.mark.slow
def test_a_new_map_is_measured_by_a_study_that_does_not_fit_it_and_then_plays(here: Path) -> None:
    (here / "study.yaml").write_text("robots: 3\nmap: office\ntemplates: ./none\neach:\n  2: {}\n")
    measure = ("measure", "two", "study.yaml", "--runs", 1, "--out")
    of_another_map = here / "two" / "mapTimes"
    of_another_map.write_text("2\n99 1\n99 99\n")
    elsewhere = maps(*measure, "mapTimes", "--jobs", 1)
    assert "copy it to two/mapTimes" in elsewhere.stderr.splitlines()[-1]
    of_another_map.unlink()
    done = maps(*measure, "two/mapTimes", "--jobs", 2)
    assert done.exit_code == 0, done.stderr
    assert done.stderr.splitlines()[-1] == (
        "Wrote two/mapTimes into the map's folder. Games on this map now use these times."
    )
    assert (here / "mapTimes").read_bytes() == (here / "two" / "mapTimes").read_bytes()
    (here / "play.yaml").write_text("map: ./two\n")
    assert invoke("study", "check", "play.yaml").exit_code == 0


@pytest.mark.slow
def test_a_stopped_measurement_goes_on_and_writes_the_same_bytes(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measure = ("measure", "two", "--runs", 1, "--jobs", 1, "--out")
    assert maps(*measure, "whole").exit_code == 0
    add, killed = KeptTrips.add, []

    def add_and_stop(kept: KeptTrips, result: TripResult) -> None:
        add(kept, result)
        killed.append(result.trip)
        raise KeyboardInterrupt

    with monkeypatch.context() as stopping:
        stopping.setattr(KeptTrips, "add", add_and_stop)
        stopped = maps(*measure, "mapTimes")
    assert stopped.exit_code == 1
    assert "Stopped. 1 trips are kept in mapTimes.trips; continue with the same command." in stopped.stderr
    assert not (here / "mapTimes").exists()
    driven = []
    monkeypatch.setattr(KeptTrips, "add", lambda kept, result: (driven.append(result.trip), add(kept, result)))
    done = maps(*measure, "mapTimes", "--progress", "json")
    assert "1 of 4 trips are known from an earlier run (mapTimes.trips). Measuring the others." in done.stderr
    assert '"task": "trips", "done": 4, "total": 4' in done.stderr
    assert len(driven) == 3
    assert killed[0] not in driven
    assert (here / "mapTimes").read_bytes() == (here / "whole").read_bytes()
    assert not (here / "mapTimes.trips").exists()


@pytest.mark.slow
def test_a_new_map_whose_measurement_is_stopped_names_the_command_that_continues(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add = KeptTrips.add

    def add_and_stop(kept: KeptTrips, result: TripResult) -> None:
        add(kept, result)
        raise KeyboardInterrupt

    with monkeypatch.context() as stopping:
        stopping.setattr(KeptTrips, "add", add_and_stop)
        stopped = maps("new", "two/map.yaml", "--to", "three", "--jobs", 1)
    assert stopped.exit_code == 1
    told = (
        "Stopped. 1 trips are kept in three/mapTimes.trips; continue with "
        "`thbridge maps measure three --runs 1 --out three/mapTimes`."
    )
    assert told in stopped.stderr
    done = maps("measure", "three", "--runs", 1, "--out", "three/mapTimes", "--jobs", 1)
    assert "1 of 4 trips are known from an earlier run" in done.stderr


def test_a_view_for_rviz_needs_no_costs(here: Path) -> None:
    done = invoke("ros", "rviz", "--map", "./two", "--robots", "2")
    assert done.exit_code == 0, done.stderr


class TestCheck:
    def test_what_a_good_map_holds_is_told(self, here: Path) -> None:
        told = maps("check", "two").stdout
        assert "two: 8.0 m x 4.0 m, 80 x 40 cells of 0.1 m" in told
        assert "1.0 m to the corridor" in told
        assert "start poses: 2; robot 1 starts at (4, 1)" in told
        assert "reachable: 4 of 4 paths" in told
        assert "`thbridge maps measure two --out two/mapTimes`" in told
        assert told.endswith("0 errors, 0 warnings\n")
        found = json.loads(maps("check", "two", "--json").stdout)
        assert found["ok"]
        assert found["map"]["size"] == [8.0, 4.0]
        assert [(room["number"], room["name"], room["doors"][0]["to"]) for room in found["map"]["rooms"]] == [
            (1, "West", 0),
            (2, "East", 0),
        ]

    def test_a_fault_has_file_line_key_and_remedy(self, here: Path) -> None:
        rooms = here / "two" / "rooms.yaml"
        rooms.write_text(ROOMS.replace("[1.5, 2, 0]", "[0.2, 2, 0]"))
        done = maps("check", "two", "--json")
        assert done.exit_code == 2
        (fault,) = json.loads(done.stdout)["findings"]
        assert (fault["file"], fault["line"], fault["key"]) == ("two/rooms.yaml", 5, "rooms[0].goal")
        assert fault["remedy"] == "Move this pose away from the wall"

    @pytest.mark.parametrize("suffix", ["png", *slow("svg", "pdf")])
    def test_it_is_drawn_also_with_faults_and_always_the_same(self, here: Path, suffix: str) -> None:
        (here / "two" / "rooms.yaml").write_text(ROOMS.replace("[1.5, 2, 0]", "[0.2, 2, 0]"))
        for name in ("a", "b"):
            assert maps("check", "two", "--to", f"{name}.{suffix}").exit_code == 2
        drawn = (here / f"a.{suffix}").read_bytes()
        assert drawn == (here / f"b.{suffix}").read_bytes()
        assert len(drawn) > 2000

    def test_a_picture_has_a_suffix_and_a_folder(self, here: Path) -> None:
        assert "ends in .png, .svg or .pdf" in maps("check", "two", "--to", "map.xyz").stderr
        assert "cannot be written" in maps("check", "two", "--to", "no/map.png").stderr


def picture(path: Path, wall: int = 0) -> None:
    """Two rooms and the corridor between them as an image without a map.yaml, unknown space around; and a table."""
    cells = np.full((60, 100), 205, dtype=np.uint8)
    cells[10:50, 10:90] = np.where(two_rooms().cells == OCCUPIED, wall, 255 - wall)[::-1]
    cells[28:31, 20:23] = wall
    Image.fromarray(cells).save(path)


class TestNew:
    def test_an_image_becomes_an_arena_that_games_are_played_on(self, here: Path) -> None:
        picture(here / "lab.png")
        done = maps("new", "lab.png", "--resolution", 0.1, "--names", "Kitchen, Store", "--robots", 2, "--jobs", 1)
        assert done.exit_code == 0, done.stderr
        assert "Rooms: 2 found: 1 Kitchen, 2 Store" in done.stdout
        assert "Start poses: 2\n" in done.stdout
        assert "Checked: 0 errors, 0 warnings" in done.stdout
        assert "Measured: 4 of 4 paths" in done.stdout
        assert done.stdout.endswith("Play on the map: thbridge play --map ./lab\n")
        assert sorted(file.name for file in (here / "lab").iterdir()) == [
            "map.pgm",
            "map.yaml",
            "mapTimes",
            "rooms.yaml",
        ]
        found = json.loads(maps("check", "lab", "--json").stdout)
        assert (found["findings"], found["map"]["times"]) == ([], True)
        assert found["map"]["ways"] == {"all": 4, "reachable": 4}
        assert [room["doors"][0]["to"] for room in found["map"]["rooms"]] == [0, 0]

    def test_the_same_map_gives_the_same_arena(self, here: Path) -> None:
        for folder in ("a", "b"):
            assert maps("new", "two/map.yaml", "--to", folder, "--no-times").exit_code == 0
        for file in ("map.yaml", "map.pgm", "rooms.yaml"):
            assert (here / "a" / file).read_bytes() == (here / "b" / file).read_bytes()
        assert (here / "a" / "map.pgm").read_bytes() == (here / "two" / "map.pgm").read_bytes()

    def test_a_map_of_another_machine_names_an_image_that_is_beside_it(self, here: Path) -> None:
        yaml = here / "two" / "map.yaml"
        yaml.write_text(yaml.read_text().replace("map.pgm", "/home/robot/maps/map.pgm"))
        assert "does not exist" in maps("check", "two").stdout
        assert maps("new", "two/map.yaml", "--to", "mine", "--no-times").exit_code == 0

    def test_bright_walls_are_for_negate(self, here: Path) -> None:
        picture(here / "plan.png", wall=255)
        refused = maps("new", "plan.png", "--resolution", 0.1, "--no-times")
        assert refused.exit_code == 1
        assert "no rooms were found" in refused.stderr
        assert "--negate" in refused.stderr
        done = maps("new", "plan.png", "--resolution", 0.1, "--no-times", "--negate")
        assert "Rooms: 2 found" in done.stdout
        picture(here / "dark.png")
        refused = maps("new", "dark.png", "--resolution", 0.1, "--no-times", "--negate")
        assert "if walls are dark, omit it" in refused.stderr

    def test_commands_that_are_told_hold_for_names_with_blanks(self, here: Path) -> None:
        picture(here / "my lab.png")
        told = maps("new", "my lab.png", "--resolution", 0.1, "--no-times").stdout
        assert told.endswith("Draw the map: thbridge maps check 'my lab' --to 'my lab-rooms.png'\n")

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("two.png",), "the size of the image in meters is not known. Write the width"),
            (("none.png", "--resolution", "0.1"), "none.png: there is no such file"),
            (("two/map.yaml", "--resolution", "0.1", "--to", "x"), "--resolution: two/map.yaml already contains this"),
            (("two/map.yaml", "--negate", "--to", "x"), "--negate: two/map.yaml already contains this"),
            (("two/map.yaml", "--to", "two"), "--to: two already exists"),
            (("two.png", "--resolution", "0.1", "--to", "x", "--names", "A,,B"), "--names: 'A,,B' has an empty"),
            (("two.png", "--resolution", "0.1", "--to", "x", "--names", "A,B,C"), "3 names, but 2 rooms were found"),
        ],
    )
    def test_what_is_missing_is_told_and_nothing_is_written(
        self, here: Path, words: tuple[str, ...], told: str
    ) -> None:
        picture(here / "two.png")
        before = sorted(here.rglob("*"))
        if words == ("two.png",):
            words = ("two.png", "--to", "x")
        done = maps("new", *words)
        assert done.exit_code == 2
        assert told in done.stderr
        assert sorted(here.rglob("*")) == before

    def test_fewer_rooms_or_starts_than_wanted_are_told(self, here: Path) -> None:
        done = maps("new", "two/map.yaml", "--to", "x", "--no-times", "--rooms", 5, "--robots", 40)
        assert "Rooms: 2 found (5 requested)" in done.stdout
        assert "of 40 (no space for more)" in done.stdout
        done = maps("new", "two/map.yaml", "--to", "y", "--no-times", "--rooms", 1)
        assert "Rooms: 1 found: 1 Room 1" in done.stdout


def test_ways_that_were_not_driven_are_told_by_their_rooms() -> None:
    def pair(start: int, goal: int, refusal: str | None) -> TripTimes:
        return TripTimes(Room(start), Room(goal), () if refusal else (9.0,), (refusal,) if refusal else ())

    stuck, lost = "the robot is stuck", "no path"
    times = [pair(0, 1, None), pair(0, 2, stuck), pair(1, 2, stuck), pair(2, 1, lost)]
    told = unreached_words(times, Path("lab"))
    assert told.startswith("3 of 4 paths were not completed, so games do not allow these moves (99 in mapTimes).")
    assert "Main reason: the robot is stuck." in told
    assert "Most of these paths begin or end in room 2 (3 paths), room 1 (2 paths)." in told
    assert "thbridge maps edit lab" in told


def test_where_no_window_can_be_opened_the_way_by_text_is_told(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    done = maps("new", "two/map.yaml", "--to", "x", "--draw")
    assert (done.exit_code, (here / "x").exists()) == (2, False)
    assert "omit --draw" in done.stderr
    assert "edit two/rooms.yaml as text" in maps("edit", "two").stderr


class TestPlans:
    """Architects' drawings, from the command line."""

    def test_doors_that_are_drawn_shut_are_told_with_what_opens_them(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        plan().resize((650, 450), Image.Resampling.NEAREST).save("plan.png")
        command = ["maps", "new", "plan.png", "--width", "32.5", "--no-times"]
        told = invoke(*command)
        assert told.exit_code == 1
        assert "plan.png: only 2" in told.stderr and "% of the floor is reachable. Lines thinner than " in told.stderr
        assert "and 12 more places. If they are doors" in told.stderr
        assert not Path("plan").exists()
        opened = invoke(*command, "--thinner", "3")
        assert opened.exit_code == 0, opened.stderr
        assert "Rooms: 8 found" in opened.stdout
        assert "Removed: lines and letters thinner than 3 pixels" in opened.stdout
        left_out = read_left_out(Path("plan"), read_grid(Path("plan", "map.yaml")))
        assert left_out is not None and left_out.any()

    def test_an_entrance_is_closed_and_told(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        plan(entrance=True).resize((650, 450), Image.Resampling.NEAREST).save("plan.png")
        command = ["maps", "new", "plan.png", "--width", "32.5", "--no-times", "--thinner"]
        opened = invoke(*command, "3")
        assert opened.exit_code == 0, opened.stderr
        assert "Rooms: 8 found" in opened.stdout
        told = "Closed: openings to the outside, such as entrances and windows, at (2.6, 11.3), so that"
        assert told in opened.stdout

    def test_pixels_finer_than_robots_need_are_joined(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        # Two rooms with their part of the corridor: a whole building with fine pixels takes ten times as long.
        part = plan()
        for ends in ((650, 380, 650, 520), (100, 520, 650, 520)):
            ImageDraw.Draw(part).line(ends, fill=0, width=WALL)
        part.crop((60, 60, 690, 560)).resize((1600, 1270), Image.Resampling.NEAREST).save("plan.png")
        done = invoke("maps", "new", "plan.png", "--width", "15.75", "--no-times", "--thinner", "5", "--robots", "2")
        assert done.exit_code == 0, done.stderr
        assert "A pixel is only 0.00984375 m wide, so 2 x 2 pixels are merged into one cell of 0.0196875 m." in (
            done.stderr
        )
        assert "800 x 635 cells of 0.0196875 m" in done.stdout
        assert "Rooms: 2 found" in done.stdout

    def test_gray_walls_are_refused_with_the_thresholds_that_see_them(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        image = plan(furnished=False).resize((650, 450), Image.Resampling.NEAREST)
        image.point(lambda shade: max(shade, 127)).save("plan.png")
        done = invoke("maps", "new", "plan.png", "--width", "32.5", "--no-times")
        assert done.exit_code == 2
        told = "mostly gray 127. Lasers see only occupied cells, so robots would get lost. Write a map.yaml next to it"
        assert told in done.stderr
        assert "`resolution: 0.05`" in done.stderr and "`occupied_thresh: 0.452`" in done.stderr

    @pytest.mark.parametrize(
        ("options", "told"),
        [
            (("--width", "3250"), "--width: a pixel would be 2.5 m wide, which is not within 0.001 to 0.5 m."),
            (("--resolution", "3"), "'3' is out of range. Write a number, 0.001 to 0.5."),
            (("--width", "30", "--resolution", "0.05"), "--width, --resolution: both options set the size"),
            ((), "Write the width of the whole image in meters with --width"),
        ],
    )
    def test_sizes_are_checked(self, tmp_path, monkeypatch, options, told):
        monkeypatch.chdir(tmp_path)
        plan().save("plan.png")
        done = invoke("maps", "new", "plan.png", "--no-times", *options)
        assert done.exit_code == 2
        assert told in " ".join(done.stderr.replace("│", "").split())

    @pytest.mark.parametrize(
        ("pixels", "thinner", "told"),
        [
            ((650, 450), 6, "% of the drawn area, so walls were probably removed. Use --thinner 3."),
            ((325, 225), 2, "of the floor is reachable: doors may be closed, or narrower than a robot."),
        ],
    )
    def test_a_width_that_takes_walls_or_leaves_doors_shut_is_told(self, tmp_path, monkeypatch, pixels, thinner, told):
        monkeypatch.chdir(tmp_path)
        plan().resize(pixels, Image.Resampling.LANCZOS).save("plan.png")
        options = "--no-times", "--thinner", thinner, "--robots", "1"
        done = invoke("maps", "new", "plan.png", "--width", "32.5", *options)
        assert told in " ".join(done.stderr.split())

    @pytest.mark.parametrize(
        ("options", "told"),
        [
            (("--height", "2250"), "--height: a pixel would be 5 m high and 0.05 m wide."),
            (("--height", "0.5"), "--height: a pixel would be 0.00111111 m high and 0.05 m wide."),
            (("--names", "A;B;C"), "--names: 'A;B;C' is a single name. Separate names by commas."),
            (("--thinner", "3", "--rooms", "2", "--names", "A,B,C"), "Write fewer names, or set --rooms 3."),
        ],
    )
    def test_further_slips_are_told_with_their_remedy(self, tmp_path, monkeypatch, options, told):
        monkeypatch.chdir(tmp_path)
        plan().resize((650, 450), Image.Resampling.NEAREST).save("plan.png")
        done = invoke("maps", "new", "plan.png", "--width", "32.5", "--no-times", *options)
        assert done.exit_code == 2
        assert told in " ".join(done.stderr.replace("│", "").split())
        assert not Path("plan").exists()
