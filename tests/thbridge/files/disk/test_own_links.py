"""Outputs follow no link of another account, whoever writes them; links of this account and of root are followed."""

import os
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.participants import play_a_game
from thbridge.credentials import Right
from thbridge.experiment.backup import back_up
from thbridge.experiment.folder import ExperimentFolder
from thbridge.files.disk.edited_file import write_edited
from thbridge.files.disk.new_file import new_file
from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.synced import make_folder
from thbridge.files.disk.whole import new_folder, write_whole
from thbridge.files.errors import BadFile
from thbridge.files.keys.key_ring import KeyRing
from thbridge.recording.bag.writing.bag_file import NAMELESS, BagFile
from thbridge.recording.claims import claim, release
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import make_room, reserve

OTHER = 54321
"""User id of nobody here."""


def give_away(link: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make a link one of another account; without the right to do so, make this another account."""
    if os.geteuid() == 0:
        os.lchown(link, OTHER, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: OTHER)


def _new_file(path: Path) -> None:
    with new_file(path, path.with_name("source"), overwrite=True) as part:
        part.write_bytes(b"x")


def _new_folder(path: Path) -> None:
    with new_folder(path, empty=True) as part:
        (part / "x").write_bytes(b"x")


def _claim(path: Path) -> None:
    claim(path)
    release(path)


def _back_up(to: Path) -> None:
    study = ExperimentFolder(to.parents[1] / "study")
    study.log.parent.mkdir(parents=True)
    write_experiment(study.root, "title: x\nquota: 3\nsteps:\n  - {step: trial}\n")
    play_a_game(study)
    back_up(study, to)


WRITERS: dict[str, Callable[[Path], object]] = {
    "file": lambda path: write_whole(path, b"x"),
    "edited file": lambda path: write_edited(path, "x", marked=False),
    "new file": _new_file,
    "new folder": _new_folder,
    "folder": make_folder,
    "recording": reserve,
    "moved recording": make_room,
    "claim": _claim,
    "journals": JournalStore,
    "keys": lambda path: KeyRing(path, lambda: "2026-01-02T09:00:00Z").add("cleo", [Right.WATCH], "s" * 16, None),
    "backup": _back_up,
}


@pytest.mark.parametrize("what", WRITERS)
def test_no_output_goes_through_a_link_of_another_account(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine, place = tmp_path / "mine", tmp_path / "place"
    mine.mkdir()
    place.mkdir()
    (place / "link").symlink_to(mine)
    give_away(place / "link", monkeypatch)
    with pytest.raises(BadFile, match="belongs to another account"):
        WRITERS[what](place / "link" / "new.bag")
    assert not [*mine.iterdir()]


@pytest.mark.parametrize("what", ["file", "edited file", "new folder"])
def test_a_link_of_another_account_in_the_place_of_an_output_is_not_followed(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = tmp_path / "mine"
    (mine.mkdir if what == "new folder" else mine.touch)()
    (tmp_path / "out").symlink_to(mine)
    give_away(tmp_path / "out", monkeypatch)
    with pytest.raises(BadFile, match="belongs to another account"):
        WRITERS[what](tmp_path / "out")
    assert not (any(mine.iterdir()) if mine.is_dir() else mine.read_bytes())


def test_a_link_in_the_place_of_a_lock_empties_no_file(tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.write_bytes(b"mine")
    (tmp_path / ".new.bag.lock").symlink_to(mine)
    with pytest.raises(OSError, match="symbolic links"):
        claim(tmp_path / "new.bag")
    assert mine.read_bytes() == b"mine"


def test_a_link_in_the_place_of_a_new_bag_is_replaced(tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.write_bytes(b"mine")
    (tmp_path / f"new.bag{NAMELESS}").symlink_to(mine)
    BagFile(tmp_path / "new.bag").close()
    assert mine.read_bytes() == b"mine"
    assert (tmp_path / "new.bag").is_file()


def test_own_links_are_followed_as_the_system_follows_them(tmp_path: Path) -> None:
    (tmp_path / "a" / "b").mkdir(parents=True)
    (tmp_path / "up").symlink_to("a/b/..")
    (tmp_path / "absolute").symlink_to(tmp_path / "up")
    (tmp_path / "a" / "b" / "back").symlink_to("../../absolute/b")
    for path in ("absolute/new", "absolute/b/back/back/new", "a/../up/none/../x", "none/new"):
        assert own_target(tmp_path / path) == (tmp_path / path).resolve()
    write_whole(tmp_path / "absolute" / "new", b"x")
    assert (tmp_path / "a" / "new").read_bytes() == b"x"


def test_circles_and_names_that_are_none_are_refused(tmp_path: Path) -> None:
    (tmp_path / "circle").symlink_to("circle")
    for name in ("circle", "circle/x", "a\0b", "a" * 300):
        with pytest.raises(BadFile):
            write_whole(tmp_path / name, b"x")


def test_the_system_resolves_random_links_likewise(tmp_path: Path) -> None:
    draws = random.Random(1)
    names = ["a", "b", "c", "d"]
    for name in names:
        (tmp_path / name).mkdir()
    for _ in range(12):
        target = "/".join(draws.choices([*names, "..", "l1", "l2"], k=3))
        link = tmp_path / draws.choice(names) / f"l{draws.randint(1, 2)}"
        if not link.is_symlink():
            link.symlink_to(draws.choice(["", f"{tmp_path}/"]) + target)
    for _ in range(300):
        path = tmp_path / "/".join(draws.choices([*names, "l1", "l2", ".."], k=draws.randint(1, 5)))
        try:
            resolved = path.resolve()
        except RuntimeError:
            with pytest.raises(BadFile, match="circle"):
                own_target(path)
            continue
        assert own_target(path) == resolved
