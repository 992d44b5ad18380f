"""`thbridge watch` refuses in words what it cannot show, before a window opens."""

from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


def refused(*arguments: str) -> str:
    done = invoke("watch", *arguments)
    assert done.exit_code == 2
    return " ".join(done.output.split())


def test_a_file_that_is_no_bag(tmp_path: Path) -> None:
    path = tmp_path / "notes.bag"
    path.write_text("no bag at all, in spite of its name\n")
    assert "this is not a ROS 1 bag" in refused(str(path))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    assert "no such file" in refused(str(tmp_path / "none.bag"))


def test_a_port_that_is_none() -> None:
    assert "99999 is not a port" in refused("localhost:99999")


def test_a_key_for_a_recording(tmp_path: Path) -> None:
    assert "a recording needs no key" in refused(str(tmp_path / "x.bag"), "--key", str(tmp_path / "key.txt"))


def test_a_key_that_is_empty(tmp_path: Path) -> None:
    key = tmp_path / "key.txt"
    key.write_text("\n")
    assert "chmod 600" in refused("localhost:6010", "--key", str(key))
    key.chmod(0o600)
    assert "there is no key" in refused("localhost:6010", "--key", str(key))


def test_a_machine_without_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    assert "prevents visible windows" in refused("localhost:6010")
