from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.files.resources import Resources, shipped


@pytest.fixture
def resources(tmp_path: Path) -> Resources:
    for folder, mark in [("maps/hall", "map.yaml"), ("maps/attic", "map.yaml"), ("templates/short", "DialogueText")]:
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / mark).touch()
    (tmp_path / "maps" / "notes").mkdir()
    return Resources(tmp_path)


def test_names_are_of_folders_that_are_maps(resources: Resources) -> None:
    assert resources.names("maps") == ("attic", "hall")
    assert resources.names("templates") == ("short",)


def test_a_name_is_found_from_any_folder(resources: Resources, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    assert resources.find("maps", "hall", Path()) == tmp_path / "maps" / "hall"


def test_a_path_is_taken_from_beside_the_file_that_names_it(resources: Resources, tmp_path: Path) -> None:
    assert resources.find("maps", "./hall", tmp_path / "maps") == tmp_path / "maps" / "hall"
    assert resources.find("maps", str(tmp_path / "maps" / "hall"), Path("/")) == tmp_path / "maps" / "hall"


@pytest.mark.parametrize(
    ("wanted", "told"),
    [
        ("hal", r"maps, hal: no map has this name. The nearest name is hall; write a slash in your own path"),
        ("cellar", r"The names are: attic, hall; write a slash in your own path, as in ./cellar"),
        ("notes", r"no map has this name"),
        ("", r"no map has this name"),
        ("./cellar", r"cellar: there is no such folder. Give the path of a map, or one of: attic, hall"),
        ("./", r"this folder has no map.yaml. Give the path of a map, or one of: attic, hall"),
    ],
)
def test_what_is_not_there_is_told_with_what_is(resources: Resources, wanted: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        resources.find("maps", wanted, Path())


def test_the_project_ships_maps_and_templates() -> None:
    assert set(shipped().names("maps")) >= {"arena8", "office", "warehouse12"}
    assert set(shipped().names("templates")) >= {"original-2016"}
