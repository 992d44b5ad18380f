import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim.common.geometry import IDENTITY, Pose2
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from tests.support.maps.small_arenas import two_rooms
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import read_grid, write_grid
from thbridge.files.map_files import check_map, missing_room_names, read_map, write_rooms
from thbridge.files.resources import shipped
from thbridge.hunt.rooms import Room

HERE = Path()

ROOMS = """\
rooms:
  - number: 1
    name: West
    region: [[0, 0], [3, 4]]
    goal: [1.5, 2, 0]
  - number: 2
    name: East
    region: [[5, 0], [8, 0], [8, 4], [5, 4]]
    goal: [6.5, 2, 1.57]
starts:
  poses: [[4, 1, 0]]
  rows: [[[4, 2.2], [4, 3.3]]]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A map without fault."""
    folder = tmp_path / "two"
    write_grid(folder, two_rooms())
    (folder / "rooms.yaml").write_text(ROOMS, encoding="utf-8")
    return folder


def test_headings_that_look_like_degrees_are_warned_of_and_those_with_a_unit_are_not(folder: Path) -> None:
    rooms = ROOMS.replace("[1.5, 2, 0]", "[1.5, 2, 90]").replace("[6.5, 2, 1.57]", "[6.5, 2, 90deg]")
    (folder / "rooms.yaml").write_text(rooms.replace("[4, 1, 0]", "[4, 1, 180]"), encoding="utf-8")
    read = read_map(folder)
    assert [fault.key for fault in read.warnings] == ["rooms[0].goal[2]", "starts.poses[0][2]"]
    assert "Write 90deg if degrees are meant" in str(read.warnings[0])
    assert read.rooms[1].goal.theta == pytest.approx(np.pi / 2)


def test_a_third_start_pose_is_no_heading(folder: Path) -> None:
    three = ROOMS.replace("[[4, 1, 0]]", "[[4, 1, 0], [4, 2, 0], [4, 3, 0]]").replace(
        "rows: [[[4, 2.2], [4, 3.3]]]", ""
    )
    (folder / "rooms.yaml").write_text(three)
    assert read_map(folder).warnings == ()


class TestShippedMaps:
    @pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
    def test_nothing_is_odd_about_them(self, name: str) -> None:
        assert check_map(shipped().find("maps", name, HERE)).findings == ()

    @pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
    def test_a_dozen_robots_have_room(self, name: str) -> None:
        drawn = read_map(shipped().find("maps", name, HERE))
        starts = drawn.starts
        assert len(starts) >= 12
        assert min(a.distance(b) for i, a in enumerate(starts) for b in starts[:i]) >= 0.9
        assert all(drawn.room_at(start.x, start.y) is None for start in starts)

    def test_arena8_is_the_arena_of_2016(self) -> None:
        arena = read_map(shipped().find("maps", "arena8", HERE))
        assert (arena.grid.cols, arena.grid.rows, arena.grid.resolution) == (320, 240, 0.05)
        assert arena.grid.origin == Pose2(-5.0, -5.0, 0.0)
        assert arena.starts[0] == IDENTITY
        assert [(room.goal.x, room.goal.y) for room in arena.rooms] == [
            (-2.671, 4.692), (-2.735, 1.442), (-2.869, -2.970), (3.110, 4.857),
            (2.612, -2.758), (8.744, 5.440), (9.002, 1.457), (9.084, -2.518),
        ]  # fmt: skip
        # Measured; those of 2016 are in the templates of 2016.
        assert arena.costs is not None
        # Door of room 4, between the posts of the wall at x = 1.
        assert arena.grid.value_at(1.0, 6.0) == FREE
        assert arena.grid.value_at(1.0, 4.0) == OCCUPIED
        assert arena.room_at(3.0, 5.0) == Room(4)

    def test_warehouse12_brings_its_own_costs(self) -> None:
        warehouse = read_map(shipped().find("maps", "warehouse12", HERE))
        assert len(warehouse.rooms) == 12
        assert warehouse.costs is not None


class TestReading:
    def test_rooms_and_starts(self, folder: Path) -> None:
        drawn = read_map(folder)
        assert drawn.name == "two"
        assert [room.name for room in drawn.rooms] == ["West", "East"]
        assert drawn.rooms[0].region == ((0.0, 0.0), (3.0, 0.0), (3.0, 4.0), (0.0, 4.0))
        assert drawn.rooms[1].goal == Pose2(6.5, 2.0, 1.57)
        assert drawn.starts == (Pose2(4.0, 1.0, 0.0), Pose2(4.0, 2.2, 0.0), Pose2(4.0, 3.2, 0.0))
        assert drawn.room_at(1.0, 1.0) == Room(1)
        assert drawn.room_at(4.0, 1.0) is None

    def test_a_map_with_shades_cannot_be_written(self, tmp_path: Path) -> None:
        with pytest.raises(ValueError, match="0, 100 and -1"):
            write_grid(tmp_path / "x", OccupancyGrid(np.array([[50]], dtype=np.int8), 0.1, IDENTITY))

    def test_the_origin_may_be_turned(self, folder: Path) -> None:
        text = (folder / "map.yaml").read_text(encoding="utf-8")
        (folder / "map.yaml").write_text(text.replace("[0.0, 0.0, 0.0]", "[1, 2, 7.0]"), encoding="utf-8")
        assert read_grid(folder / "map.yaml").origin.array() == pytest.approx([1.0, 2.0, 7.0 - 2 * np.pi])


def grid_of_image(folder: Path, name: str, mode: str = "trinary") -> list[list[int]]:
    (folder / "image.yaml").write_text(
        f"image: {name}\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
        f"occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: {mode}\n",
        encoding="utf-8",
    )
    cells: list[list[int]] = read_grid(folder / "image.yaml").cells.tolist()
    return cells


EXPECTED = [[FREE, UNKNOWN, FREE], [OCCUPIED, FREE, UNKNOWN]]
"""Cells of the pixels 0 254 205 (top) and 254 205 254 (bottom)."""


class TestImages:
    @pytest.mark.parametrize(
        "content",
        [
            b"P5\n3 2\n255\n\x00\xfe\xcd\xfe\xcd\xfe",
            b"P5 # made by hand\n# CREATOR: map_saver 0.050 m/pix\n3 2 255 \x00\xfe\xcd\xfe\xcd\xfe\n",
            b"P2\n3 2\n255\n0 254 205 # the top\n254 205\n254\n",
            b"P2 3 2 65535 0 65278 52685 65278 52685 65278",
            b"P5\n3 2\n65535\n\x00\x00\xfe\xfe\xcd\xcd\xfe\xfe\xcd\xcd\xfe\xfe",
            b"P5\n3 2\n200\n\x00\xc8\xa1\xc8\xa1\xc8",
        ],
        ids=["P5", "comments", "P2", "P2 of 16 bit", "P5 of 16 bit", "P5 of another depth"],
    )
    def test_pgm(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "a.pgm").write_bytes(content)
        assert grid_of_image(tmp_path, "a.pgm") == EXPECTED

    def test_a_pixel_that_looks_like_a_blank_is_a_pixel(self, tmp_path: Path) -> None:
        (tmp_path / "a.pgm").write_bytes(b"P5\n1 1\n255\n\x0a")
        assert grid_of_image(tmp_path, "a.pgm", "raw") == [[10]]

    @pytest.mark.parametrize("mode", ["L", "RGB", "P", "RGBA", "LA", "I;16"])
    def test_png(self, tmp_path: Path, mode: str) -> None:
        grey = np.array([[0, 254, 205], [254, 205, 254]], dtype=np.uint8)
        deep = grey.astype(np.uint16) * 257
        picture = Image.fromarray(deep) if mode == "I;16" else Image.fromarray(grey).convert(mode)
        picture.save(tmp_path / "a.png")
        # An opaque alpha channel counts as one more color, and makes the shade of unknown bright enough to be free.
        opaque = [[FREE, FREE, FREE], [OCCUPIED, FREE, FREE]]
        expected = opaque if mode in {"RGBA", "LA"} else EXPECTED
        assert grid_of_image(tmp_path, "a.png") == expected

    def test_a_picture_that_is_a_program_for_another_program_is_none(self, tmp_path: Path) -> None:
        Image.new("L", (3, 2)).save(tmp_path / "a.png", "EPS")
        with pytest.raises(BadFile, match="this is not a readable image"):
            grid_of_image(tmp_path, "a.png")


def edit(name: str, old: str, new: str) -> Callable[[Path], object]:
    def change(folder: Path) -> None:
        text = (folder / name).read_text(encoding="utf-8")
        assert old in text
        (folder / name).write_text(text.replace(old, new, 1), encoding="utf-8")

    return change


def image(content: bytes) -> Callable[[Path], object]:
    return lambda folder: (folder / "map.pgm").write_bytes(content)


def draw(rows: "slice[int, int, None]", cols: "slice[int, int, None]", cell: int) -> Callable[[Path], object]:
    def change(folder: Path) -> None:
        cells = two_rooms().cells.copy()
        cells[rows, cols] = cell
        write_grid(folder, OccupancyGrid(cells, 0.1, IDENTITY))

    return change


def remove(folder: Path) -> None:
    shutil.rmtree(folder)


BROKEN: dict[str, tuple[Callable[[Path], object], str]] = {
    "no folder": (remove, "two: there is no such folder. Name a folder that contains map.yaml and rooms.yaml."),
    "no map.yaml": (lambda folder: (folder / "map.yaml").unlink(), "map.yaml: there is no such file."),
    "no rooms.yaml": (lambda folder: (folder / "rooms.yaml").unlink(), "rooms.yaml: there is no such file."),
    "no image": (lambda folder: (folder / "map.pgm").unlink(), "map.yaml, line 1, image: file "),
    "a misspelt key": (
        edit("map.yaml", "occupied_thresh", "occupied_tresh"),
        "map.yaml, line 5, occupied_tresh: unknown key. The nearest name is occupied_thresh.",
    ),
    "a missing key": (
        edit("map.yaml", "negate: 0\n", ""),
        "map.yaml, line 1, negate: missing. Add the line 'negate: ...'. Write a whole number, 0 to 1 there.",
    ),
    "thresholds the wrong way round": (
        edit("map.yaml", "free_thresh: 0.196", "free_thresh: 0.7"),
        "map.yaml, line 6, free_thresh: 0.7 is above occupied_thresh 0.65.",
    ),
    "no such mode": (
        edit("map.yaml", "negate: 0", "negate: 0\nmode: trinery"),
        "map.yaml, line 5, mode: 'trinery' is not a valid choice. Write trinary, scale or raw.",
    ),
    "a resolution of nothing": (edit("map.yaml", "0.1", "0"), "line 2, resolution: 0 is out of range."),
    "an image cut off": (
        image(b"P5\n80 40\n255\n" + bytes(1000)),
        "map.pgm: the image is cut off: its header says 80 x 40 pixels, but the file has only 12 rows.",
    ),
    "a text image cut off": (image(b"P2\n80 40\n255\n0 0 0\n"), "80 x 40 pixels, but the file has only 3 values."),
    "a damaged header": (image(b"P5\n80 x\n"), "map.pgm: the PGM header is damaged."),
    "a header without end": (image(b"P5 80 # 40"), "map.pgm: the PGM header is damaged."),
    "an image of no size": (image(b"P5 0 40 255\n"), "map.pgm: the image has 0 x 40 pixels."),
    "a large image in words": (image(b"P2 3000 3000 255\n"), "map.pgm: 3000 x 3000 pixels in text form are more than"),
    "a gigantic image": (image(b"P5 999999 999999 255\n"), "map.pgm: 999999 x 999999 pixels are more than 32000000."),
    "a strange depth": (image(b"P5 1 1 70000\n"), "map.pgm: the largest value in the header is 70000."),
    "too bright a pixel": (image(b"P5 1 1 100\n\xff"), "a gray value of 255 is above the header's largest value, 100."),
    "words among the pixels": (image(b"P2 1 2 255 0 x"), "b'x' is not a gray value."),
    "no picture at all": (image(b"hello"), "map.pgm: this is not a readable image. Save it as PGM or PNG."),
    "a goal outside its room": (
        edit("rooms.yaml", "[1.5, 2, 0]", "[3.5, 2, 0]"),
        "rooms.yaml, line 5, rooms[0].goal: (3.5, 2) is not in the room's region.",
    ),
    "a goal at the wall": (
        edit("rooms.yaml", "[1.5, 2, 0]", "[0.35, 2, 0]"),
        "rooms.yaml, line 5, rooms[0].goal: at (0.35, 2) the nearest cell that is not free is 0.30 m away; "
        "a robot needs more than 0.35 m to turn. Move this pose away from the wall.",
    ),
    "a goal in unknown space": (
        draw(slice(18, 23), slice(13, 18), UNKNOWN),
        "rooms.yaml, line 5, rooms[0].goal: at (1.5, 2) the nearest cell that is not free is 0.00 m away;",
    ),
    "a goal behind a wall": (
        draw(slice(0, 40), slice(30, 31), OCCUPIED),
        "rooms.yaml, line 5, rooms[0].goal: no path that is 0.5 m wide leads from the start of robot 1 to room 1.",
    ),
    "a door too narrow": (
        draw(slice(5, 40), slice(49, 50), OCCUPIED),
        "rooms.yaml, line 9, rooms[1].goal: no path that is 0.5 m wide leads from the start of robot 1 to room 2.",
    ),
    "a region beyond the map": (
        edit("rooms.yaml", "[8, 0], [8, 4]", "[9, 0], [9, 4]"),
        "rooms.yaml, line 8, rooms[1].region: the corner (9, 0) is outside the map, which is 8 m x 4 m.",
    ),
    "regions that overlap": (
        edit("rooms.yaml", "[3, 4]]", "[6, 4]]"),
        "rooms[1].region: this region overlaps the region of room 1 by 4.00 m^2. Move the regions apart.",
    ),
    "a region that is a line": (
        edit("rooms.yaml", "[3, 4]]", "[3, 0]]"),
        "rooms.yaml, line 4, rooms[0].region: these corners enclose no area.",
    ),
    "a region like an hourglass": (
        edit("rooms.yaml", "[8, 0], [8, 4], [5, 4]", "[8, 4], [8, 0], [5, 3]"),
        "rooms.yaml, line 8, rooms[1].region: the sides of the region cross each other.",
    ),
    "a number twice": (
        edit("rooms.yaml", "number: 2", "number: 1"),
        "rooms.yaml, line 6, rooms[1].number: room 1 is defined twice, first in line 2.",
    ),
    "a gap in the numbers": (
        edit("rooms.yaml", "number: 2", "number: 3"),
        "rooms.yaml, line 1, rooms: no room has the number 2, but there is a room 3. Number the 2 rooms 1 to 2.",
    ),
    "the corridor as a room": (edit("rooms.yaml", "number: 1", "number: 0"), "rooms[0].number: 0 is out of range."),
    "a name twice": (
        edit("rooms.yaml", "name: East", "name: West"),
        "rooms.yaml, line 7, rooms[1].name: 'West' is also the name of the room in line 2.",
    ),
    "a misspelt key of a room": (
        edit("rooms.yaml", "    goal: [1.5", "    gaol: [1.5"),
        "rooms.yaml, line 5, rooms[0].gaol: unknown key. The nearest name is goal.",
    ),
    "no room": (
        edit("rooms.yaml", ROOMS, "rooms: []\nstarts: {poses: [[4, 1, 0]]}\n"),
        "rooms.yaml, line 1, rooms: the map has no rooms. Add at least one room.",
    ),
    "no start": (
        edit("rooms.yaml", "  poses: [[4, 1, 0]]\n  rows: [[[4, 2.2], [4, 3.3]]]\n", "  poses: []\n"),
        "rooms.yaml, line 10, starts: the map has no start poses.",
    ),
    "a start in a wall": (
        edit("rooms.yaml", "[[4, 1, 0]]", "[[4, 0.1, 0]]"),
        "rooms.yaml, line 11, starts.poses[0]: at (4, 0.1) the nearest cell that is not free is 0.10 m away;",
    ),
    "a start off the map": (
        edit("rooms.yaml", "[[4, 1, 0]]", "[[40, 1, 0]]"),
        "rooms.yaml, line 11, starts.poses[0]: at (40, 1) the nearest cell that is not free is 0.00 m away;",
    ),
    "a row without end": (
        edit("rooms.yaml", "[4, 3.3]", "[4, 1e9]"),
        "rooms.yaml, line 12, starts.rows[0]: more than 1000 starts in a row. Shorten the row, or",
    ),
    "starts that overlap": (
        edit("rooms.yaml", "[[4, 1, 0]]", "[[4, 1, 0], [4.1, 2, 0]]"),
        "rooms.yaml, line 12, starts.rows[0]: the start of robot 3 is 0.22 m from the start of robot 2; "
        "robots need more than 0.71 m. Move one of the two, or increase starts.spacing.",
    ),
    "costs for other rooms": (
        lambda folder: (folder / "mapTimes").write_text("2\n99 5\n99 99\n", encoding="ascii"),
        "mapTimes, line 1: costs for 1 rooms, but rooms.yaml has 2.",
    ),
}


def test_rooms_are_read_as_they_were_written(folder: Path) -> None:
    before = read_map(folder)
    strange = (dataclasses.replace(before.rooms[0], name='Bob\'s "küche": #1'), *before.rooms[1:])
    write_rooms(folder, strange, before.starts, language="no")
    after = read_map(folder)
    assert (after.rooms, after.starts, after.language) == (strange, before.starts, "no")


class TestNamesInFurtherLanguages:
    @pytest.mark.parametrize("name", shipped().names("maps"))
    def test_shipped_maps_lack_none_in_german(self, name: str) -> None:
        folder = shipped().find("maps", name, HERE)
        assert list(missing_room_names(read_map(folder), folder, "de")) == []

    def test_rooms_have_the_names_of_the_language(self, folder: Path) -> None:
        (folder / "rooms.yaml").write_text(f"language: en\n{ROOMS}")
        (folder / "de").mkdir()
        (folder / "de" / "words.yaml").write_text("rooms: {East: Osten}\n")
        drawn = read_map(folder)
        assert drawn.room_names_in("de").named == {1: "West", 2: "Osten"}
        assert drawn.room_names_in("en") == drawn.room_names
        (missing,) = missing_room_names(drawn, folder, "de")
        assert str(missing) == (
            f"{folder}/de/words.yaml, rooms: the map is in en, but these rooms have no name in de: West. "
            "Write the names under rooms."
        )
        assert list(missing_room_names(drawn, folder, "en")) == []

    def test_a_name_for_no_room_is_a_warning_since_the_room_may_have_been_renamed(self, folder: Path) -> None:
        (folder / "de").mkdir()
        (folder / "de" / "words.yaml").write_text("rooms:\n  Eastt: Osten\n")
        (finding,) = check_map(folder).findings
        assert finding.severity == "warning"
        assert "line 2, rooms.Eastt: no room has the name 'Eastt'. The nearest name is East." in str(finding.fault)


class TestBroken:
    @pytest.mark.parametrize(("change", "told"), BROKEN.values(), ids=BROKEN)
    def test_the_message_says_where_and_what_to_do(
        self, folder: Path, change: Callable[[Path], object], told: str
    ) -> None:
        assert check_map(folder).findings == ()
        change(folder)
        with pytest.raises(BadFile) as caught:
            read_map(folder)
        assert told in str(caught.value)
        assert [finding.severity for finding in check_map(folder).findings].count("error") >= 1

    def test_all_faults_of_both_files_are_told_at_once(self, folder: Path) -> None:
        edit("map.yaml", "negate: 0", "negate: 7")(folder)
        edit("rooms.yaml", "number: 2", "number: 1")(folder)
        edit("rooms.yaml", "[1.5, 2, 0]", "[3.5, 2, 0]")(folder)
        told = "\n".join(str(finding.fault) for finding in check_map(folder).findings)
        assert "negate: 7 is out of range" in told
        assert "is defined twice" in told
        assert "is not in the room's region" in told

    def test_faults_of_shape_place_and_way_are_told_in_one_round(self, folder: Path) -> None:
        draw(slice(0, 40), slice(49, 50), OCCUPIED)(folder)
        edit("rooms.yaml", "number: 2", "number: 3")(folder)
        edit("rooms.yaml", "[1.5, 2, 0]", "[0.35, 2, 0]")(folder)
        (folder / "mapTimes").write_text("x\n")
        told = "\n".join(str(finding.fault) for finding in check_map(folder).findings)
        assert "mapTimes, line 1, number of nodes: " in told
        assert "no room has the number 2" in told
        assert "rooms[0].goal: at (0.35, 2)" in told
        assert "rooms[1].goal: no path that is 0.5 m wide leads from the start of robot 1 to room 3" in told

    @pytest.mark.parametrize(
        ("change", "told"),
        [
            (edit("map.yaml", "negate: 0", "negate: 1"), "line 4, negate: 5 of 5 goals and starts are in walls"),
            (edit("map.yaml", "origin: [0.0", "origin: [100.0"), "line 3, origin: 5 of 5 goals and starts lie outside"),
        ],
    )
    def test_where_all_places_are_off_the_floor_the_image_is_asked_about_once(
        self, folder: Path, change: Callable[[Path], object], told: str
    ) -> None:
        change(folder)
        (fault,) = [fault for fault in check_map(folder).errors if ".region" not in (fault.key or "")]
        assert told in str(fault)

    def test_a_start_in_a_room_is_odd_but_no_error(self, folder: Path) -> None:
        edit("rooms.yaml", "[[4, 1, 0]]", "[[4, 1, 0], [6.5, 1, 0]]")(folder)
        assert [(finding.severity, str(finding.fault.problem)) for finding in check_map(folder).findings] == [
            ("warning", "the start of robot 2 is in room 2")
        ]
        assert len(read_map(folder).starts) == 4

    def test_starts_that_block_the_way_are_told(self, folder: Path) -> None:
        edit("rooms.yaml", "[[4, 1, 0]]", "[[4, 1, 0], [3.3, 0.5, 0]]")(folder)
        told = [str(finding.fault) for finding in check_map(folder).findings]
        assert all("with 4 robots at their starts no path leads from" in fault for fault in told)
        assert any("the start of robot 1 to room 1. Leave a free lane" in fault for fault in told)
