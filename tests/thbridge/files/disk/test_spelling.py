"""Letters with marks as one character (NFC) or two (NFD): names that people type and names of files are equal."""

from pathlib import Path

import pytest
from PIL import Image

from thbridge.files.disk.edited_file import read_edited
from thbridge.files.disk.regular_files import as_on_disk
from thbridge.files.disk.text_files import read_text
from thbridge.files.grid_files import read_grid_file
from thbridge.files.resources import Resources

COMPOSED, DECOMPOSED = "R\u00e4ume", "Ra\u0308ume"
SPELLINGS = [(COMPOSED, DECOMPOSED), (DECOMPOSED, COMPOSED)]


def test_texts_are_read_composed_and_edited_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "rooms.yaml").write_text(DECOMPOSED)
    assert read_text(tmp_path / "rooms.yaml") == COMPOSED
    assert read_edited(tmp_path / "rooms.yaml").text == DECOMPOSED


@pytest.mark.parametrize(("typed", "there"), SPELLINGS)
def test_files_are_found_by_either_spelling(tmp_path: Path, typed: str, there: str) -> None:
    (tmp_path / there / there).mkdir(parents=True)
    file = tmp_path / there / there / f"{there}.yaml"
    file.write_text("map")
    assert as_on_disk(tmp_path / typed / typed / f"{typed}.yaml") == file
    assert read_text(tmp_path / typed / typed / f"{typed}.yaml") == "map"
    assert as_on_disk(tmp_path / typed / "none") == tmp_path / there / "none"


def test_the_very_name_comes_first(tmp_path: Path) -> None:
    for name in (COMPOSED, DECOMPOSED):
        (tmp_path / name).write_text(name)
        assert as_on_disk(tmp_path / name) == tmp_path / name


@pytest.mark.parametrize(("typed", "there"), SPELLINGS)
def test_a_map_and_its_image_are_found_by_either_spelling(tmp_path: Path, typed: str, there: str) -> None:
    folder = tmp_path / there
    folder.mkdir()
    Image.new("L", (4, 4), 254).save(folder / f"{there}.png")
    (folder / "map.yaml").write_text(
        f"image: {typed}.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    assert Resources(tmp_path).find("maps", f"./{typed}", tmp_path) == folder
    assert read_grid_file(folder / "map.yaml").doubts == ()
