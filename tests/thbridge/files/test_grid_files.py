"""Files of maps as map_server of ROS 1 and of Nav2 read them, and as other machines and editors write them."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim.common.geometry import IDENTITY
from sim.common.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from thbridge.files.errors import BadFile
from thbridge.files.grid_files import read_grid, read_grid_file, write_grid

CELLS = np.full((4, 6), FREE, dtype=np.int8)
CELLS[0, :] = OCCUPIED
LINES = {
    "image": "map.pgm",
    "resolution": "0.05",
    "origin": "[0.0, 0.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_grid(tmp_path, OccupancyGrid(CELLS, 0.05, IDENTITY))
    return tmp_path


def written(folder: Path, **lines: str) -> Path:
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in {**LINES, **lines}.items()))
    return path


@pytest.mark.parametrize(
    "lines",
    [
        {"resolution": '"0.05"', "occupied_thresh": "'0.65'"},
        {"origin": '["0.0", 0.0, "0"]'},
        {"negate": "false"},
        {"negate": "No"},
        {"mode": "Trinary"},
        {"occupied_thresh": "0.5", "free_thresh": "0.5"},
    ],
)
def test_what_map_servers_read_is_read(folder: Path, lines: dict[str, str]) -> None:
    file = read_grid_file(written(folder, **lines))
    np.testing.assert_array_equal(file.grid.cells, CELLS)
    assert file.doubts == ()


def test_further_keys_do_not_count_and_are_told(folder: Path) -> None:
    file = read_grid_file(written(folder, frame_id="map", floor="0"))
    np.testing.assert_array_equal(file.grid.cells, CELLS)
    assert [(doubt.key, doubt.line) for doubt in file.doubts] == [("frame_id", 7), ("floor", 8)]


@pytest.mark.parametrize(
    "image",
    [
        "/home/x/install/maps/map.pgm",
        "~/map.pgm",
        "file:///home/x/map.pgm",
        r"C:\Users\lab\map.pgm",
        r".\map.pgm",
        "Map.PGM",
    ],
)
def test_an_image_that_is_not_there_is_looked_for_beside_the_file_and_that_is_told(folder: Path, image: str) -> None:
    file = read_grid_file(written(folder, image=image))
    np.testing.assert_array_equal(file.grid.cells, CELLS)
    (doubt,) = file.doubts
    assert (doubt.key, doubt.line) == ("image", 1)
    assert str(doubt).endswith(
        f"file {image} does not exist, so map.pgm next to map.yaml is used. Write image: map.pgm."
    )


def test_an_image_that_is_nowhere_is_a_fault(folder: Path) -> None:
    with pytest.raises(BadFile, match=r"map\.yaml, line 1, image: file /home/x/other\.pgm does not exist\. Name the "):
        read_grid(written(folder, image="/home/x/other.pgm"))


@pytest.mark.parametrize("heading", ["-nan", "nan", ".nan", "-.NaN"])
def test_a_heading_of_a_saver_that_knew_none(folder: Path, heading: str) -> None:
    with pytest.raises(BadFile, match=r"line 3, origin\[2\]: \S+ is not a heading; .* Write 0, unless the map is"):
        read_grid(written(folder, origin=f"[0.0, 0.0, {heading}]"))


def test_a_misspelt_key_is_named_with_the_right_one(folder: Path) -> None:
    path = written(folder)
    path.write_text(path.read_text().replace("resolution", "resolutoin"))
    with pytest.raises(BadFile, match=r"line 2, resolutoin: unknown key\. The nearest name is resolution"):
        read_grid(path)


def with_unknown(folder: Path, **lines: str) -> Path:
    cells = np.full((10, 10), FREE, dtype=np.int8)
    cells[:3] = UNKNOWN
    write_grid(folder, OccupancyGrid(cells, 0.05, IDENTITY))
    return written(folder, **lines)


@pytest.mark.parametrize("mode", ["trinary", "scale"])
def test_unknown_space_that_counts_as_free_is_told(folder: Path, mode: str) -> None:
    """As in every map that Nav2's saver writes."""
    file = read_grid_file(with_unknown(folder, free_thresh="0.25", mode=mode))
    assert (file.grid.cells == FREE).all()
    (doubt,) = file.doubts
    assert (doubt.key, doubt.line) == ("free_thresh", 6)
    assert "is free here (30 % of the image)" in str(doubt)
    assert "Write free_thresh: 0.196" in str(doubt)


@pytest.mark.parametrize("lines", [{}, {"free_thresh": "0.25", "mode": "raw"}, {"free_thresh": "0.25", "negate": "1"}])
def test_unknown_space_that_does_not_count_as_free_is_not(folder: Path, lines: dict[str, str]) -> None:
    assert read_grid_file(with_unknown(folder, **lines)).doubts == ()


@pytest.mark.parametrize(
    ("form", "mode", "told"),
    [("RGBA", "trinary", True), ("LA", "trinary", True), ("RGBA", "scale", False), ("RGB", "trinary", False)],
)
def test_an_alpha_channel_that_changes_cells_is_told(folder: Path, form: str, mode: str, told: bool) -> None:
    """Opaque gray 205 becomes (3 * 205 + 255) / 4, which is free."""
    Image.new("L", (4, 4), 205).convert(form).save(folder / "map.png")
    file = read_grid_file(written(folder, image="map.png", mode=mode))
    alpha = [doubt for doubt in file.doubts if "alpha channel" in str(doubt)]
    assert len(alpha) == told
    if told:
        assert (file.grid.cells == FREE).all()
        assert "average it with the colors, so 100 % of the cells differ from the colors shown. Save" in str(alpha[0])


def test_an_alpha_channel_that_changes_nothing_is_not_told(folder: Path) -> None:
    Image.new("RGBA", (4, 4), (254, 254, 254, 255)).save(folder / "map.png")
    assert read_grid_file(written(folder, image="map.png")).doubts == ()


def test_a_map_without_unknown_space_may_have_any_threshold(folder: Path) -> None:
    assert read_grid_file(written(folder, free_thresh="0.25")).doubts == ()


def test_walls_that_are_neither_occupied_nor_savers_unknown_are_told(folder: Path) -> None:
    shades = np.full((40, 40), 255, dtype=np.uint8)
    shades[:, :2] = shades[:, -2:] = shades[:2] = shades[-2:] = 127
    shades[10:20, 10:20] = 230
    Image.fromarray(shades).save(folder / "map.png")
    (doubt,) = read_grid_file(written(folder, image="map.png")).doubts
    assert "0% of the cells around the floor are occupied; the rest is unknown, mostly gray 127." in str(doubt)
    assert "write occupied_thresh: 0.452, free_thresh: 0.049" in str(doubt)
    seen = read_grid_file(written(folder, image="map.png", occupied_thresh="0.452", free_thresh="0.049"))
    assert seen.doubts == ()
    assert (seen.grid.cells[0, 0], seen.grid.cells[5, 5], seen.grid.cells[25, 15]) == (OCCUPIED, FREE, UNKNOWN)
