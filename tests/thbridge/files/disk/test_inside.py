import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.disk.inside import LONGEST_NAME, path_inside, relative_inside
from thbridge.files.errors import BadFile

ODD = ["", " ", "\t \n", "\u2003", ".", "..", "a/b", "/etc", "a\\b", "a\0", "a\nb", "\x1b[2J", "\udcff", "\u202ea"]
TOO_LONG = ["a" * (LONGEST_NAME + 1), "ä" * (LONGEST_NAME // 2 + 1)]


@pytest.mark.parametrize("name", [*ODD, *TOO_LONG])
def test_odd_names_are_no_names_of_files(name: str, tmp_path: Path) -> None:
    with pytest.raises(BadFile) as fault:
        path_inside(tmp_path, "ok", name)
    assert str(fault.value).isprintable()


@pytest.mark.parametrize("path", ["", "/", "/etc/passwd", "../x", "a/../../x", "a//b", "a/", "a/./b"])
def test_odd_paths_are_no_relative_paths(path: str, tmp_path: Path) -> None:
    with pytest.raises(BadFile):
        relative_inside(tmp_path, path)


def test_a_path_is_what_its_names_say(tmp_path: Path) -> None:
    assert path_inside(tmp_path, "p-07", "my export") == tmp_path / "p-07" / "my export"
    assert relative_inside(tmp_path, "a/ä.png") == tmp_path / "a" / "ä.png"
    assert path_inside(tmp_path, "a" * LONGEST_NAME).name == "a" * LONGEST_NAME


def test_links_may_lead_within_a_folder_and_not_out_of_it(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    folder, own = tmp_path / "linked", tmp_path / "own"
    own.mkdir()
    outside.mkdir()
    folder.symlink_to(own)
    (own / "in").mkdir()
    (own / "within").symlink_to("in")
    (own / "out").symlink_to(outside)
    (own / "up").symlink_to("..")
    (own / "gone").symlink_to(tmp_path / "nothing")
    (own / "in" / "out").symlink_to(outside / "file")
    assert path_inside(folder, "within", "file") == folder / "within" / "file"
    for names in (["out"], ["out", "file"], ["up"], ["up", "outside"], ["gone"], ["in", "out"]):
        with pytest.raises(BadFile, match="link"):
            path_inside(folder, *names)


@given(st.lists(st.text(max_size=20), min_size=1, max_size=3))
def test_no_name_leads_out_of_a_folder(names: list[str]) -> None:
    folder = Path("/nowhere/at/all")
    try:
        path = path_inside(folder, *names)
    except BadFile:
        return
    assert Path(os.path.realpath(path)).parts == (*folder.parts, *names)


@pytest.mark.parametrize("name", ["", "..", ".", " ", "/tmp", "a/b", "a\0"])
def test_folders_of_a_study_are_within_it(name: str, tmp_path: Path) -> None:
    study = ExperimentFolder(tmp_path)
    for path in (study.recordings_of, study.export, lambda name: study.bag(name, 1), study.bag_named):
        with pytest.raises(BadFile):
            path(name)


@pytest.mark.parametrize("name", [None, 7, "store/log", "recordings", "recordings/", "recordings/../store/log", []])
def test_an_event_names_recordings_alone(name: object, tmp_path: Path) -> None:
    with pytest.raises(BadFile):
        ExperimentFolder(tmp_path).bag_named(name)


def test_recordings_may_be_on_another_disk(tmp_path: Path) -> None:
    study, disk = tmp_path / "study", tmp_path / "disk"
    study.mkdir()
    disk.mkdir()
    (study / "recordings").symlink_to(disk)
    bag = ExperimentFolder(study).bag("p-01", 2)
    assert ExperimentFolder(study).bag_named(bag.relative_to(study).as_posix()) == bag
