from pathlib import Path

from thbridge.recording.recordings import journal_of, make_room, parts_of


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).write_text(name)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("[!.]*"))


def test_parts_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    touch(tmp_path, *(f"a_{number}.bag" for number in range(12)), "a_x.bag", "a_01.bag", "a_1.orig.bag", "b_0.bag")
    assert [path.name for path in parts_of(tmp_path / "a.bag")] == [f"a_{number}.bag" for number in range(12)]


def test_a_file_that_is_there_is_all_of_the_recording(tmp_path: Path) -> None:
    touch(tmp_path, "a.bag", "a_0.bag", "a_1.bag")
    assert parts_of(tmp_path / "a.bag") == (tmp_path / "a.bag",)
    assert parts_of(tmp_path / "a_1.bag") == (tmp_path / "a_1.bag",)
    assert parts_of(tmp_path / "none.bag") == (tmp_path / "none.bag",)
    assert parts_of(tmp_path / "nowhere" / "none.bag") == (tmp_path / "nowhere" / "none.bag",)


def test_an_older_recording_moves_with_all_that_is_its_own(tmp_path: Path) -> None:
    touch(tmp_path, "a_0.bag", "a_1.bag.active", "a-1.bag", "ab.bag", "a_b.bag", "a.tlog")
    journal_of(tmp_path / "a.bag").mkdir()
    assert make_room(tmp_path / "a.bag") == tmp_path / "a-2.bag"
    moved = ["a-2.journal", "a-2.tlog", "a-2_0.bag", "a-2_1.bag.active"]
    assert names(tmp_path) == ["a-1.bag", *moved, "a_b.bag", "ab.bag"]
    assert make_room(tmp_path / "a.bag") is None
